#include "client/window_run.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
// After epoxy, which replaces the system's GL header.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>

#include "client/ground_ahead.h"
#include "client/views.h"

namespace spoor {

namespace {

constexpr double kWalk_m_per_s = 6.0;
constexpr double kRunFactor = 8.0;
constexpr double kTurn_rad_per_px = 0.0025;
constexpr double kPitchLimit_rad = 1.5;
constexpr double kEyeClearance_m = 0.3;
constexpr double kLongestStep_s = 0.2;
constexpr double kIdleFrame_s = 1.0 / 30;

/// A key that counts once for each press.
class Press {
 public:
  explicit Press(int key) : key_(key) {}
  bool hit(GLFWwindow* window) {
    const bool down = glfwGetKey(window, key_) == GLFW_PRESS;
    const bool first = down && !down_;
    down_ = down;
    return first;
  }

 private:
  int key_;
  bool down_ = false;
};

/// The camera that the player steers: behind a body, or free.
class Steering {
 public:
  explicit Steering(double sun_azimuth_deg) : sun_azimuth_deg_(sun_azimuth_deg) {}

  Camera step(GLFWwindow* window, const TerrainView& view, double step_s) {
    const auto bodies = leadingBodies(view.base->pack());
    if (follow_key_.hit(window)) following_ = !following_;
    if (next_key_.hit(window)) ++body_;
    if (following_ && !bodies.empty()) {
      camera_ = followView(view, bodies[body_ % bodies.size()]);
      azimuth_rad_ = std::atan2(camera_->forward.y, camera_->forward.x);
      pitch_rad_ = std::asin(camera_->forward.z);
      readMouse(window);
      return *camera_;
    }
    if (!camera_) camera_ = trailsView(view, sun_azimuth_deg_);
    fly(window, view, step_s);
    return *camera_;
  }

 private:
  glm::dvec2 readMouse(GLFWwindow* window) {
    glm::dvec2 now(0.0);
    glfwGetCursorPos(window, &now.x, &now.y);
    const glm::dvec2 moved = now - mouse_;
    mouse_ = now;
    return moved;
  }

