// Stage nearest by jump flooding: how a cell of a domain's box is kept between passes. Not as an index: to divide by
// the width at every look costs more than the look.
#ifndef SPOOR_SIM_FLOOD_GLSL
#define SPOOR_SIM_FLOOD_GLSL
#include "tables.h"

const int kPlaceBits = 14;

int packedPlace(int x, int y) { return y << kPlaceBits | x; }
ivec2 placeOf(int place) { return ivec2(place & ((1 << kPlaceBits) - 1), place >> kPlaceBits); }

#endif
