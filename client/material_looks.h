#pragma once

#include <vector>

#include "shaders/render/frame.h"
#include "shared/world/pack.h"

namespace spoor {

/// What the ground looks like: as the pack's materials say, or all of it as one of these.
enum class Ground { scene, snow, sand, mud, dirt, grass };

/// The looks of a pack's materials by their numbers, 1 .. kMaterialsLimit; one look for all where `ground` says so.
/// A pack that says nothing of materials looks like Ground::snow.
std::vector<render::MaterialLook> looksOf(const ScenePack& pack, Ground ground);

/// Side of the stones that stand out of the ground farthest for their size [m], and how far any stands out; 0: none do.
struct StoneSize {
  double side_m = 0.0;
  double height_m = 0.0;
};
StoneSize stoneSize(const std::vector<render::MaterialLook>& looks);

}  // namespace spoor
