#include "client/renderer.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "shaders/host/gl_context.h"
#include "shaders/host/shader_loader.h"
#include "shaders/rules/limits.h"
#include "shared/base/assert.h"

namespace spoor {

namespace {

constexpr double kHaze_m = 3000.0;  // how far one sees on a clear day, to 1/e
constexpr double kFogShare = 0.75;  // of the outermost window's reach: what lies there is all but hidden

// Vertices that the patches of one draw call may make. llvmpipe (Mesa 22.3) loses triangles of calls that make more
// than 65 536, and slows down long before; a patch of 64 samples makes up to 4225.
constexpr int kDrawVertices = 8 * 65 * 65;

glm::dvec3 sunOf(const RenderSettings& settings) {
  const double azimuth = glm::radians(settings.sun_azimuth_deg);
  const double elevation = glm::radians(settings.sun_elevation_deg);
  return {std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation), std::sin(elevation)};
}

int shadeCode(Shade shade) {
  if (shade == Shade::columns) return render::kShadeColumns;
  return shade == Shade::normals ? render::kShadeNormals : render::kShadeLit;
}

TerrainSettings terrainSettings(const ScenePack& pack, const RenderSettings& settings,
                                const std::vector<render::MaterialLook>& looks) {
  const int patches_per_row = settings.patches_per_row < 0 ? pack.patches_per_row : settings.patches_per_row;
  const StoneSize stones = settings.detail > 0.0 ? stoneSize(looks) : StoneSize();
  return {settings.fine_pages,
          settings.coarse_pages,
          finePatchSamples(pack.width_cells, patches_per_row),
          settings.blur_passes < 0 ? pack.normal_blur_passes : settings.blur_passes,
          looks.size() > 1,
          stones.side_m,
          stones.height_m * settings.detail,
          settings.triangle_px / 2.0};
}

}  // namespace

Renderer::Renderer(const ScenePack& pack, const RenderSettings& settings)
    : pack_(&pack),
      settings_(settings),
      cell_m_(double(pack.cell_q) / rules::kUnitsPerMetre),
      sun_(sunOf(settings)),
      looks_(looksOf(pack, settings.ground)),
      terrain_(terrainSettings(pack, settings, looks_), cell_m_, sun_),
      bodies_(pack),
      columns_(settings.columns) {
  frame_block_ = makeBuffer();
  glNamedBufferStorage(frame_block_.name(), sizeof(render::Frame), nullptr, GL_DYNAMIC_STORAGE_BIT);
  looks_block_ = makeBuffer();
  std::array<render::MaterialLook, render::kLooksLimit> looks{};
  std::ranges::copy(looks_, looks.begin());
  glNamedBufferStorage(looks_block_.name(), sizeof looks, looks.data(), 0);
  patch_buffer_ = makeBuffer();
  patch_layout_ = makeVertexArray();
  no_layout_ = makeVertexArray();
  glEnableVertexArrayAttrib(patch_layout_.name(), 0);
  glVertexArrayAttribIFormat(patch_layout_.name(), 0, 4, GL_INT, 0);
  glVertexArrayAttribBinding(patch_layout_.name(), 0, 0);
  glVertexArrayVertexBuffer(patch_layout_.name(), 0, patch_buffer_.name(), 0, sizeof(Patch));
  programs();  // so that a driver that refuses them says so here
  makeTargets();
}

const Renderer::Programs& Renderer::programs() {
  const bool cover = terrain_.hasCover();
  Programs& programs = programs_[cover ? 1 : 0];
  if (programs.terrain.name() != 0) return programs;
  unsigned textures = 0;
  for (const render::MaterialLook& look : looks_) textures |= 1u << look.texture_kind.x;
  const ShaderDefines defines{{"SPOOR_COVER", cover ? "1" : "0"},
                              {"SPOOR_TEXTURES", std::to_string(textures)},
                              {"SPOOR_STONES", terrain_.settings().stone_side_m > 0.0 ? "1" : "0"}};
  programs.terrain = makeProgram(
      {"render/terrain.vert", "render/terrain.tesc", "render/terrain.tese", "render/terrain.frag"}, defines);
  programs.picture = makeProgram({"render/screen.vert", "render/picture.frag"}, defines);
  return programs;
}

