#include "client/picture_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>
#include <optional>
#include <string_view>

#include "shaders/render/frame.h"

namespace spoor {

namespace {

constexpr int kSideLimit_px = 16384;

struct NamedGround {
  std::string_view name;
  Ground ground;
};
constexpr NamedGround kGrounds[] = {{"scene", Ground::scene}, {"snow", Ground::snow}, {"sand", Ground::sand},
                                    {"mud", Ground::mud},     {"dirt", Ground::dirt}, {"grass", Ground::grass}};

std::optional<int> sideOf(std::string_view text) {
  int value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc() || end != text.data() + text.size() || value < 1 || value > kSideLimit_px)
    return std::nullopt;
  return value;
}

}  // namespace

void addPictureOptions(Options& options, PictureArguments& arguments) {
  options.add("size", "WIDTHxHEIGHT", "of window or pictures, pixels", &arguments.size);
  options.add("ground", "scene|snow|sand|mud|dirt|grass",
              "what all of the ground looks like; scene: as its materials say", &arguments.ground);
  options.add("blur-normals", "PASSES", "of a 3 x 3 Gaussian over the ground's normals; -1: as the scene says",
              &arguments.blur_normals, -1, render::kBlurPassesLimit);
}

Result<RenderSettings> pictureSettings(const PictureArguments& arguments) {
  RenderSettings settings;
  const std::string_view size = arguments.size;
  const auto cross = size.find('x');
  const auto width = cross == std::string_view::npos ? std::nullopt : sideOf(size.substr(0, cross));
  const auto height = cross == std::string_view::npos ? std::nullopt : sideOf(size.substr(cross + 1));
  if (!width || !height)
    return Error{fmt::format("--size \"{}\": want WIDTHxHEIGHT, each 1 .. {} pixels", size, kSideLimit_px)};
  settings.width_px = *width;
  settings.height_px = *height;
  const auto ground = std::ranges::find(kGrounds, std::string_view(arguments.ground), &NamedGround::name);
  if (ground == std::end(kGrounds))
    return Error{fmt::format("--ground \"{}\": want scene, snow, sand, mud, dirt or grass", arguments.ground)};
  settings.ground = ground->ground;
  settings.blur_passes = int(arguments.blur_normals);
  return settings;
}

}  // namespace spoor
