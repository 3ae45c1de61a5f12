// What the renderer's C++ and its shaders agree on: binding points, sizes, and the blocks that every frame fills.
#ifndef SPOOR_RENDER_FRAME_H
#define SPOOR_RENDER_FRAME_H

#ifdef __cplusplus
#include <glm/glm.hpp>
#define RENDER_CONST inline constexpr int
namespace spoor::render {
using glm::ivec4;
using glm::mat4;
using glm::vec4;
#else
#define RENDER_CONST const int
#endif

// Terrain levels: level l holds one sample for 4^l cells a side, in a window round the camera's focus. Windows nest.
RENDER_CONST kLevelCount = 5;
RENDER_CONST kLevelShift = 2;           // log2 of the ratio between levels
RENDER_CONST kPageSamples = 64;         // a page is what is loaded at once; a page of level 0 is a tile
RENDER_CONST kFinePatchSamples = 64;    // side of a drawn patch of level 0, at most; see Frame::origin
RENDER_CONST kCoarsePatchSamples = 16;  // side of a drawn patch of the other levels
RENDER_CONST kFineMorphSamples = 192;   // width of the band in which a level turns into the next
RENDER_CONST kCoarseMorphSamples = 80;
RENDER_CONST kMorphRimSamples = 20;  // the rim of a window that shows the next level only: wider than kShadowSteps and
                                     // than what blurred slopes carry inwards
RENDER_CONST kShadowSteps = 12;      // samples marched towards the sun, in each level
RENDER_CONST kOcclusionReach = 6;    // samples looked at around a sample for the sky's light
RENDER_CONST kBlurPassesLimit = 16;  // of the Gaussian over slopes; each reaches one sample further

// Patch flags, one bit an edge in the order west, south, east, north.
RENDER_CONST kRimEdges = 1;      // << edge: the edge lies on the window's border
RENDER_CONST kHoleEdges = 16;    // << edge: the edge borders on the next finer window, or on finer patches
RENDER_CONST kStonePatch = 256;  // the patch has kStonePatchSamples a side and is cut finer than its cells
RENDER_CONST kCellEdges = 512;   // << edge: an edge of such a patch that borders on others: a vertex a cell

RENDER_CONST kHighlightTiles = 256;  // side of the mask of marked tiles, a power of two

RENDER_CONST kShadeLit = 0;
RENDER_CONST kShadeNormals = 1;
RENDER_CONST kShadeColumns = 2;

// Textures of materials, in the order of MaterialTexture (shared/world/material.h).
RENDER_CONST kTexturePlain = 0;
RENDER_CONST kTextureSnow = 1;
RENDER_CONST kTextureSand = 2;
RENDER_CONST kTextureMud = 3;
RENDER_CONST kTexturePebbles = 4;
RENDER_CONST kTextureGravel = 5;
RENDER_CONST kTextureDust = 6;
RENDER_CONST kTextureDirt = 7;
RENDER_CONST kTextureGrass = 8;
RENDER_CONST kLooksLimit = 16;         // materials of a pack
RENDER_CONST kStonePatchSamples = 16;  // side of a patch of level 0 that is cut finer than its cells, to show stones
RENDER_CONST kStoneCuts = 4;           // of a cell's side there, at most

// Binding points.
RENDER_CONST kFrameBinding = 0;       // uniform block
RENDER_CONST kReliefJobBinding = 1;   // uniform block
RENDER_CONST kColumnAreaBinding = 2;  // uniform block
RENDER_CONST kLooksBinding = 3;       // uniform block
RENDER_CONST kFineHeightUnit = 0;     // texture units
RENDER_CONST kCoarseHeightUnit = 1;
RENDER_CONST kFineReliefUnit = 2;
RENDER_CONST kCoarseReliefUnit = 3;
RENDER_CONST kBodyShadowUnit = 4;
RENDER_CONST kColourUnit = 5;
RENDER_CONST kDepthUnit = 6;
RENDER_CONST kHighlightUnit = 7;
RENDER_CONST kFineCoverUnit = 8;
RENDER_CONST kCoarseCoverUnit = 9;
RENDER_CONST kCraterBinding = 0;  // storage blocks: the first of
RENDER_CONST kCraterBlocks = 5;
RENDER_CONST kReliefImage = 0;  // image units
RENDER_CONST kBlurFromImage = 1;
RENDER_CONST kBlurToImage = 2;

/// Where a level's window lies in the world and in its texture, which is a torus.
struct LevelWindow {
  ivec4 window;  // first cell x, y; samples a side; log2 of cells a sample
  ivec4 texel;   // texel of the first sample x, y; cells from a block's corner to its sample; samples of the morph band
};

/// All positions are metres from the centre of the origin cell at the origin height: small numbers near the camera.
struct Frame {
  mat4 clip_from_rel;
  mat4 shadow_from_rel;  // to the bodies' shadow map, 0 .. 1
  vec4 eye;              // camera; w > 0: orthographic
  vec4 ray_right;        // place at (x, y) of the screen: eye + away * (forward + x * right + y * up) [m];
  vec4 ray_up;           // orthographic: eye + x * right + y * up + away * forward
  vec4 ray_forward;      // w: depth * away [m]; orthographic: away of depth 0 [m]
  vec4 sun;              // towards the sun; w: tangent of its elevation
  vec4 scale;            // cell [m]; pixels per radian (orthographic: per metre); pixels per triangle; fog [1/m]
  vec4 look;     // strength of the fine detail, 0 .. 1; the shadow map's texel [m]; samples a pixel; strength of marks
  ivec4 origin;  // cell x, y; height, 0.1 mm; samples along a patch of level 0
  ivec4 world;   // cells x, y; materials, 0: looks[0] everywhere; kShade*
  ivec4 place;   // side of a cell, 0.1 mm
  vec4 stones;   // how far from the eye they are cut out [m], 0: nowhere; pixels per triangle there; parts into which
                 // each edge of a patch is cut, 0: as its length asks for
  LevelWindow levels[kLevelCount];
};

/// How the ground of a material looks.
struct MaterialLook {
  vec4 albedo;         // linear; w: how wet it is, 0 .. 1
  vec4 soil;           // under its surface, linear
  vec4 tint;           // of what its texture is drawn in; w: height of its grains [m]
  ivec4 texture_kind;  // kTexture*; side of its grains, 0.1 mm, 0: none
};

/// One dispatch of relief.comp or blur_slopes.comp: a box of texels of one level.
struct ReliefJob {
  ivec4 box;     // first sample x, y (from the window's first); samples x, y
  ivec4 window;  // samples a side; texel of the first sample x, y; layer
  vec4 march;    // steps towards the sun along x and y, the longer +-1; tangent of its elevation; side of a sample [m]
  ivec4 blur;    // which pass this is, 1 ..; of how many
};

/// What is shown as columns.
struct ColumnArea {
  ivec4 area;     // first cell x, y, from the origin cell; cells x, y
  ivec4 heights;  // of the first, the middle and the last colour, and of the columns' feet, 0.1 mm
};

#ifdef __cplusplus
static_assert(sizeof(ColumnArea) == 32);
static_assert(sizeof(LevelWindow) == 32);
static_assert(sizeof(MaterialLook) == 64);
static_assert(sizeof(Frame) == 2 * 64 + 11 * 16 + kLevelCount * 32);
static_assert(sizeof(ReliefJob) == 64);
// A slope looks one sample beyond its own, each pass one more, and so does the filter that reads the map.
static_assert(kMorphRimSamples > kShadowSteps && kMorphRimSamples > kBlurPassesLimit + 2);
}  // namespace spoor::render
#else
layout(std140, binding = kFrameBinding) uniform FrameBlock { Frame frame; };
#endif
#endif
