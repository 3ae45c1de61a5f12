#include "client/material_looks.h"

#include <algorithm>
#include <cmath>

#include "shaders/rules/limits.h"
#include "shared/base/assert.h"

namespace spoor {

namespace {

using glm::ivec4;
using glm::vec3;
using glm::vec4;
using render::MaterialLook;

static_assert(int(MaterialTexture::grass) == render::kTextureGrass &&
              int(MaterialTexture::pebbles) == render::kTexturePebbles &&
              render::kTextureGrass + 1 == kMaterialTextureCount);
static_assert(render::kLooksLimit == kMaterialsLimit);

// Where nothing else is said: the soil under the surface, and what shaders/render/ground_cover.glsl mixes dirt and
// grass about.
constexpr vec3 kSoil(0.205f, 0.132f, 0.078f);
constexpr vec3 kDirt(0.350f, 0.175f, 0.097f), kDirtSoil(0.170f, 0.082f, 0.046f);
constexpr vec3 kGrass(0.090f, 0.140f, 0.035f);
constexpr float kWetMud = 1.0f;
constexpr float kUnitsPerMetre = float(rules::kUnitsPerMetre);

float linear(std::uint8_t channel) {
  const float value = float(channel) / 255.0f;
  return value <= 0.04045f ? value / 12.92f : std::pow((value + 0.055f) / 1.055f, 2.4f);
}

MaterialLook lookOf(int texture, vec3 albedo, vec3 soil, vec3 tint = vec3(1.0f)) {
  return {vec4(albedo, 0.0f), vec4(soil, 0.0f), vec4(tint, 0.0f), ivec4(texture, 0, 0, 0)};
}

/// --ground: plain, but for dirt and grass.
MaterialLook lookOf(Ground ground) {
  switch (ground) {
    case Ground::sand:
      return lookOf(render::kTexturePlain, {0.60f, 0.43f, 0.25f}, {0.330f, 0.215f, 0.115f});
    case Ground::mud:
      return lookOf(render::kTexturePlain, {0.115f, 0.080f, 0.052f}, {0.185f, 0.120f, 0.072f});
    case Ground::dirt:
      return lookOf(render::kTextureDirt, kDirt, kDirtSoil);
    case Ground::grass:
      return lookOf(render::kTextureGrass, kGrass, kSoil);
    case Ground::scene:
    case Ground::snow:
      break;
  }
  return lookOf(render::kTexturePlain, {0.86f, 0.88f, 0.91f}, kSoil);
}

MaterialLook lookOf(const Material& material) {
  if (material == ScenePack().materials.front()) return lookOf(Ground::snow);
  const vec3 colour(linear(material.colour[0]), linear(material.colour[1]), linear(material.colour[2]));
  MaterialLook look = lookOf(int(material.texture), colour, 0.55f * colour);
  switch (material.texture) {
    case MaterialTexture::mud:
      look.albedo.w = kWetMud;
      break;
    case MaterialTexture::dirt:
      look.tint = vec4(colour / kDirt, 0.0f);
      break;
    case MaterialTexture::grass:
      look.tint = vec4(colour / kGrass, 0.0f);
      [[fallthrough]];
    case MaterialTexture::snow:
      look.soil = vec4(kSoil, 0.0f);
      break;
    case MaterialTexture::pebbles:
    case MaterialTexture::gravel:
      look.texture_kind.y = material.grain_size_q;
      look.tint.w = float(material.grain_height_q) / kUnitsPerMetre;
      break;
    default:
      break;
  }
  return look;
}

}  // namespace

std::vector<MaterialLook> looksOf(const ScenePack& pack, Ground ground) {
  if (ground != Ground::scene) return {lookOf(ground)};
  std::vector<MaterialLook> looks;
  for (const Material& material : pack.materials) looks.push_back(lookOf(material));
  return looks;
}

StoneSize stoneSize(const std::vector<MaterialLook>& looks) {
  StoneSize size;
  for (const MaterialLook& look : looks) {
    if (look.texture_kind.y == 0 || look.tint.w <= 0.0f) continue;
    size.side_m = std::max(size.side_m, double(look.texture_kind.y) / rules::kUnitsPerMetre);
    size.height_m = std::max(size.height_m, double(look.tint.w));
  }
  return size;
}

}  // namespace spoor
