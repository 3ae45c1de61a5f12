// Search domains, and where their cells lie in the active tiles.
#ifndef SPOOR_SIM_DOMAINS_GLSL
#define SPOOR_SIM_DOMAINS_GLSL
#include "tick.glsl"

layout(std430, binding = kBindDomains) readonly buffer Domains { DomainEntry domains[]; };
layout(std430, binding = kBindDomainTiles) readonly buffer DomainTiles { int domain_tiles[]; };

/// Where a domain's tiles are listed.
struct TileGrid {
  int x0;
  int y0;
  int columns;
  int first;
};

TileGrid tileGrid(int domain) {
  return TileGrid(domains[domain].tile_x0, domains[domain].tile_y0, domains[domain].tile_columns,
                  domains[domain].first_tile);
}

/// Index of a world cell in the tiles' planes; it must lie in the grid's domain.
int tileCell(TileGrid grid, int x, int y) {
  int tile = domain_tiles[grid.first + (y / kTileSize - grid.y0) * grid.columns + x / kTileSize - grid.x0];
  return tile * kTileCells + (y % kTileSize) * kTileSize + x % kTileSize;
}

#endif
