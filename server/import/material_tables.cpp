// [[material]]: what lies in the world, how it looks and how it moves.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "server/import/material_presets.h"
#include "server/import/pack_maker.h"
#include "server/import/scene_parts.h"
#include "server/import/thesis_table.h"
#include "server/import/units.h"

namespace spoor {
namespace {

constexpr Range kGrainRange{0, 100, "m"};

const MaterialPreset* readPreset(TableReader& table) {
  std::vector<std::string> names;
  for (const MaterialPreset& preset : materialPresets()) names.emplace_back(preset.name);
  const std::string name = table.choice("preset", names, "");
  const auto found = std::ranges::find(materialPresets(), name, &MaterialPreset::name);
  return found == materialPresets().end() ? nullptr : &*found;
}

std::int32_t readGrain(TableReader& table, const char* key, double otherwise_m) {
  return toUnits(table.number(key, kGrainRange, otherwise_m));
}

Material readLook(TableReader& table, const MaterialPreset* preset) {
  Material material;
  material.name = table.text("name", preset ? std::optional(std::string(preset->name)) : std::nullopt);
  if (!isMaterialName(material.name)) table.wrong("name", "must be 1 .. 64 letters, digits, _ or -");
  const std::string colour = table.text("colour", std::string(preset ? preset->colour : "#808080"));
  if (const auto channels = parseColour(colour))
    material.colour = *channels;
  else
    table.wrong("colour", "must be \"#rrggbb\"");
  const std::vector<std::string>& textures = textureNames();
  const std::string texture =
      table.choice("texture", textures, textures[std::size_t(preset ? preset->texture : MaterialTexture::plain)]);
  material.texture = MaterialTexture(std::ranges::find(textures, texture) - textures.begin());
  material.grain_size_q = readGrain(table, "grain_size_m", preset ? preset->grain_size_m : 0);
  material.grain_height_q = readGrain(table, "grain_height_m", preset ? preset->grain_height_m : 0);
  return material;
}

/// What a preset, or none, says of how it moves.
MaterialRules presetRules(const MaterialPreset* preset, std::int32_t cell_q) {
  NamedSettings settings;
  std::vector<NamedValue> values = {{findNamed("angleOfRepose"), preset ? preset->repose_deg : kDefaultReposeDeg}};
  if (preset) {
    values.push_back({findNamed("compression"), preset->compression});
    values.push_back({findNamed("compactionLimit"), preset->compaction_limit});
    values.push_back({findNamed("diffusion"), preset->diffusion});
    values.push_back({findNamed("frictionInverse"), preset->friction_inverse});
  }
  std::vector<std::string> unused;
  (void)applyNamed(values, cell_q, settings, unused);
  return settings.parameters.materials[0];
}

}  // namespace

std::optional<std::array<std::uint8_t, 3>> parseColour(std::string_view text) {
  if (text.size() != 7 || text[0] != '#') return {};
  std::array<std::uint8_t, 3> colour;
  for (std::size_t i = 0; i < 3; ++i) {
    const char* const first = text.data() + 1 + 2 * i;
    const auto end = std::from_chars(first, first + 2, colour[i], 16);
    if (end.ec != std::errc{} || end.ptr != first + 2) return {};
  }
  return colour;
}

void readMaterialTables(TableReader& file, TableReader& soil, TableReader& thesis, const SceneErrors& errors,
                        SceneDraft& draft) {
  ScenePack& pack = draft.scene.pack;
  std::vector<TableReader> tables = file.tables("material");
  if (tables.empty()) return;
  const auto refuse = [&](TableReader& table, std::string_view key) {
    if (table.has(key)) table.wrong(key, "each [[material]] has its own; give it there");
  };
  refuse(soil, "repose_deg");
  for (const NamedParameter& parameter : namedParameters())
    if (parameter.isOfMaterial()) refuse(thesis, parameter.name);
  if (tables.size() > kMaterialsLimit)
    file.wrong("material", fmt::format("{} tables, the limit is {}", tables.size(), kMaterialsLimit));
  if (errors.failed()) return;
  pack.materials.clear();
  pack.parameters.materials.clear();
  for (TableReader& table : tables) {
    const MaterialPreset* preset = readPreset(table);
    Material material = readLook(table, preset);
    if (std::ranges::find(pack.materials, material.name, &Material::name) != pack.materials.end())
      table.wrong("name", "'" + material.name + "' is there already");
    NamedSettings settings;
    settings.parameters.materials[0] = presetRules(preset, pack.cell_q);
    const std::vector<NamedValue> values = readNamedValues(table, NamedKeys::of_material);
    table.finish();
    if (errors.failed()) return;
    applyToTable(values, pack.cell_q, table, settings, draft.scene.notes);
    if (errors.failed()) return;
    pack.materials.push_back(std::move(material));
    pack.parameters.materials.push_back(settings.parameters.materials[0]);
  }
}

}  // namespace spoor
