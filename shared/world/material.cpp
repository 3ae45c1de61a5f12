#include "shared/world/material.h"

#include <algorithm>

#include "shaders/rules/limits.h"

namespace spoor {
namespace {

constexpr std::size_t kNameLimit = 64;
constexpr std::size_t kRulesLimit = 64;
constexpr std::int32_t kGrainLimit = 1 << 20;  // 0.1 mm

Status validateImage(const MaterialImage& image, std::size_t material_count) {
  constexpr std::int32_t side = 1 << 20;
  constexpr std::int64_t step = std::int64_t(1) << 38;
  if (image.column_count < 1 || image.row_count < 1 || image.column_count > side || image.row_count > side)
    return Error{"material map: an image of " + std::to_string(image.column_count) + " x " +
                 std::to_string(image.row_count)};
  if (image.step_x_q32 < 1 || image.step_y_q32 < 1 || image.step_x_q32 > step || image.step_y_q32 > step)
    return Error{"material map: a step of its image is not within 1 .. 2^38"};
  if (image.material.size() != std::size_t(image.column_count) * std::size_t(image.row_count))
    return Error{"material map: its image holds " + std::to_string(image.material.size()) +
                 " samples, not column_count * row_count"};
  const auto highest = std::ranges::max(image.material);
  if (highest >= material_count)
    return Error{"material map: its image names material " + std::to_string(highest) + " of " +
                 std::to_string(material_count)};
  return {};
}

Status validateRule(const MaterialRule& rule, std::size_t material_count) {
  if (rule.material < 0 || std::size_t(rule.material) >= material_count)
    return Error{"material map: a rule names material " + std::to_string(rule.material) + " of " +
                 std::to_string(material_count)};
  if (rule.lowest_q < -rules::kHeightLimit || rule.highest_q > rules::kHeightLimit || rule.lowest_q > rule.highest_q)
    return Error{"material map: a rule for heights of " + std::to_string(rule.lowest_q) + " .. " +
                 std::to_string(rule.highest_q)};
  if (rule.gentlest_q < 0 || rule.gentlest_q > rule.steepest_q)
    return Error{"material map: a rule for slopes of " + std::to_string(rule.gentlest_q) + " .. " +
                 std::to_string(rule.steepest_q)};
  return {};
}

}  // namespace

Status validateMaterials(const std::vector<Material>& materials, const MaterialMap& map) {
  if (materials.empty() || materials.size() > kMaterialsLimit)
    return Error{std::to_string(materials.size()) + " materials, not within 1 .. " + std::to_string(kMaterialsLimit)};
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const Material& material = materials[i];
    const std::string name = "material '" + material.name + "'";
    if (material.name.empty() || material.name.size() > kNameLimit)
      return Error{"material " + std::to_string(i) + ": a name of " + std::to_string(material.name.size()) +
                   " characters, not within 1 .. " + std::to_string(kNameLimit)};
    for (std::size_t j = 0; j < i; ++j)
      if (materials[j].name == material.name) return Error{name + " is there twice"};
    if (int(material.texture) >= kMaterialTextureCount)
      return Error{name + ": texture " + std::to_string(int(material.texture)) + " is none"};
    for (const std::int32_t grain : {material.grain_size_q, material.grain_height_q})
      if (grain < 0 || grain > kGrainLimit)
        return Error{name + ": grains of " + std::to_string(grain) + ", not within 0 .. " +
                     std::to_string(kGrainLimit)};
  }
  if (int(map.kind) > int(MaterialMapKind::rules)) return Error{"material map: of an unknown kind"};
  if (map.kind != MaterialMapKind::image && map.image != MaterialImage{})
    return Error{"material map: an image given, and not asked for"};
  if (map.kind != MaterialMapKind::rules && !map.rules.empty())
    return Error{"material map: rules given, and not asked for"};
  if (map.rules.size() > kRulesLimit)
    return Error{"material map: " + std::to_string(map.rules.size()) + " rules, the limit is " +
                 std::to_string(kRulesLimit)};
  if (map.kind == MaterialMapKind::image) return validateImage(map.image, materials.size());
  for (const MaterialRule& rule : map.rules)
    if (Status status = validateRule(rule, materials.size()); !status) return status;
  return {};
}

}  // namespace spoor