void Renderer::makeTargets() {
  GLint side_limit = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &side_limit);
  if (settings_.width_px < 1 || settings_.height_px < 1 || settings_.width_px > side_limit ||
      settings_.height_px > side_limit)
    throw std::runtime_error(fmt::format("picture size {}x{}: each side must lie in 1 .. {} on this renderer",
                                         settings_.width_px, settings_.height_px, side_limit));
  GLint colour_limit = 0, depth_limit = 0;
  glGetIntegerv(GL_MAX_COLOR_TEXTURE_SAMPLES, &colour_limit);
  glGetIntegerv(GL_MAX_DEPTH_TEXTURE_SAMPLES, &depth_limit);
  settings_.sample_count = std::clamp(settings_.sample_count, 1, std::min({colour_limit, depth_limit, 8}));
  const auto storage = [&](GLenum format) {
    GlTexture texture = makeTexture(GL_TEXTURE_2D_MULTISAMPLE);
    glTextureStorage2DMultisample(texture.name(), settings_.sample_count, format, settings_.width_px,
                                  settings_.height_px, GL_TRUE);
    return texture;
  };
  colour_ = storage(GL_RGBA8);
  depth_ = storage(GL_DEPTH_COMPONENT32F);
  glGetTextureLevelParameteriv(depth_.name(), 0, GL_TEXTURE_SAMPLES, &settings_.sample_count);  // it may round up
  target_ = makeFramebuffer();
  glNamedFramebufferTexture(target_.name(), GL_COLOR_ATTACHMENT0, colour_.name(), 0);
  glNamedFramebufferTexture(target_.name(), GL_DEPTH_ATTACHMENT, depth_.name(), 0);
  picture_colour_ = makeRenderbuffer();
  glNamedRenderbufferStorage(picture_colour_.name(), GL_RGBA8, settings_.width_px, settings_.height_px);
  picture_ = makeFramebuffer();
  glNamedFramebufferRenderbuffer(picture_.name(), GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, picture_colour_.name());
  for (const auto* target : {&target_, &picture_})
    if (glCheckNamedFramebufferStatus(target->name(), GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      throw std::runtime_error(fmt::format("OpenGL: no {}x{} picture with {} samples on this renderer",
                                           settings_.width_px, settings_.height_px, settings_.sample_count));
}

void Renderer::resize(int width_px, int height_px) {
  if (width_px == settings_.width_px && height_px == settings_.height_px) return;
  settings_.width_px = width_px;
  settings_.height_px = height_px;
  makeTargets();
}

void Renderer::forget() {
  terrain_.forget();
  craters_.forget();
  changed_.clear();
}

void Renderer::tilesChanged(std::span<const TileCoordinate> tiles) {
  changed_.insert(changed_.end(), tiles.begin(), tiles.end());
}

void Renderer::fillFrame(std::span<const Pose> poses, const Camera& camera, const CameraFrame& frame) {
  float shadow_texel_m = 0.0f;
  render::Frame block{};
  block.clip_from_rel = frame.clip_from_rel;
  block.shadow_from_rel = bodies_.shadowMatrix(poses, frame, camera, sun_, shadow_texel_m);
  block.eye = {frame.eye_rel, frame.orthographic ? 1.0f : 0.0f};
  block.ray_right = {frame.ray_right, 0.0f};
  block.ray_up = {frame.ray_up, 0.0f};
  block.ray_forward = {frame.ray_forward, frame.depth_range_m};
  block.sun = {glm::vec3(sun_), float(sun_.z / std::hypot(sun_.x, sun_.y))};
  const double fog_reach_m = kFogShare * terrain_.reachCells() * cell_m_;
  block.scale = {float(cell_m_), frame.pixels_per_radian, float(settings_.triangle_px),
                 float(std::max(2.6 / fog_reach_m, 1.0 / kHaze_m))};
  block.look = {float(settings_.detail), shadow_texel_m, float(settings_.sample_count),
                highlight_.empty() ? 0.0f : 1.0f};
  block.origin = {frame.origin_cell, frame.origin_height_q, terrain_.settings().fine_patch_samples};
  block.place = {pack_->cell_q, 0, 0, 0};
  block.stones = {float(terrain_.stoneReach(frame)), float(terrain_.settings().stone_triangle_px),
                  float(settings_.tessellation), 0.0f};
  block.world = {pack_->width_cells, pack_->height_cells, terrain_.settings().materials ? int(looks_.size()) : 0,
                 shadeCode(settings_.shade)};
  const auto windows = terrain_.windows();
  std::copy(windows.begin(), windows.end(), block.levels);
  glNamedBufferSubData(frame_block_.name(), 0, sizeof block, &block);
  glBindBufferBase(GL_UNIFORM_BUFFER, render::kFrameBinding, frame_block_.name());
  glBindBufferBase(GL_UNIFORM_BUFFER, render::kLooksBinding, looks_block_.name());
}

void Renderer::draw(const TerrainView& view, const Camera& camera, FrameTimes* times) {
  SPOOR_ASSERT(&view.base->pack() == pack_ && view.state->poses.size() == pack_->bodies.size());
  glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
  if (!craters_.goesOn(view.state->craters)) forget();
  craters_.update(view.state->craters, pack_->cell_q);
  std::ranges::sort(changed_);
  changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
  const glm::ivec2 focus(glm::floor(camera.focus_m / cell_m_));
  const bool as_columns = settings_.shade == Shade::columns;
  auto last = std::chrono::steady_clock::now();
  const auto note = [&](double FrameTimes::*part) {
    if (times == nullptr) return;
    glFinish();
    const auto now = std::chrono::steady_clock::now();
    times->*part = std::chrono::duration<double, std::milli>(now - std::exchange(last, now)).count();
  };
  if (!as_columns) {
    terrain_.updateHeights(view, focus, changed_);
    note(&FrameTimes::heights_ms);
    terrain_.updateRelief();
    note(&FrameTimes::normals_ms);
    changed_.clear();
  }

  const CameraFrame frame = frameOf(camera, cell_m_, settings_.width_px, settings_.height_px);
  const std::span<const Pose> poses = settings_.bodies ? std::span(view.state->poses) : std::span<const Pose>();
  highlight_.update(frame);
  fillFrame(poses, camera, frame);
  bodies_.drawShadows(poses, frame);

  glBindFramebuffer(GL_FRAMEBUFFER, target_.name());
  glViewport(0, 0, settings_.width_px, settings_.height_px);
  const std::array<float, 4> empty{0.0f, 0.0f, 0.0f, 0.0f};
  glClearNamedFramebufferfv(target_.name(), GL_COLOR, 0, empty.data());
  glClearNamedFramebufferfv(target_.name(), GL_DEPTH, 0, empty.data());
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GEQUAL);

  bodies_.draw(poses, frame);
  if (as_columns)
    columns_.draw(view, focus, frame);
  else
    drawTerrain(frame);
  composePicture();
  note(&FrameTimes::draw_ms);
  checkGl("drawing");
}

