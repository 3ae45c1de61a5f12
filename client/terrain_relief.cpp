// Slopes and light of the ground, made anew where heights changed: the part of TerrainLevels that computes.
#include <algorithm>
#include <cmath>

#include "client/terrain_levels.h"

namespace spoor {

using namespace render;

namespace {

glm::dvec2 stepTowards(const glm::dvec3& sun) { return glm::dvec2(sun) / std::max(std::abs(sun.x), std::abs(sun.y)); }

/// A box with so much more on its sides, within the window.
SampleBox grown(const SampleBox& box, glm::ivec2 before, glm::ivec2 behind, int side) {
  const glm::ivec2 first = glm::max(box.first - before, glm::ivec2(0));
  const glm::ivec2 end = glm::min(box.first + box.count + behind, glm::ivec2(side));
  return {first, glm::max(end - first, glm::ivec2(0))};
}

}  // namespace

void TerrainLevels::makeRelief(int level) {
  Level& l = levels_[std::size_t(level)];
  if (l.dirty.empty()) return;
  const int side = l.page_count * kPageSamples;
  // What a changed sample can darken: its neighbourhood, and whatever marches through it towards the sun. Blurred
  // slopes change as far as the passes reach.
  const glm::ivec2 march = glm::ivec2(glm::round(stepTowards(sun_) * double(kShadowSteps)));
  const int blur_reach = level == 0 ? settings_.blur_passes : 0;
  const glm::ivec2 before = glm::max(kOcclusionReach + glm::max(march, glm::ivec2(0)), glm::ivec2(blur_reach)) + 1;
  const glm::ivec2 behind = glm::max(kOcclusionReach + glm::max(-march, glm::ivec2(0)), glm::ivec2(blur_reach)) + 1;
  std::int64_t area = 0;
  for (SampleBox& box : l.dirty) {
    box = grown(box, before, behind, side);
    area += std::int64_t(box.count.x) * box.count.y;
  }
  if (area >= std::int64_t(side) * side) l.dirty = {{glm::ivec2(0), glm::ivec2(side)}};
  for (const SampleBox& box : l.dirty) runRelief(level, box);
  if (level == 0 && settings_.blur_passes > 0) blurSlopes(l.dirty);
  l.dirty.clear();
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);  // relief maps, read by picture.frag
}

void TerrainLevels::runRelief(int level, const SampleBox& box) {
  glBindImageTexture(kReliefImage, level == 0 ? fine_relief_.name() : coarse_relief_.name(), 0, GL_FALSE,
                     level == 0 ? 0 : level - 1, GL_WRITE_ONLY, GL_RGBA16F);
  glUseProgram(relief_program_.name());
  dispatchJob(level, box, 0);
  stats.relief_samples += std::int64_t(box.count.x) * box.count.y;
}

/// Every pass starts from slopes of unblurred heights, on a box so much larger that the last one finds all it reads:
/// boxes that overlap then hold the same values there, whichever was computed last.
void TerrainLevels::blurSlopes(const std::vector<SampleBox>& boxes) {
  const int side = levels_[0].page_count * kPageSamples;
  glUseProgram(blur_program_.name());
  glBindImageTexture(kReliefImage, fine_relief_.name(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA16F);
  for (int pass = 1; pass <= settings_.blur_passes; ++pass) {
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);  // blur_slopes_ of the pass before; at first the relief map
    if (settings_.blur_passes > 1) {
      glBindImageTexture(kBlurFromImage, blur_slopes_[std::size_t(pass % 2)].name(), 0, GL_FALSE, 0, GL_READ_ONLY,
                         GL_RG32F);
      glBindImageTexture(kBlurToImage, blur_slopes_[std::size_t(1 - pass % 2)].name(), 0, GL_FALSE, 0, GL_WRITE_ONLY,
                         GL_RG32F);
    }
    const glm::ivec2 more(settings_.blur_passes - pass);
    for (const SampleBox& box : boxes) {
      const SampleBox job = grown(box, more, more, side);
      dispatchJob(0, job, pass);
      stats.blurred_samples += std::int64_t(job.count.x) * job.count.y;
    }
  }
}

void TerrainLevels::dispatchJob(int level, const SampleBox& box, int pass) {
  if (box.count.x == 0 || box.count.y == 0) return;
  const LevelWindow window = windows()[std::size_t(level)];
  const glm::dvec2 towards = stepTowards(sun_);
  ReliefJob job;
  job.box = {box.first, box.count};
  job.window = {window.window.z, window.texel.x, window.texel.y, level};
  job.march = {float(towards.x), float(towards.y), float(sun_.z / std::hypot(sun_.x, sun_.y)),
               float(cell_m_ * (1 << (level * kLevelShift)))};
  job.blur = {pass, settings_.blur_passes, 0, 0};
  glNamedBufferSubData(relief_job_.name(), 0, sizeof job, &job);
  glBindBufferBase(GL_UNIFORM_BUFFER, kReliefJobBinding, relief_job_.name());
  glDispatchCompute(GLuint(box.count.x + 7) / 8, GLuint(box.count.y + 7) / 8, 1);
}

std::vector<glm::vec4> TerrainLevels::fineRelief() const {
  const LevelWindow window = windows()[0];
  const int side = window.window.z;
  std::vector<glm::vec4> torus(std::size_t(side) * std::size_t(side)), result(torus.size());
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);  // the relief map, read back
  glGetTextureImage(fine_relief_.name(), 0, GL_RGBA, GL_FLOAT, GLsizei(torus.size() * sizeof(glm::vec4)), torus.data());
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      result[std::size_t(y * side + x)] =
          torus[std::size_t((y + window.texel.y) % side * side + (x + window.texel.x) % side)];
  return result;
}

}  // namespace spoor
