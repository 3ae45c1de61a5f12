// Materials: which lies where, and that packs, sessions and snapshots hold them, snowfalls with them.
#include "shared/world/material.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <random>

#include "shared/codec/session.h"
#include "tests/scenes.h"

namespace spoor::test {
namespace {

constexpr std::int64_t kOne = std::int64_t(1) << 32;

/// A pack with `count` materials.
ScenePack manyMaterials(ScenePack pack, int count) {
  for (int i = 1; i < count; ++i) {
    pack.materials.push_back(
        {"material " + std::to_string(i), {1, 2, std::uint8_t(i)}, MaterialTexture::mud, i, 2 * i});
    pack.parameters.materials.push_back(pack.parameters.materials[0]);
    pack.parameters.materials.back().slope_threshold_q = 100 * i;
  }
  return pack;
}

ScenePack withImage(ScenePack pack, int columns, int rows, std::int64_t step_x, std::int64_t step_y,
                    std::vector<std::uint8_t> samples) {
  pack.material_map.kind = MaterialMapKind::image;
  pack.material_map.image = {columns, rows, step_x, step_y, std::move(samples)};
  return pack;
}

ScenePack withRules(ScenePack pack, std::vector<MaterialRule> rules) {
  pack.material_map.kind = MaterialMapKind::rules;
  pack.material_map.rules = std::move(rules);
  return pack;
}

std::vector<std::int32_t> mapOf(const ScenePack& pack) {
  EXPECT_TRUE(validatePack(pack)) << (validatePack(pack) ? "" : validatePack(pack).error());
  std::vector<std::int32_t> map(std::size_t(pack.width_cells) * std::size_t(pack.height_cells));
  BaseTerrain(pack).fillMaterials(0, 0, 1, pack.width_cells, pack.height_cells, map);
  return map;
}

TEST(MaterialMap, WithoutOneAllIsTheFirst) {
  EXPECT_EQ(mapOf(manyMaterials(flatPack(3, 2), 3)), (std::vector<std::int32_t>(6, 0)));
}

TEST(MaterialMap, ACellTakesTheSampleItsCentreLiesIn) {
  const ScenePack pack = manyMaterials(flatPack(6, 4), 4);
  EXPECT_EQ(mapOf(withImage(pack, 3, 2, kOne / 2, kOne / 2, {1, 2, 3, 0, 1, 2})),
            (std::vector<std::int32_t>{1, 1, 2, 2, 3, 3, 1, 1, 2, 2, 3, 3, 0, 0, 1, 1, 2, 2, 0, 0, 1, 1, 2, 2}));
  // Three samples over four cells, a quarter too few: centres at 0.375, 1.125, 1.875, 2.625; the last sample goes on.
  EXPECT_EQ(mapOf(withImage(pack, 3, 1, 3 * kOne / 4, kOne, {1, 2, 3})),
            (std::vector<std::int32_t>{1, 2, 2, 3, 3, 3, 1, 2, 2, 3, 3, 3, 1, 2, 2, 3, 3, 3, 1, 2, 2, 3, 3, 3}));
  // More samples than cells: centres at 1, 3, 5, ..
  EXPECT_EQ(mapOf(withImage(pack, 12, 1, 2 * kOne, kOne, {0, 1, 0, 2, 0, 3, 0, 1, 0, 2, 0, 3})),
            (std::vector<std::int32_t>{1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3}));
}

TEST(MaterialMap, TheFirstRuleThatHoldsDecides) {
  const ScenePack pack = manyMaterials(groundPack(4, 1, {0, 100, 250, 1000}, 50), 4);
  constexpr std::int32_t kAny = 1 << 29;
  // Heights 0, 100, 250, 1000: slopes 100, 125, 450, 750.
  EXPECT_EQ(mapOf(withRules(pack, {{1, 100, 250, 0, kAny}})), (std::vector<std::int32_t>{0, 1, 1, 0}));
  EXPECT_EQ(mapOf(withRules(pack, {{1, -kAny, kAny, 125, 450}})), (std::vector<std::int32_t>{0, 1, 1, 0}));
  EXPECT_EQ(mapOf(withRules(pack, {{1, -kAny, kAny, 126, 449}})), (std::vector<std::int32_t>{0, 0, 0, 0}));
  EXPECT_EQ(mapOf(withRules(pack, {{1, 100, 1000, 0, kAny}, {2, 250, 1000, 0, kAny}, {3, -kAny, kAny, 0, kAny}})),
            (std::vector<std::int32_t>{3, 1, 1, 1}));
  EXPECT_EQ(mapOf(withRules(pack, {{2, 250, 1000, 0, kAny}, {1, 100, 1000, 0, kAny}})),
            (std::vector<std::int32_t>{0, 1, 2, 2}));
  EXPECT_EQ(mapOf(withRules(pack, {})), (std::vector<std::int32_t>(4, 0)));
  const ScenePack column = manyMaterials(groundPack(1, 3, {0, 100, 400}, 50), 2);
  EXPECT_EQ(mapOf(withRules(column, {{1, -kAny, kAny, 200, 300}})), (std::vector<std::int32_t>{0, 1, 1}));
  const ScenePack one = manyMaterials(groundPack(1, 1, {7}, 50), 2);
  EXPECT_EQ(mapOf(withRules(one, {{1, 7, 7, 0, 0}})), (std::vector<std::int32_t>{1})) << "a single cell is level";
}

TEST(MaterialMap, SlopeIsTheGradientsLength) {
  std::vector<std::int32_t> ground;
  for (int i = 0; i < 25; ++i) ground.push_back(i % 5 * 30 + i / 5 * 40);  // 50 in its direction
  const ScenePack pack = manyMaterials(groundPack(5, 5, ground, 50), 2);
  constexpr std::int32_t kAny = 1 << 29;
  EXPECT_EQ(mapOf(withRules(pack, {{1, -kAny, kAny, 50, 50}})), (std::vector<std::int32_t>(25, 1)));
  EXPECT_EQ(mapOf(withRules(pack, {{1, -kAny, kAny, 51, kAny}})), (std::vector<std::int32_t>(25, 0)));
}

TEST(MaterialMap, EqualsTheOracleAnyViewAndEveryTile) {
  for (std::uint32_t seed = 0; seed < 24; ++seed) {
    ScenePack pack = noisePack(90 + int(seed), 140 - int(seed), seed, -6000, 6000, 900);
    pack.parameters = randomParameters(seed, 4);
    addMaterials(pack, 4, seed);
    const World world(std::move(pack));
    const auto map = mapOf(world.pack);
    const int width = world.pack.width_cells, height = world.pack.height_cells;
    std::vector<std::int32_t> view(30 * 20);
    world.base.fillMaterials(-13, -9, 7, 30, 20, view);
    for (int i = 0; i < 600; ++i) {
      const int x = -13 + 7 * (i % 30), y = -9 + 7 * (i / 30);
      const bool inside = x >= 0 && y >= 0 && x < width && y < height;
      ASSERT_EQ(view[std::size_t(i)], inside ? map[std::size_t(y * width + x)] : 0);
    }
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        ASSERT_EQ(map[std::size_t(y * width + x)], oracleMaterial(world.base, x, y)) << seed << ": " << x << ", " << y;
    const auto tile = makeTile({1, 1}, {&world.base}, 0);
    for (int i = 0; i < rules::kTileCells; ++i) {
      const int x = 64 + i % 64, y = 64 + i / 64;
      const int here = tile->material() == nullptr ? 0 : (*tile->material())[std::size_t(i)];
      ASSERT_EQ(here, x < width && y < height ? map[std::size_t(y * width + x)] : 0);
    }
  }
}

TEST(Materials, WhatCannotBeIsRefused) {
  const ScenePack good = withRules(manyMaterials(flatPack(4, 4), 3), {{2, -5, 5, 0, 9}});
  ASSERT_TRUE(validatePack(good));
  const auto errorOf = [&](const std::function<void(ScenePack&)>& change, const ScenePack& pack) {
    ScenePack bad = pack;
    change(bad);
    const Status status = validatePack(bad);
    return status ? std::string() : status.error();
  };
  const ScenePack image = withImage(manyMaterials(flatPack(4, 4), 3), 2, 1, kOne, kOne, {2, 0});
  ASSERT_TRUE(validatePack(image));
  const std::vector<std::pair<std::string, std::string>> found = {
      {errorOf([](ScenePack& p) { p.materials.clear(); }, good), "0 materials"},
      {errorOf([](ScenePack& p) { p = manyMaterials(p, 15); }, good), "17 materials"},
      {errorOf([](ScenePack& p) { p.materials[1].name = "soil"; }, good), "'soil' is there twice"},
      {errorOf([](ScenePack& p) { p.materials[1].name = ""; }, good), "a name of 0"},
      {errorOf([](ScenePack& p) { p.materials[1].texture = MaterialTexture(kMaterialTextureCount); }, good), "texture"},
      {errorOf([](ScenePack& p) { p.materials[1].grain_size_q = -1; }, good), "grains of -1"},
      {errorOf([](ScenePack& p) { p.parameters.materials.pop_back(); }, good), "of 2 materials, the pack has 3"},
      {errorOf([](ScenePack& p) { p.material_map.kind = MaterialMapKind(3); }, good), "unknown kind"},
      {errorOf([](ScenePack& p) { p.material_map.kind = MaterialMapKind::one; }, good), "rules given"},
      {errorOf([](ScenePack& p) { p.material_map.kind = MaterialMapKind::one; }, image), "an image given"},
      {errorOf([](ScenePack& p) { p.material_map.rules.resize(65); }, good), "65 rules"},
      {errorOf([](ScenePack& p) { p.material_map.rules[0].material = 3; }, good), "names material 3 of 3"},
      {errorOf([](ScenePack& p) { p.material_map.rules[0].material = -1; }, good), "names material -1"},
      {errorOf([](ScenePack& p) { p.material_map.rules[0].lowest_q = 6; }, good), "heights of 6 .. 5"},
      {errorOf([](ScenePack& p) { p.material_map.rules[0].gentlest_q = -1; }, good), "slopes of -1"},
      {errorOf([](ScenePack& p) { p.material_map.rules[0].gentlest_q = 10; }, good), "slopes of 10 .. 9"},
      {errorOf([](ScenePack& p) { p.material_map.image.material[0] = 3; }, image), "names material 3 of 3"},
      {errorOf([](ScenePack& p) { p.material_map.image.material.pop_back(); }, image), "holds 1 samples"},
      {errorOf([](ScenePack& p) { p.material_map.image.column_count = 0; }, image), "an image of 0 x 1"},
      {errorOf([](ScenePack& p) { p.material_map.image.step_x_q32 = 0; }, image), "a step of its image"},
      {errorOf([](ScenePack& p) { p.material_map.image.step_y_q32 = (std::int64_t(1) << 38) + 1; }, image),
       "a step of its image"},
      {errorOf([](ScenePack& p) { p.parameters.materials[1].repose_q16 = kReposeLimit + 1; }, good),
       "material 1: repose_q16"},
      {errorOf(
           [](ScenePack& p) {
             p.snowfalls = {{{0, 0, 5, 4}, 1, 1, 1, 0}};
           },
           good),
       "area"}};
  for (const auto& [error, part] : found) EXPECT_NE(error.find(part), std::string::npos) << part << ": " << error;
}

/// Something of everything that is new: several materials, a map, snowfalls, drift, a body that grows.
ScenePack richPack(bool image) {
  ScenePack pack = manyMaterials(noisePack(70, 30, 9, -1500, 1500, 900), 3);
  pack = image ? withImage(pack, 5, 3, kOne / 15, kOne / 10, {0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2, 0, 1, 2})
               : withRules(pack, {{2, -500, 900, 0, 40}, {1, -5000, 9000, 30, 1000}});
  pack.snowfalls = {{{0, 0, 70, 30}, 3 * kOne, 1, 50, 4}, {{3, 4, 65, 20}, kOne / 5, 7, 9, 5}};
  pack.parameters.slopes = SlopeRule::drift;
  for (MaterialRules& own : pack.parameters.materials) own.friction_inverse_q32 = 1 << 22;
  addBody(pack, boxMesh(4000, 3000, 2000), 10000, 15000, 700);
  pack.bodies[0].force_n = 500;
  pack.bodies[0].first_scale_q16 = kFullScale / 2;
  pack.bodies[0].last_scale_tick = 9;
  return pack;
}

TEST(MaterialPack, DecodesToWhatWasEncodedAndRejectsEveryTruncation) {
  for (const bool image : {true, false}) {
    const ScenePack pack = richPack(image);
    const auto bytes = encodePack(pack);
    const auto decoded = decodePack(bytes);
    ASSERT_TRUE(decoded) << decoded.error();
    EXPECT_EQ(encodePack(*decoded), bytes);
    EXPECT_EQ(decoded->materials, pack.materials);
    EXPECT_EQ(decoded->material_map, pack.material_map);
    EXPECT_EQ(decoded->snowfalls, pack.snowfalls);
    EXPECT_EQ(decoded->parameters, pack.parameters);
    EXPECT_EQ(decoded->bodies[0].force_n, 500);
    EXPECT_EQ(decoded->bodies[0].first_scale_q16, kFullScale / 2);
    EXPECT_EQ(decoded->bodies[0].last_scale_tick, 9);
    for (std::size_t size = 0; size < bytes.size(); ++size)
      ASSERT_FALSE(decodePack(std::span(bytes).first(size))) << size << " of " << bytes.size();
  }
}

TEST(MaterialPack, DamagedBytesAreRefusedOrAValidPack) {
  const auto good = encodePack(richPack(true));
  std::mt19937 engine(8);
  for (int round = 0; round < 20000; ++round) {
    auto bytes = good;
    for (int left = 1 + round % 3; left > 0; --left) bytes[engine() % bytes.size()] ^= std::uint8_t(1u << engine() % 8);
    const auto decoded = decodePack(bytes);
    if (decoded) {
      ASSERT_TRUE(validatePack(*decoded));
      ASSERT_EQ(encodePack(*decoded), bytes);
    }
  }
}

TEST(MaterialSnapshot, HoldsMaterialsAndSnowfallsAndRejectsEveryTruncation) {
  for (const bool image : {true, false}) {
    const World world(richPack(image));
    Simulation simulation = world.simulate();
    const Snowfall snowfall{{0, 0, 9, 9}, kOne, 4, 5, 6};
    for (int tick = 1; tick <= 12; ++tick)
      ASSERT_TRUE(simulation.step(std::vector{moved(simulation.state().poses[0], 900, 0)}, {}, {},
                                  tick == 4 ? std::span(&snowfall, 1) : std::span<const Snowfall>()));
    const auto bytes = encodeSnapshot(simulation.state(), world.base);
    const auto decoded = decodeSnapshot(bytes, world.id, world.base);
    ASSERT_TRUE(decoded) << decoded.error();
    EXPECT_EQ(decoded->snowfalls, simulation.state().snowfalls);
    EXPECT_EQ(decoded->snowfalls.size(), 3u);
    EXPECT_EQ(decoded->parameters, simulation.state().parameters);
    EXPECT_EQ(stateHash(*decoded), stateHash(simulation.state()));
    EXPECT_NE(decoded->tiles.find({0, 0})->material(), nullptr);
    for (std::size_t size = 0; size < bytes.size(); size += size < 900 || size + 50 > bytes.size() ? 1 : 61)
      ASSERT_FALSE(decodeSnapshot(std::span(bytes).first(size), world.id, world.base)) << size;
  }
}

TEST(MaterialCodec, AChangeOfMaterialIsCarriedAndANumberThatIsNoneRefused) {
  const World world(richPack(true));
  WorldState state = initialState(world.id, world.base);
  const DormantGround dormant = dormantGround(state, world.base);
  for (const int number : {1, 2, 3}) {
    const auto tile = makeTile({1, 0}, dormant, 1);
    const auto before = makeTile({1, 0}, dormant, 1);
    PlaneCells& cells = *tile->planes[int(Plane::material)];
    cells[64 + 2] = number;
    cells[64 + 3] = 0;
    tile->hash = tileHash(*tile);
    const TileChange change = differenceOf(*tile, planesOf(*before), kDormantVersion);
    const auto decoded = decodeTiles(encodeTiles({&change, 1}), world.pack);
    ASSERT_TRUE(decoded) << decoded.error();
    ASSERT_EQ(decoded->at(0).material, change.material);
    const Status status = applyTiles(state, world.base, *decoded, 1);
    if (number == 3) {
      EXPECT_NE(status.error().find("a material that there is not"), std::string::npos);
      continue;
    }
    ASSERT_TRUE(status) << status.error();
    EXPECT_EQ((*state.tiles.find({1, 0})->material())[64 + 2], number);
    EXPECT_TRUE(recount(state));
    state = initialState(world.id, world.base);
  }
}

TEST(MaterialSession, RecordsSnowfallsAndParametersOfAllMaterialsAndIsCutOffCleanly) {
  const World world(richPack(false));
  const auto path = std::filesystem::path(::testing::TempDir()) / ("spoor_material_" + std::to_string(getpid()));
  const std::string name = path.string();
  Simulation simulation = world.simulate();
  Parameters changed = world.pack.parameters;
  changed.materials[2].diffusion_q16 = 777;
  const Snowfall snowfall{{0, 0, 9, 9}, kOne, 3, 5, 6};
  {
    auto writer = SessionWriter::create(name, encodePack(world.pack));
    ASSERT_TRUE(writer) << writer.error();
    for (int tick = 1; tick <= 6; ++tick) {
      const auto result = simulation.step(std::vector{moved(simulation.state().poses[0], 900, 0)},
                                          tick == 2 ? std::optional(changed) : std::nullopt, {},
                                          tick == 3 ? std::span(&snowfall, 1) : std::span<const Snowfall>());
      ASSERT_TRUE(result) << result.error();
      (*writer)->append({tick,
                         result->update.poses,
                         result->update.state_hash,
                         result->ledger,
                         result->update.parameters,
                         {},
                         result->update.snowfalls});
    }
    ASSERT_TRUE((*writer)->close());
  }
  Simulation replay = world.simulate();
  auto reader = SessionReader::open(name);
  ASSERT_TRUE(reader) << reader.error();
  for (int tick = 1; tick <= 6; ++tick) {
    const auto record = (*reader)->next();
    ASSERT_TRUE(record && *record);
    EXPECT_EQ((*record)->snowfalls.size(), tick == 3 ? 1u : 0u);
    const auto result = replay.step((*record)->poses, (*record)->parameters, {}, (*record)->snowfalls);
    ASSERT_TRUE(result) << result.error();
    ASSERT_EQ(result->update.state_hash, (*record)->state_hash) << tick;
    ASSERT_EQ(result->ledger, (*record)->ledger) << tick;
  }
  EXPECT_EQ(replay.state().parameters, changed);
  const auto whole = std::filesystem::file_size(path);
  for (auto size = whole; size > 0; size -= std::min<std::uintmax_t>(size, 7)) {
    std::filesystem::resize_file(path, size);
    auto cut = SessionReader::open(name);
    if (!cut) continue;  // the pack is cut off
    int ticks = 0;
    for (;;) {
      const auto record = (*cut)->next();
      ASSERT_TRUE(record) << record.error();
      if (!*record) break;
      ++ticks;
    }
    ASSERT_LE(ticks, 6);
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace spoor::test