void Renderer::drawTerrain(const CameraFrame& frame) {
  patches_.clear();
  terrain_.collectPatches(frame, patches_);
  terrain_.stats.patches_drawn = std::int64_t(patches_.size());
  glNamedBufferData(patch_buffer_.name(), GLsizeiptr(patches_.size() * sizeof(Patch)), patches_.data(), GL_STREAM_DRAW);
  glUseProgram(programs().terrain.name());
  glBindVertexArray(patch_layout_.name());
  glPatchParameteri(GL_PATCH_VERTICES, 1);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  for (std::size_t first = 0, count = 0; first < patches_.size(); first += count) {
    // The finest level's come first, stones' before them; a call may run on into the others.
    int fine_side = patches_[first].z == 0 ? terrain_.settings().fine_patch_samples : 0;
    if ((patches_[first].w & render::kStonePatch) != 0) fine_side = render::kStonePatchSamples * render::kStoneCuts;
    const int side = std::max(fine_side, render::kCoarsePatchSamples) + 1;
    count = std::min(std::size_t(kDrawVertices / (side * side)), patches_.size() - first);
    glDrawArrays(GL_PATCHES, GLint(first), GLsizei(count));
  }
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
}

void Renderer::composePicture() {
  glBindFramebuffer(GL_FRAMEBUFFER, picture_.name());
  glDisable(GL_DEPTH_TEST);
  glBindTextureUnit(render::kColourUnit, colour_.name());
  glBindTextureUnit(render::kDepthUnit, depth_.name());
  craters_.bind();
  glUseProgram(programs().picture.name());
  glBindVertexArray(no_layout_.name());
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

Image Renderer::readPicture() const {
  Image image{settings_.width_px, settings_.height_px, {}};
  const std::size_t row_bytes = std::size_t(image.width_px) * 4;
  image.rgba.resize(row_bytes * std::size_t(image.height_px));
  glBindFramebuffer(GL_READ_FRAMEBUFFER, picture_.name());
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, image.width_px, image.height_px, GL_RGBA, GL_UNSIGNED_BYTE, image.rgba.data());
  checkGl("reading the picture");
  // GL's first row is the lowest.
  for (std::size_t y = 0; y < std::size_t(image.height_px) / 2; ++y)
    std::swap_ranges(image.rgba.begin() + std::ptrdiff_t(y * row_bytes),
                     image.rgba.begin() + std::ptrdiff_t((y + 1) * row_bytes),
                     image.rgba.end() - std::ptrdiff_t((y + 1) * row_bytes));
  return image;
}

void Renderer::showInWindow() const {
  glBlitNamedFramebuffer(picture_.name(), 0, 0, 0, settings_.width_px, settings_.height_px, 0, 0, settings_.width_px,
                         settings_.height_px, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

}  // namespace spoor
