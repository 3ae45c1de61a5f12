// Soil that bodies overlap and that found no room: a sum of 64 bits in two words.
#ifndef SPOOR_SIM_KEPT_BACK_GLSL
#define SPOOR_SIM_KEPT_BACK_GLSL
#include "tick.glsl"

void keepBack(int amount) {
  uint before = atomicAdd(tick.kept_back_low, uint(amount));
  if (before + uint(amount) < before) atomicAdd(tick.kept_back_high, 1u);
}

#endif
