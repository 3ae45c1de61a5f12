#pragma once

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "tests/gl_cases.h"
#include "tests/scenes.h"

namespace spoor::test {

/// Fails where a tick does not tell what native tells.
inline void compareResults(const Result<TickResult>& result, const Result<TickResult>& expected) {
  ASSERT_TRUE(expected) << expected.error();
  ASSERT_TRUE(result) << result.error();
  const auto tick = "tick " + std::to_string(expected->update.tick);
  ASSERT_EQ(result->update.state_hash, expected->update.state_hash) << tick;
  ASSERT_EQ(result->update.tick, expected->update.tick);
  ASSERT_EQ(result->update.poses, expected->update.poses) << tick;
  ASSERT_EQ(result->update.tiles, expected->update.tiles) << tick;
  ASSERT_EQ(result->update.craters, expected->update.craters) << tick;
  ASSERT_EQ(result->update.snowfalls, expected->update.snowfalls) << tick;
  ASSERT_EQ(result->ledger, expected->ledger) << tick;
  ASSERT_EQ(result->ledger.error(), 0) << tick;
  ASSERT_EQ(result->too_fast, expected->too_fast) << tick;
  ASSERT_EQ(result->effect.penetrating_cells, expected->effect.penetrating_cells) << tick;
  ASSERT_EQ(result->effect.domain_cells, expected->effect.domain_cells) << tick;
  ASSERT_EQ(result->effect.active_cells, expected->effect.active_cells) << tick;
  ASSERT_EQ(result->effect.kept_back, expected->effect.kept_back) << tick;
}

/// A gl backend of its own. Throws as borrowBackend does.
inline std::unique_ptr<Backend> makeOwnBackend(const GlOptions& options) {
  auto backend = makeGlBackend(options);
  if (!backend) throw std::runtime_error(backend.error());
  return std::move(*backend);
}

}  // namespace spoor::test
