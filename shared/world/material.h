#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "shared/base/result.h"

namespace spoor {

/// How the surface of a material is drawn.
enum class MaterialTexture : std::uint8_t { plain, snow, sand, mud, pebbles, gravel, dust, dirt, grass };
inline constexpr int kMaterialTextureCount = 9;

/// What a material is called and looks like. How its soil moves is in Parameters::materials, at the same place.
struct Material {
  std::string name;                      // of the pack's materials, each another
  std::array<std::uint8_t, 3> colour{};  // sRGB
  MaterialTexture texture = MaterialTexture::plain;
  std::int32_t grain_size_q = 0;    // 0.1 mm, of the grains or pebbles that are drawn; 0: none
  std::int32_t grain_height_q = 0;  // 0.1 mm, how far they stand out of the ground, as it is drawn
  bool operator==(const Material&) const = default;
};

/// Materials are numbered from 0; a cell's number is its Plane::material.
inline constexpr std::size_t kMaterialsLimit = 16;

/// Which material lies where before anything else: the description map (Gilardi et al., figure 1).
enum class MaterialMapKind : std::uint8_t {
  one = 0,    // material 0 everywhere
  image = 1,  // of the nearest sample
  rules = 2   // of the first rule that holds, else 0
};

/// Numbers of materials on a regular grid, laid over the world as SampleBase is; a cell takes the sample it lies in.
struct MaterialImage {
  std::int32_t column_count = 0;
  std::int32_t row_count = 0;
  std::int64_t step_x_q32 = 0;  // samples per cell * 2^32, 1 .. 2^38
  std::int64_t step_y_q32 = 0;
  std::vector<std::uint8_t> material;  // [row_count * column_count], first row at y = 0 (south)
  bool operator==(const MaterialImage&) const = default;
};

/// Holds where the base's height and slope lie within bounds, which belong to it.
struct MaterialRule {
  std::int32_t material = 0;
  std::int32_t lowest_q = 0;  // height, 0.1 mm
  std::int32_t highest_q = 0;
  std::int32_t gentlest_q = 0;  // slope: the gradient's length, 0.1 mm per cell
  std::int32_t steepest_q = 0;
  bool operator==(const MaterialRule&) const = default;
};

struct MaterialMap {
  MaterialMapKind kind = MaterialMapKind::one;
  MaterialImage image;              // where kind is image, else as made
  std::vector<MaterialRule> rules;  // where kind is rules, else none
  bool operator==(const MaterialMap&) const = default;
};

/// Checks names, counts and that the map names no material beyond `materials`. The error names the field.
[[nodiscard]] Status validateMaterials(const std::vector<Material>& materials, const MaterialMap& map);

}  // namespace spoor
