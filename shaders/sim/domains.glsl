// Search domains, and where their cells lie in the active tiles.
#ifndef SPOOR_SIM_DOMAINS_GLSL
#define SPOOR_SIM_DOMAINS_GLSL
#include "tick.glsl"

layout(std430, binding = kBindDomains) readonly buffer Domains { DomainEntry domains[]; };
layout(std430, binding = kBindDomainTiles) readonly buffer DomainTiles { int domain_tiles[]; };

/// Index of a world cell in the tiles' planes; it must lie in the domain.
int tileCell(int domain, int x, int y) {
  int column = x / kTileSize - domains[domain].tile_x0;
  int row = y / kTileSize - domains[domain].tile_y0;
  int tile = domain_tiles[domains[domain].first_tile + row * domains[domain].tile_columns + column];
  return tile * kTileCells + (y % kTileSize) * kTileSize + x % kTileSize;
}

#endif
