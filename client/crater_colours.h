#pragma once

#include <optional>

#include "shaders/host/gl_crater_table.h"

namespace spoor {

/// The craters of the state that is drawn, on the graphics card, where shaders/render/crater_look.glsl finds those of a
/// place through their spatial hash. Needs its context current; std::runtime_error where that lacks something.
class CraterColours {
 public:
  CraterColours();

  /// Whether the set holds all craters of the last update, so that only what came since has to be done.
  bool goesOn(const CraterSet& craters) const;

  /// Brings the card to the set, which goes on from the last update's. Throws where the card has not the memory.
  void update(const CraterSet& craters, std::int32_t cell_q);

  void bind() const;
  void forget();

 private:
  GlCraterTable table_;
  std::size_t count_ = 0;
  std::optional<Crater> newest_;
};

}  // namespace spoor
