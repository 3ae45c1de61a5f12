// Materials of scene files: presets, every key, the map that says which lies where, parameters of one material by name.
#include <algorithm>

#include "server/import/importer.h"
#include "server/named_parameters.h"
#include "shared/world/base_terrain.h"
#include "tests/import_fixture.h"

namespace spoor {
namespace {

/// A slope of 4 x 2 m in cells of 0.1 m; `more` is added at its end.
std::string scene(const std::string& more, const std::string& thesis = "") {
  return R"(name = "soils"
[world]
cells = [40, 20]
cell_m = 0.1
[base]
kind = "noise"
frequency_per_m = 0.4
highest_m = 1
)" + thesis +
         more;
}

const std::string kTwo = "[[material]]\npreset = \"mud\"\n[[material]]\npreset = \"sand\"\n";

class ImportMaterials : public Import {
 protected:
  Result<ImportedScene> import(const std::string& more, const std::string& thesis = "") {
    return importScene(write("soils.toml", scene(more, thesis)));
  }
  ScenePack packOf(const std::string& more, const std::string& thesis = "") {
    const auto imported = import(more, thesis);
    EXPECT_TRUE(imported) << imported.error();
    return imported ? imported->pack : ScenePack{};
  }
  /// The error, in one line, holds all of these.
  void expectWrong(const std::string& more, const std::vector<std::string>& parts, const std::string& thesis = "") {
    const auto imported = import(more, thesis);
    ASSERT_FALSE(imported) << more;
    EXPECT_EQ(std::count(imported.error().begin(), imported.error().end(), '\n'), 0) << imported.error();
    for (const std::string& part : parts)
      EXPECT_TRUE(contains(imported.error(), part)) << "'" << imported.error() << "' lacks '" << part << "'";
  }
  std::vector<std::int32_t> mapOf(const ScenePack& pack) {
    std::vector<std::int32_t> map(800);
    BaseTerrain(pack).fillMaterials(0, 0, 1, 40, 20, map);
    return map;
  }
};

/// Column by column, in the order of MaterialRules.
MaterialRules rules(int slope, int diagonal, int compression, int limit, int diffusion, int friction, int repose) {
  MaterialRules r;
  r.slope_threshold_q = slope;
  r.diagonal_threshold_q = diagonal;
  r.compression_q16 = compression;
  r.compaction_limit_q16 = limit;
  r.diffusion_q16 = diffusion;
  r.friction_inverse_q32 = friction;
  r.repose_q16 = repose;
  return r;
}

TEST_F(ImportMaterials, PresetsHaveTheirIntegers) {
  std::string tables;
  for (const char* name : {"mud", "pebbles", "sand", "snow", "dust", "gravel"})
    tables += "[[material]]\npreset = \"" + std::string(name) + "\"\n";
  const ScenePack pack = packOf(tables);
  // Cells of 1000 units. 1/zeta * 2^32 of 6e-4 is 2576980.4, of 3e-4 1288490.2, of 4e-4 1717986.9; shares of a right
  // angle of 2/5 pi, pi/3 and pi/4 are 0.8, 2/3 and 1/2.
  const std::vector<MaterialRules> expected = {
      rules(3077, 4352, 0, 0, 16384, 2576980, 52429),          // tan 72 = 3.07768, times sqrt 2 4.35250
      rules(1732, 2449, 0, 0, 58982, 1288490, 43691),          // tan 60 = 1.73205, 2.44949
      rules(1000, 1414, 0, 0, 65536, 1717987, 32768),          // tan 45
      rules(1191, 1685, 52429, 39322, 32768, 2147484, 36409),  // tan 50 = 1.19175, 1.68539
      rules(839, 1186, 32768, 26214, 65536, 3435974, 29127),   // tan 40 = 0.83910, 1.18666
      rules(781, 1104, 3277, 6554, 58982, 1288490, 27671),     // tan 38 = 0.78129, 1.10491
  };
  ASSERT_EQ(pack.parameters.materials.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(pack.parameters.materials[i], expected[i]) << pack.materials[i].name;
  EXPECT_EQ(pack.materials[0], (Material{"mud", {0x5b, 0x43, 0x31}, MaterialTexture::mud, 0, 0}));
  EXPECT_EQ(pack.materials[1], (Material{"pebbles", {0x8d, 0x8a, 0x83}, MaterialTexture::pebbles, 300, 120}));
  EXPECT_EQ(pack.materials[2], (Material{"sand", {0xd8, 0xbc, 0x8a}, MaterialTexture::sand, 0, 0}));
  EXPECT_EQ(pack.materials[3], (Material{"snow", {0xec, 0xf0, 0xf5}, MaterialTexture::snow, 0, 0}));
  EXPECT_EQ(pack.materials[4], (Material{"dust", {0xb7, 0xa7, 0x93}, MaterialTexture::dust, 0, 0}));
  EXPECT_EQ(pack.materials[5], (Material{"gravel", {0x8a, 0x83, 0x78}, MaterialTexture::gravel, 150, 60}));
  EXPECT_EQ(pack.material_map, MaterialMap{});
  const auto again = decodePack(encodePack(pack));
  ASSERT_TRUE(again) << again.error();
  EXPECT_EQ(again->materials, pack.materials);
  EXPECT_EQ(again->parameters, pack.parameters);
}

TEST_F(ImportMaterials, KeysOverrideAPreset) {
  const ScenePack pack = packOf(R"([[material]]
preset = "pebbles"
name = "scree-2"
colour = "#0102Ff"
texture = "grass"
grain_size_m = 0.05
grain_height_m = 0.0123
angleOfRepose = 45
compression = 0.5
compactionLimit = 0.25
roughness = 0.75
diffusion = 0.125
frictionInverse = 0.25
)");
  EXPECT_EQ(pack.materials, (std::vector<Material>{{"scree-2", {1, 2, 255}, MaterialTexture::grass, 500, 123}}));
  MaterialRules expected = rules(1000, 1414, 32768, 16384, 8192, 1 << 30, 32768);
  expected.roughness_q16 = 49152;
  EXPECT_EQ(pack.parameters.materials, std::vector<MaterialRules>{expected});
  EXPECT_EQ(packOf("[[material]]\npreset = \"mud\"\nslopeThreshold = 1\n").parameters.materials[0].slope_threshold_q,
            1003);  // 10^4 tan 0.1 = 1003.3
}

TEST_F(ImportMaterials, WithoutAPresetItIsPlain) {
  const ScenePack pack = packOf("[[material]]\nname = \"x\"\n");
  EXPECT_EQ(pack.materials, (std::vector<Material>{{"x", {128, 128, 128}, MaterialTexture::plain, 0, 0}}));
  EXPECT_EQ(pack.parameters, packOf("").parameters) << "35 degrees, and no more";
}

TEST_F(ImportMaterials, WhatIsNotAMaterialsStaysInItsTables) {
  const ScenePack pack = packOf("[soil]\nsweeps_per_tick = 3\nobstacle_threshold_m = 0.5\n" + kTwo,
                                "[thesis]\nslopes = \"drift\"\npreset = \"thesis-ssbo\"\n");
  EXPECT_EQ(pack.parameters.sweeps_per_tick, 3);
  EXPECT_EQ(pack.parameters.obstacle_threshold_q, 5000);
  EXPECT_EQ(pack.parameters.slopes, SlopeRule::drift);
  EXPECT_EQ(pack.parameters.capacity_rounds, 1);
}

TEST_F(ImportMaterials, WrongKeysNameLineKeyAndReason) {
  const auto material = [](const std::string& lines) { return "[[material]]\nname = \"a\"\n" + lines; };
  expectWrong("[[material]]\n", {"soils.toml:9: ", "material[0].name", "missing"});
  expectWrong(material("preset = \"clay\""), {":11: ", "material[0].preset", "mud, pebbles, sand, snow, dust, gravel"});
  expectWrong(material("[[material]]\nname = \"a\""), {"material[1].name", "'a' is there already"});
  for (const char* name : {"", "a.b", "a=b", "a,b", "a b", "\\u00e4"})
    expectWrong("[[material]]\nname = \"" + std::string(name) + "\"", {"material[0].name", "1 .. 64 letters"});
  expectWrong("[[material]]\nname = \"" + std::string(65, 'x') + "\"", {"material[0].name", "1 .. 64 letters"});
  for (const char* colour : {"red", "#12345", "#1234567", "#12345g", "#+1+2+3", ""})
    expectWrong(material("colour = \"" + std::string(colour) + "\""), {"material[0].colour", "\"#rrggbb\""});
  expectWrong(material("texture = \"lava\""), {"material[0].texture", "plain, snow, sand, mud, pebbles"});
  expectWrong(material("grain_size_m = -1"), {"material[0].grain_size_m", "0 .. 100 m"});
  expectWrong(material("grain_height_m = 101"), {"material[0].grain_height_m", "0 .. 100 m"});
  expectWrong(material("angleOfRepose = 90"), {"material[0].angleOfRepose", "0 .. 89 degrees"});
  expectWrong(material("angleOfRepose = 9\nslopeThreshold = 1"), {"material[0].angleOfRepose", "says the same"});
  expectWrong(material("compression = 2"), {"material[0].compression", "0 .. 1"});
  expectWrong(material("compactionLimit = -1"), {"material[0].compactionLimit", "0 .. 1"});
  expectWrong(material("roughness = \"a\""), {"material[0].roughness", "must be a number"});
  expectWrong(material("diffusion = 5"), {"material[0].diffusion", "0 .. 4"});
  expectWrong(material("frictionInverse = 1"), {"material[0].frictionInverse", "0 .. 0.4999"});
  expectWrong(material("sweeps = 1"), {"material[0].sweeps", "unknown key"});
  expectWrong(material("slopes = \"drift\""), {"material[0].slopes", "unknown key"});
  expectWrong(material("[soil]\nrepose_deg = 30"), {":12: ", "soil.repose_deg", "each [[material]] has its own"});
  for (const char* key : {"compression", "roughness", "slopeThreshold", "angleOfRepose", "compactionLimit", "diffusion",
                          "frictionInverse"})
    expectWrong(kTwo, {"thesis." + std::string(key), "each [[material]] has its own"},
                "[thesis]\n" + std::string(key) + " = 0.1\n");
  std::string many;
  for (int i = 0; i < 17; ++i) many += "[[material]]\nname = \"m" + std::to_string(i) + "\"\n";
  expectWrong(many, {"material", "17 tables, the limit is 16"});
  expectWrong("[material]\nname = \"a\"\n", {"material", "must be a list of tables"});
}

TEST_F(ImportMaterials, AnAngleThatRoundsToNothingIsNoted) {
  const auto imported = import("[[material]]\nname = \"water\"\nangleOfRepose = 0.01\n");
  ASSERT_TRUE(imported) << imported.error();
  EXPECT_EQ(imported->pack.parameters.materials[0].slope_threshold_q, 1);
  EXPECT_TRUE(anyContains(imported->notes, "material[0].angleOfRepose: 0.01 degrees are less than 0.1 mm per cell"));
}

TEST_F(ImportMaterials, AnImageIsReadByItsLegendOverTheWorld) {
  // Binary PPM, 2 x 2: mud and sand in the north, sand and sand in the south.
  const std::string mud = "\x10\x20\x30", sand = "\xf0\xe0\xd0";
  write("map.ppm", "P6 2 2 255\n" + mud + sand + sand + sand);
  const ScenePack pack =
      packOf(kTwo + "[materials]\nimage = \"map.ppm\"\nlegend = { \"#102030\" = \"mud\", \"#F0e0d0\" = \"sand\" }\n");
  EXPECT_EQ(pack.material_map.kind, MaterialMapKind::image);
  EXPECT_EQ(pack.material_map.image.material, (std::vector<std::uint8_t>{1, 1, 0, 1})) << "the south comes first";
  EXPECT_EQ(pack.material_map.image.step_x_q32, 214748365);  // 2^32 / 20 = 214748364.8
  const auto map = mapOf(pack);
  EXPECT_EQ(map[0 * 40 + 0], 1);
  EXPECT_EQ(map[10 * 40 + 19], 0);
  EXPECT_EQ(map[19 * 40 + 19], 0);
  EXPECT_EQ(map[10 * 40 + 20], 1);
  EXPECT_EQ(map[9 * 40 + 19], 1);
}

TEST_F(ImportMaterials, AnImageOfValuesMayHaveItsOwnScale) {
  write("map.asc", "ncols 3\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n7 2.5 7\n");
  const auto imported = import(kTwo + R"([materials]
image = "map.asc"
otherwise = "sand"
pixel_m = 0.5
[materials.legend]
7 = "mud"
)");
  ASSERT_TRUE(imported) << imported.error();
  EXPECT_EQ(imported->pack.material_map.image.material, (std::vector<std::uint8_t>{0, 1, 0}));
  EXPECT_EQ(imported->pack.material_map.image.step_x_q32, 858993459);  // 0.2 * 2^32
  const auto map = mapOf(imported->pack);
  EXPECT_EQ(map[4], 0);
  EXPECT_EQ(map[5], 1);
  EXPECT_EQ(map[10], 0);
  EXPECT_EQ(map[799], 0) << "its border continues";
  EXPECT_TRUE(anyContains(imported->notes, "the world reaches beyond its 1.5 x 0.5 m"));
}

TEST_F(ImportMaterials, GreyAndPalettesAreColoursToo) {
  write("grey.pgm", std::string("P5 2 1 255\n") + '\x40' + '\x41');
  const std::string legend = "legend = { \"#404040\" = \"mud\", \"#414141\" = \"sand\" }\n";
  EXPECT_EQ(packOf(kTwo + "[materials]\nimage = \"grey.pgm\"\n" + legend).material_map.image.material,
            (std::vector<std::uint8_t>{0, 1}));
  // GIF, 1 x 1, palette of #102030 and #f0e0d0, its pixel of the second.
  const char gif[] = "GIF89a\x01\0\x01\0\x80\0\0\x10\x20\x30\xf0\xe0\xd0,\0\0\0\0\x01\0\x01\0\0\x02\x02L\x01\0;";
  write("palette.gif", std::string(gif, sizeof gif - 1));
  EXPECT_EQ(packOf(kTwo + "[materials]\nimage = \"palette.gif\"\nlegend = { \"#f0e0d0\" = \"sand\" }\n")
                .material_map.image.material,
            std::vector<std::uint8_t>{1});
}

TEST_F(ImportMaterials, WrongMapsNameFileKeyAndReason) {
  write("map.ppm", std::string("P6 2 1 255\n\x10\x20\x30\x10\x20\x31"));
  write("cut.ppm", std::string("P6 2 9 255\n\x10\x20\x30\x10\x20\x31"));
  write("deep.asc", "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n");
  write("text.png", "not a picture");
  const auto image = [](const std::string& lines) { return kTwo + "[materials]\n" + lines; };
  const std::string legend = "legend = { \"#102030\" = \"mud\" }\n";
  expectWrong(image(""), {"materials.image", "missing; an image with its legend, or [[materials.rule]]"});
  expectWrong(image("image = \"none.png\"\n" + legend), {"materials.image", "none.png: no such file"});
  expectWrong(image("image = \"text.png\"\n" + legend), {"materials.image", "text.png: not a raster"});
  expectWrong(image("image = \"cut.ppm\"\n" + legend), {"materials.image", "cut.ppm"});
  expectWrong(image("image = \"map.ppm\"\n"), {"materials.legend", "missing"});
  expectWrong(image("image = \"map.ppm\"\nlegend = 3\n"), {"materials.legend", "must be a table"});
  expectWrong(image("image = \"map.ppm\"\n" + legend),
              {"materials.image", "map.ppm: colour #102031 at column 1, row 0 is not in the legend", "otherwise"});
  expectWrong(image("image = \"deep.asc\"\nlegend = { 1 = \"mud\" }\n"), {"value 2 at column 1, row 0"});
  expectWrong(image("image = \"deep.asc\"\n" + legend), {"deep.asc: holds no colours of 8 bits"});
  expectWrong(image("image = \"map.ppm\"\nlegend = { \"#102030\" = \"clay\" }\n"),
              {"materials.legend.#102030", "no [[material]] is named 'clay'"});
  expectWrong(image("image = \"map.ppm\"\nlegend = { red = \"mud\" }\n"), {"materials.legend.red", "must be a colour"});
  expectWrong(image("image = \"map.ppm\"\nlegend = { nan = \"mud\" }\n"), {"materials.legend.nan", "must be a colour"});
  expectWrong(image("image = \"map.ppm\"\nlegend = { \"#102030\" = \"mud\", 3 = \"sand\" }\n"),
              {"either colours or values"});
  expectWrong(image("image = \"map.ppm\"\notherwise = \"clay\"\n" + legend), {"materials.otherwise", "'clay'"});
  expectWrong(image("image = \"map.ppm\"\notherwise = \"mud\"\npixel_m = 0\n" + legend), {"materials.pixel_m"});
  expectWrong(image("image = \"map.ppm\"\notherwise = \"mud\"\npixel_m = 0.001\n" + legend),
              {"materials.pixel_m", "more than 64 per cell of 0.1 m"});
  expectWrong(image("image = \"map.ppm\"\n" + legend + "[[materials.rule]]\nmaterial = \"mud\"\n"),
              {"materials.rule", "either image or"});
  expectWrong(image("colour = 3\n[[materials.rule]]\nmaterial = \"mud\"\n"), {"materials.colour", "unknown key"});
  expectWrong("[materials]\nimage = \"map.ppm\"\n" + legend, {"no [[material]] is named 'mud'"});
  const auto rule = [&](const std::string& lines) { return image("[[materials.rule]]\nmaterial = \"mud\"\n" + lines); };
  expectWrong(image("[[materials.rule]]\n"), {"materials.rule[0].material", "missing"});
  expectWrong(image("[[materials.rule]]\nmaterial = \"clay\"\n"), {"materials.rule[0].material", "'clay'"});
  expectWrong(rule("lowest_m = 2\nhighest_m = 1\n"), {"materials.rule[0].highest_m", "below lowest_m"});
  expectWrong(rule("lowest_m = -100001\n"), {"materials.rule[0].lowest_m", "-100000 .. 100000 m"});
  expectWrong(rule("gentlest_deg = 20\nsteepest_deg = 10\n"), {"materials.rule[0].steepest_deg", "less than"});
  expectWrong(rule("steepest_deg = 91\n"), {"materials.rule[0].steepest_deg", "0 .. 90 degrees"});
  expectWrong(rule("slope = 1\n"), {"materials.rule[0].slope", "unknown key"});
  std::string many = kTwo + "[materials]\n";
  for (int i = 0; i < 65; ++i) many += "[[materials.rule]]\nmaterial = \"mud\"\n";
  expectWrong(many, {"material map: 65 rules, the limit is 64"});
}

TEST_F(ImportMaterials, RulesHaveTheirIntegersAndTheFirstThatHoldsCounts) {
  const ScenePack pack = packOf(kTwo + R"([[materials.rule]]
material = "sand"
lowest_m = 1.25
steepest_deg = 45
[[materials.rule]]
material = "mud"
highest_m = 1.5
gentlest_deg = 45
[[materials.rule]]
material = "sand"
)");
  ASSERT_EQ(pack.material_map.kind, MaterialMapKind::rules);
  const std::vector<MaterialRule> expected = {{1, 12500, rules::kHeightLimit, 0, 1000},
                                              {0, -rules::kHeightLimit, 15000, 1000, INT32_MAX},
                                              {1, -rules::kHeightLimit, rules::kHeightLimit, 0, INT32_MAX}};
  EXPECT_EQ(pack.material_map.rules, expected);
  const auto none = mapOf(packOf(kTwo + "[[materials.rule]]\nmaterial = \"sand\"\nlowest_m = 50\n"));
  EXPECT_EQ(std::ranges::count(none, 0), 800) << "the first material lies where no rule holds";
}

/// Three materials, their names, and the parameters of cells of 0.1 m.
ScenePack namedPack() {
  ScenePack pack;
  pack.width_cells = pack.height_cells = 100;
  pack.cell_q = 1000;
  pack.materials = {{"mud"}, {"sand"}, {"x"}};
  pack.parameters.materials.resize(3);
  return pack;
}

/// What assignments make of the pack's parameters: the change in words, or why not.
std::string changeOf(const ScenePack& pack, const std::vector<const char*>& assignments) {
  std::vector<NamedValue> values;
  for (const char* text : assignments) {
    const auto value = parseNamed(text);
    if (!value) return value.error();
    values.push_back(*value);
  }
  std::vector<std::string> notes;
  const auto changed = changeParameters(pack, pack.parameters, values, notes);
  return changed ? describeChange(pack, pack.parameters, *changed) : changed.error();
}

TEST(MaterialNames, APlainNameIsOfAllAndADottedOneOfOne) {
  const ScenePack pack = namedPack();
  EXPECT_EQ(changeOf(pack, {"roughness=0.5"}), "roughness 1 -> 0.5");
  EXPECT_EQ(changeOf(pack, {"sand.roughness=0.5"}), "sand.roughness 1 -> 0.5");
  EXPECT_EQ(changeOf(pack, {" sand.roughness = 0.25 ", "roughness=0.5"}),
            "mud.roughness 1 -> 0.5, sand.roughness 1 -> 0.25, x.roughness 1 -> 0.5")
      << "single ones count, in any order";
  EXPECT_EQ(changeOf(pack, {"mud.angleOfRepose=45", "slopeThreshold=0"}),
            "mud.slopeThreshold 0.001 (0.0001 m rest, 0 degrees) -> 0.997 (0.1 m rest, 45 degrees), "
            "sand.slopeThreshold 0.001 (0.0001 m rest, 0 degrees) -> 0 (0 m rest, 0 degrees), "
            "x.slopeThreshold 0.001 (0.0001 m rest, 0 degrees) -> 0 (0 m rest, 0 degrees)");
  EXPECT_EQ(changeOf(pack, {"x.frictionInverse=6e-4", "mud.diffusion=0.25"}),
            "mud.diffusion 1 -> 0.25, x.frictionInverse 0 -> 0.0006");
  EXPECT_EQ(changeOf(pack, {"compression=0"}), "");
}

TEST(MaterialNames, WhatIsWrongIsSaid) {
  const ScenePack pack = namedPack();
  EXPECT_EQ(changeOf(pack, {"clay.roughness=0.5"}),
            "clay.roughness: no material is named 'clay'; there are: mud, sand, x");
  EXPECT_EQ(changeOf(pack, {".roughness=0.5"}), "'.roughness' names no material");
  EXPECT_EQ(changeOf(pack, {"mud.spreadCells=5"}), "'mud.spreadCells' is no parameter of a material");
  EXPECT_EQ(changeOf(pack, {"mud.=5"}), "'mud.' is no parameter (scenes/README.md, [thesis])");
  EXPECT_EQ(changeOf(pack, {"mud.roughness=5"}), "roughness: '5' is not a number within 0 .. 1");
  EXPECT_EQ(changeOf(pack, {"mud.roughness=0.5", "mud.roughness=0.4"}), "mud.roughness: given twice");
  EXPECT_EQ(changeOf(pack, {"mud.slopeThreshold=1", "mud.angleOfRepose=3"}),
            "mud.angleOfRepose: slopeThreshold is given too and says the same; give one of the two");
  EXPECT_EQ(changeOf(pack, {"mu\x1b.roughness=0.5"}), "'mu?.roughness' names no material");
  const auto long_name = parseNamed(std::string(100000, 'x') + ".roughness=1");
  ASSERT_FALSE(long_name);
  EXPECT_LT(long_name.error().size(), 200u);
}

TEST(MaterialNames, DescriptionsHaveALineForEachWhereTheyDiffer) {
  ScenePack pack = namedPack();
  const auto has = [&](const std::string& line) {
    const auto lines = describeParameters(pack, pack.parameters);
    return std::ranges::count(lines, line);
  };
  EXPECT_EQ(has("roughness 1"), 1);
  pack.parameters.materials[2].roughness_q16 = 32768;
  EXPECT_EQ(has("roughness 1"), 0);
  EXPECT_EQ(has("mud.roughness 1"), 1);
  EXPECT_EQ(has("x.roughness 0.5"), 1);
}

}  // namespace
}  // namespace spoor
