#include "tests/backends.h"

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <thread>

#include "tests/shelf.h"
#ifdef SPOOR_WITH_GL
#include "shaders/host/gl_context.h"
#include "tests/gl_cases.h"
#endif

namespace spoor::test {
namespace {

using BackendShelf = Shelf<Backend>;

BackendShelf& shelf() {
  static auto* const kept = new BackendShelf;
  return *kept;
}

std::string shelfName(const BackendCase& backend_case) {
  return backend_case.name + " " + std::to_string(backend_case.thread_count) +
         (backend_case.skip_settled ? "" : " every pair");
}

/// A backend from the shelf, which goes back to it.
class BorrowedBackend final : public Backend {
 public:
  BorrowedBackend(std::string shelf_name, std::unique_ptr<Backend> backend)
      : shelf_name_(std::move(shelf_name)), backend_(std::move(backend)) {}
  ~BorrowedBackend() override { shelf().putBack(shelf_name_, std::move(backend_)); }

  std::string name() const override { return backend_->name(); }
  std::string renderer() const override { return backend_->renderer(); }
  Status submit(TickPlan plan, const BaseTerrain& base, const WorldState& state) override {
    return backend_->submit(std::move(plan), base, state);
  }
  Result<TickEffect> settle(WorldState& state) override { return backend_->settle(state); }
  Status collect(WorldState& state, std::vector<TileChange>& changes) override {
    return backend_->collect(state, changes);
  }
  void tilesChanged(std::span<Tile* const> tiles) override { backend_->tilesChanged(tiles); }
  void forget() override { backend_->forget(); }
  BackendMemory memory() const override { return backend_->memory(); }

 private:
  std::string shelf_name_;
  std::unique_ptr<Backend> backend_;
};

std::unique_ptr<Backend> makeCase(const BackendCase& backend_case) {
#ifdef SPOOR_WITH_GL
  if (backend_case.gl) {
    auto backend = makeGlBackend(glOptionsOf(backend_case));
    if (!backend) throw std::runtime_error(backend_case.name + ": " + backend.error());
    return std::move(*backend);
  }
#endif
  NativeOptions options;
  options.thread_count = backend_case.thread_count;
  options.kernels = backend_case.baseline_kernels ? availableKernels().front() : nullptr;
  options.skip_settled = backend_case.skip_settled;
  return makeNativeBackend(options);
}

}  // namespace

std::vector<BackendCase> nativeCases() {
  return {{.name = "NativeBaseline", .thread_count = 1, .baseline_kernels = true},
          {.name = "NativeThreads3", .thread_count = 3}};
}

std::vector<BackendCase> glCases() {
#ifdef SPOOR_WITH_GL
  return {{.name = "GlPlain64", .gl = true, .group = 64},
          {.name = "GlPlain128Reversed", .gl = true, .group = 128, .reversed = true},
          {.name = "GlFused64Reversed", .gl = true, .group = 64, .reversed = true, .fused = true},
          {.name = "GlFused256", .gl = true, .group = 256, .fused = true}};
#else
  return {};
#endif
}

std::vector<BackendCase> backendCases() {
  std::vector<BackendCase> cases = nativeCases();
  std::ranges::move(glCases(), std::back_inserter(cases));
  return cases;
}

const std::string& lackOf(const BackendCase& backend_case) {
  static const std::string nothing;
  if (!backend_case.gl) return nothing;
#ifdef SPOOR_WITH_GL
  // On a thread of its own: what is current on this one stays so.
  static const std::string no_context = [] {
    std::string lack;
    std::thread([&lack] {
      if (const auto context = openHeadlessContext(); !context) lack = context.error();
    }).join();
    return lack;
  }();
  return no_context;
#else
  static const std::string no_gl = "the gl backend is not in this build";
  return no_gl;
#endif
}

std::unique_ptr<Backend> borrowBackend(const BackendCase& backend_case) {
  const std::string name = shelfName(backend_case);
  std::unique_ptr<Backend> backend = shelf().take(name);
  if (backend == nullptr) backend = makeCase(backend_case);
  return std::make_unique<BorrowedBackend>(name, std::move(backend));
}

}  // namespace spoor::test
