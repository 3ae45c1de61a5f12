// What the kernels that make a relief map share: a box of samples of one level's window, its heights and their slopes.
#include "surface.glsl"

layout(std140, binding = kReliefJobBinding) uniform ReliefJobBlock { ReliefJob job; };

/// The texel of a sample, counted from the window's first; of the border's nearest beyond it.
ivec2 wrapped(ivec2 at) {
  int side = job.window.x;
  ivec2 texel = clamp(at, ivec2(0), ivec2(side - 1)) + job.window.yz;
  return texel - ivec2(greaterThanEqual(texel, ivec2(side))) * side;
}

int heightAt(ivec2 at) {
  ivec2 texel = wrapped(at);
  if (job.window.w == 0) return texelFetch(fine_height, texel, 0).r;
  return texelFetch(coarse_height, ivec3(texel, job.window.w - 1), 0).r;
}

/// dz/dx, dz/dy: the symmetric derivative (Persson 2019, equation 4.3).
vec2 slopeOf(ivec2 at) {
  vec2 twice = vec2(heightAt(at + ivec2(1, 0)) - heightAt(at - ivec2(1, 0)),
                    heightAt(at + ivec2(0, 1)) - heightAt(at - ivec2(0, 1)));
  return clamp(twice / (2.0 * job.march.w * float(kUnitsPerMetre)), -60.0, 60.0);
}