  void fly(GLFWwindow* window, const TerrainView& view, double step_s) {
    const glm::dvec2 moved = readMouse(window);
    if (glfwGetMouseButton(window, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS) {
      azimuth_rad_ -= moved.x * kTurn_rad_per_px;
      pitch_rad_ = std::clamp(pitch_rad_ - moved.y * kTurn_rad_per_px, -kPitchLimit_rad, kPitchLimit_rad);
    }
    const glm::dvec3 ahead(std::cos(azimuth_rad_) * std::cos(pitch_rad_), std::sin(azimuth_rad_) * std::cos(pitch_rad_),
                           std::sin(pitch_rad_));
    const glm::dvec3 right(std::sin(azimuth_rad_), -std::cos(azimuth_rad_), 0.0);
    const auto axis = [&](int forth, int back) {
      return double(glfwGetKey(window, forth) == GLFW_PRESS) - double(glfwGetKey(window, back) == GLFW_PRESS);
    };
    const glm::dvec3 way = ahead * axis(GLFW_KEY_W, GLFW_KEY_S) + right * axis(GLFW_KEY_D, GLFW_KEY_A) +
                           glm::dvec3(0.0, 0.0, axis(GLFW_KEY_E, GLFW_KEY_Q));
    const bool fast = glfwGetKey(window, GLFW_KEY_LEFT_SHIFT) == GLFW_PRESS;
    camera_->eye_m += way * (kWalk_m_per_s * (fast ? kRunFactor : 1.0) * step_s);
    const double lowest_m = groundHeight(view, {camera_->eye_m.x, camera_->eye_m.y}) + kEyeClearance_m;
    camera_->eye_m.z = std::max(camera_->eye_m.z, lowest_m);
    camera_->forward = ahead;
    camera_->up = {0.0, 0.0, 1.0};
    // Full detail lies ahead of the eye, the further the higher it flies.
    const double away_m = std::min(4.0 * (camera_->eye_m.z - lowest_m + kEyeClearance_m), 200.0);
    camera_->focus_m = glm::dvec2(camera_->eye_m) + glm::dvec2(ahead) * away_m;
  }

  double sun_azimuth_deg_;
  std::optional<Camera> camera_;
  double azimuth_rad_ = 0.0, pitch_rad_ = 0.0;
  glm::dvec2 mouse_{0.0};
  bool following_ = true;
  std::size_t body_ = 0;
  Press follow_key_{GLFW_KEY_F}, next_key_{GLFW_KEY_TAB};
};

/// A crater of the shape that explosions leave, as large as the scene lets clients ask for.
CraterWish largestWish(const CraterLimits& limits, const glm::dvec2& place_m, std::uint32_t number) {
  CraterWish wish;
  wish.balanced = true;
  Crater& crater = wish.crater;
  crater.x_q = std::int32_t(std::lround(place_m.x * rules::kUnitsPerMetre));
  crater.y_q = std::int32_t(std::lround(place_m.y * rules::kUnitsPerMetre));
  crater.crest_radius_q = std::max(1, std::int32_t(limits.request_radius_q / 1.4));
  crater.inner_radius_q = 2 * crater.crest_radius_q - limits.request_radius_q;
  crater.inner_radius_q = std::clamp(crater.inner_radius_q, 0, crater.crest_radius_q);
  crater.depth_q = std::min(limits.request_height_q, crater.crest_radius_q * 2 / 5);
  crater.noise_seed = std::uint16_t(number * 40503u);
  crater.noise_q16 = 16384;
  return wish;
}

void askForCrater(ClientSession& session, const Camera& camera, std::uint32_t number) {
  const CraterLimits& limits = session.pack().crater_limits;
  const auto place_m = groundAhead({&session.base(), &session.state()}, camera);
  if (limits.request_radius_q == 0)
    fmt::print("clients may not ask for craters in this scene\n");
  else if (!place_m)
    fmt::print("no crater: the middle of the view does not meet the ground\n");
  else
    session.requestCrater(largestWish(limits, *place_m, number));
  std::fflush(stdout);
}

}  // namespace

Status runInWindow(ClientSession& session, const WindowContext& context, const RenderSettings& settings,
                   CraterAsker asker) {
  GLFWwindow* window = context.window();
  std::optional<Renderer> renderer;
  Steering steering(settings.sun_azimuth_deg);
  double last_s = glfwGetTime();
  bool told_end = false;
  Press crater_key(GLFW_KEY_B);
  std::uint32_t crater_number = 0;
  while (glfwWindowShouldClose(window) == GLFW_FALSE && glfwGetKey(window, GLFW_KEY_ESCAPE) != GLFW_PRESS) {
    if (session.ended()) {
      glfwWaitEventsTimeout(kIdleFrame_s);  // nothing moves any more but the camera
    } else {
      glfwPollEvents();
    }
    if (!session.ended())
      if (const Status served = session.update(session.inSync() ? 1 : 20); !served) return served;
    asker.update(session);
    if (session.ended() && !told_end) {
      asker.finish();
      fmt::print("session ended at tick {}\n", session.inSync() ? session.state().tick : 0);
      std::fflush(stdout);
    }
    told_end = session.ended();
    if (!session.inSync()) continue;

    glm::ivec2 size(0);
    glfwGetFramebufferSize(window, &size.x, &size.y);
    if (size.x < 1 || size.y < 1) continue;
    if (!renderer) renderer.emplace(session.pack(), settings);
    renderer->resize(size.x, size.y);
    renderer->tilesChanged(session.takeChangedTiles());
    const double now_s = glfwGetTime();
    const TerrainView view{&session.base(), &session.state()};
    const Camera camera = steering.step(window, view, std::min(now_s - last_s, kLongestStep_s));
    if (crater_key.hit(window) && !session.ended()) askForCrater(session, camera, ++crater_number);
    renderer->draw(view, camera);
    last_s = now_s;
    renderer->showInWindow();
    glfwSwapBuffers(window);
  }
  return {};
}

}  // namespace spoor
