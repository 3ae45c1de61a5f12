#pragma once

#include <array>
#include <map>
#include <string>

#include "shaders/host/gl_objects.h"
#include "shaders/host/shader_loader.h"
#include "shaders/rules/exchange.h"
#include "shared/world/parameters.h"

namespace spoor {

/// How the relaxation by pair exchange is dispatched. The same bits either way.
enum class RelaxSchedule {
  plain,  // one dispatch for each of a sweep's eight matchings, in place
  fused,  // one for a whole sweep, in shared memory with a halo: for hardware, where a dispatch costs more than cells
};

/// The programs of a tick, which its parameters choose; nullptr: not part of their methods.
struct TickPrograms {
  const GlProgram *gather = nullptr, *cover = nullptr, *ceiling = nullptr, *place = nullptr, *depth = nullptr,
                  *depth_large = nullptr, *penetration = nullptr, *hash = nullptr;
  const GlProgram *nearest_columns = nullptr, *nearest_search = nullptr;
  const GlProgram *flood_begin = nullptr, *flood_pass = nullptr;
  const GlProgram *displace_request = nullptr, *displace_request_again = nullptr, *displace_take = nullptr,
                  *displace_give = nullptr;  // the second in later rounds, with its own search
  const GlProgram *flow_begin = nullptr, *flow_offer = nullptr, *flow_move = nullptr, *flow_end = nullptr;
  // Of each matching; the second where bodies may stand over active tiles.
  std::array<std::array<const GlProgram*, 2>, rules::kMatchingCount> exchange{};
  const GlProgram* sweep = nullptr;
  std::array<std::array<const GlProgram*, 2>, 2> drift{};  // the second as above; then where bodies push
  const GlProgram *push_count = nullptr, *push_force = nullptr, *push_soil = nullptr;
  std::array<const GlProgram*, 2> slope_amounts{}, slope_sweep{};  // the second as above
};

/// Programs of every method, each compiled when it is first chosen, so that a method costs nothing until it is used.
class GlPrograms {
 public:
  GlPrograms(int group, RelaxSchedule schedule) : group_(group), schedule_(schedule) {}

  /// Throws std::runtime_error where a shader does not compile or link.
  const TickPrograms& choose(const Parameters& parameters);
  /// Those of stage craters, which no parameter chooses. Throw as above.
  const GlProgram& craters() { return *get("crater_ground"); }
  const GlProgram& snow() { return *get("snow"); }

 private:
  const GlProgram* get(const std::string& name, ShaderDefines defines = {}, int groups = 1);
  void chooseDisplacement(const Parameters& parameters, TickPrograms& chosen);
  void chooseSlopes(const Parameters& parameters, TickPrograms& chosen);
  void chooseExchange(const ShaderDefines& mixed, TickPrograms& chosen);
  void chooseDrift(const Parameters& parameters, const ShaderDefines& mixed, TickPrograms& chosen);

  int group_;
  RelaxSchedule schedule_;
  std::map<std::string, GlProgram> programs_;  // by name and defines
  TickPrograms chosen_;
  Parameters chosen_by_;
};

}  // namespace spoor
