#include "shaders/host/gl_programs.h"

namespace spoor {
namespace {

// Lanes of a fused sweep and of a domain's later rounds, for each lane of the other stages: their groups have 1024
// cells and their halo, or all of a domain's sources, to work on.
constexpr int kLargeGroup = 4;

std::string defined(bool on) { return on ? "1" : "0"; }

bool sameMethods(const Parameters& a, const Parameters& b) {
  return a.displacement == b.displacement && a.nearest == b.nearest && a.metric == b.metric && a.slopes == b.slopes &&
         a.drift_weights == b.drift_weights && anyCompression(a) == anyCompression(b) &&
         (a.materials.size() > 1) == (b.materials.size() > 1);
}

}  // namespace

const GlProgram* GlPrograms::get(const std::string& name, ShaderDefines defines, int groups) {
  std::string key = name;
  for (const auto& [define, value] : defines) key += " " + define + "=" + value;
  const auto found = programs_.find(key);
  if (found != programs_.end()) return &found->second;
  defines.emplace_back("SPOOR_GROUP", std::to_string(groups * group_));
  return &programs_.emplace(key, makeProgram({"sim/" + name + ".comp"}, defines)).first->second;
}

const TickPrograms& GlPrograms::choose(const Parameters& parameters) {
  if (chosen_.gather != nullptr && sameMethods(parameters, chosen_by_)) return chosen_;
  TickPrograms chosen;
  const bool presses = anyCompression(parameters);
  const std::string compacts = defined(presses), mixed = defined(parameters.materials.size() > 1);
  chosen.gather = get("gather", {{"SPOOR_COMPACTS", compacts}, {"SPOOR_MIXED", mixed}});
  chosen.cover = get("cover");
  chosen.ceiling = get("ceiling");
  chosen.place = get("place");
  chosen.depth = get("depth");
  chosen.depth_large = get("depth_large");
  chosen.penetration = get("penetration", {{"SPOOR_COMPACTS", compacts}, {"SPOOR_MIXED", presses ? mixed : "0"}});
  chosen.hash = get("hash", {{"SPOOR_COMPACTS", compacts}});
  chooseDisplacement(parameters, chosen);
  chooseSlopes(parameters, chosen);
  chosen_ = chosen;
  chosen_by_ = parameters;
  return chosen_;
}

void GlPrograms::chooseDisplacement(const Parameters& parameters, TickPrograms& chosen) {
  if (parameters.displacement == Displacement::none) return;
  const std::string metric = std::to_string(int(parameters.metric));
  const bool exact = parameters.nearest == NearestSearch::exact;
  if (exact) {
    chosen.nearest_columns = get("nearest_columns");
    chosen.nearest_search = get("nearest_search", {{"SPOOR_METRIC", metric}});
  } else {
    chosen.flood_begin = get("flood_begin");
    chosen.flood_pass = get("flood_pass", {{"SPOOR_METRIC", metric}});
  }
  if (parameters.displacement == Displacement::iterative) {
    chosen.flow_begin = get("flow_begin", {{"SPOOR_METRIC", metric}});
    chosen.flow_offer = get("flow_offer");
    chosen.flow_move = get("flow_move");
    chosen.flow_end = get("flow_end");
    return;
  }
  const std::string spread = defined(parameters.displacement == Displacement::spread);
  chosen.displace_request = get("displace_request", {{"SPOOR_SPREAD", spread}, {"SPOOR_SEARCH", "0"}});
  if (exact)
    chosen.displace_request_again =
        get("displace_request", {{"SPOOR_SPREAD", spread}, {"SPOOR_SEARCH", "1"}, {"SPOOR_METRIC", metric}});
  chosen.displace_take = get("displace_take", {{"SPOOR_SPREAD", spread}});
  chosen.displace_give = get("displace_give");
}

void GlPrograms::chooseSlopes(const Parameters& parameters, TickPrograms& chosen) {
  const ShaderDefines mixed = {{"SPOOR_MIXED", defined(parameters.materials.size() > 1)}};
  const SlopeRule rule = parameters.slopes;
  if (rule == SlopeRule::exchange) return chooseExchange(mixed, chosen);
  if (rule == SlopeRule::drift) return chooseDrift(parameters, mixed, chosen);
  for (std::size_t beneath = 0; beneath < 2; ++beneath) {
    ShaderDefines defines = mixed;
    defines.emplace_back("SPOOR_BENEATH", std::to_string(beneath));
    if (rule == SlopeRule::flux) chosen.slope_sweep[beneath] = get("slope_flux", defines);
    if (rule == SlopeRule::scatter) chosen.slope_sweep[beneath] = get("slope_scatter", defines);
    if (rule != SlopeRule::interleaved) continue;
    chosen.slope_amounts[beneath] = get("slope_amounts", defines);
    chosen.slope_sweep[beneath] = get("slope_gather", defines);
  }
}

void GlPrograms::chooseExchange(const ShaderDefines& mixed, TickPrograms& chosen) {
  if (schedule_ == RelaxSchedule::fused) {
    chosen.sweep = get("sweep", mixed, kLargeGroup);
    return;
  }
  for (int matching = 0; matching < rules::kMatchingCount; ++matching)
    for (std::size_t beneath = 0; beneath < 2; ++beneath) {
      const int shift = matching < rules::kMatchDiagonal ? 0 : matching < rules::kMatchAntidiagonal ? 1 : -1;
      ShaderDefines defines = mixed;
      defines.emplace_back("SPOOR_PARITY", std::to_string(matching & 1));
      defines.emplace_back("SPOOR_SHIFT", std::to_string(shift));
      defines.emplace_back("SPOOR_BENEATH", std::to_string(beneath));
      chosen.exchange[std::size_t(matching)][beneath] =
          get(matching < rules::kMatchVertical ? "exchange_along" : "exchange_across", defines);
    }
}

void GlPrograms::chooseDrift(const Parameters& parameters, const ShaderDefines& mixed, TickPrograms& chosen) {
  for (std::size_t beneath = 0; beneath < 2; ++beneath)
    for (std::size_t pushes = 0; pushes < 2; ++pushes) {
      ShaderDefines defines = mixed;
      defines.emplace_back("SPOOR_BENEATH", std::to_string(beneath));
      defines.emplace_back("SPOOR_WEIGHTS", std::to_string(int(parameters.drift_weights)));
      defines.emplace_back("SPOOR_PUSHES", std::to_string(pushes));
      chosen.drift[beneath][pushes] = get("drift", defines);
    }
  chosen.push_count = get("push_count");
  chosen.push_force = get("push_force");
  chosen.push_soil = get("push_soil", mixed);
}

}  // namespace spoor
