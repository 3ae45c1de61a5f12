#pragma once

#include <memory>
#include <string>
#include <vector>

#include "shared/base/result.h"

namespace spoor {

/// An OpenGL 4.5 core context, current on the thread that opened it.
class GlContext {
 public:
  virtual ~GlContext() = default;
  /// What draws, as the driver names it.
  const std::string& renderer() const { return renderer_; }
  /// How it was reached, for messages: "EGL surfaceless", "EGL device 0", "window".
  const std::string& path() const { return path_; }
  /// Whether the processor draws, by the renderer's name.
  bool software() const;

 protected:
  std::string renderer_;
  std::string path_;
};

/// A context without a window. It is current on the thread that opened it; from there on it may go from thread to
/// thread, current on one at a time. GL objects made with it need it current, also when they die.
class HeadlessContext : public GlContext {
 public:
  /// Makes it current on this thread, in place of what was. False where it is current on another one.
  virtual bool makeCurrent() = 0;
  /// Leaves this thread without a context if this one is current on it, so that another thread can take it.
  virtual void release() = 0;
  /// Whether it is current on this thread.
  virtual bool isCurrent() const = 0;
};

/// Makes a headless context current on this thread for a scope and then puts back what was current before, none
/// included. Costs nothing where the context is current already; a switch flushes the context that is left.
/// Only EGL contexts are seen: where GLX has one current on this thread, ok() is false.
class CurrentContext {
 public:
  explicit CurrentContext(HeadlessContext& context);
  ~CurrentContext();
  CurrentContext(const CurrentContext&) = delete;
  CurrentContext& operator=(const CurrentContext&) = delete;

  /// Whether the context is current. If not, what was current still is, and no GL call may follow for the context.
  bool ok() const { return ok_; }

 private:
  /// What EGL has current on a thread; its handles are pointers.
  struct Earlier {
    void* display;
    void* draw;
    void* read;
    void* context;
    unsigned api;
  };
  Earlier earlier_;
  bool switched_ = false;
  bool ok_ = false;
};

/// Opens a context without a window, by EGL, and makes it current on this thread. If the driver can, it loses the
/// context on a reset, which contextStatus() then tells.
/// @param device  "auto": Mesa's surfaceless platform, then each EGL device; the first hardware renderer is taken, else
///                the first software one. "surfaceless", or an EGL device's number ("0", "1", ..): that one alone.
/// Errors: no EGL, what each attempt lacked, or what there is where `device` names none of it.
Result<std::unique_ptr<HeadlessContext>> openHeadlessContext(const std::string& device = "auto");

/// Everything that "auto" may try, a line each: path, renderer and version, or what it lacks. Leaves what is current on
/// this thread as it is.
std::vector<std::string> listHeadlessDevices();

/// What glGetString gives for GL_RENDERER, GL_VERSION and the like; never null.
std::string glText(unsigned name);

/// An error that names what GL recorded, if it did. `after` says what was done.
Status glStatus(const std::string& after);

/// Throws std::runtime_error where glStatus gives an error.
void checkGl(const char* after);

/// Whether the current context was lost to a reset, and who is to blame: "guilty" is this context, "innocent" another.
/// A driver may tell of a reset once only. Always a success where it does not report resets (GlLimits).
Status contextStatus();

}  // namespace spoor
