#include "server/import/thesis_table.h"

#include <algorithm>
#include <iterator>

#include "server/import/pack_maker.h"
#include "server/import/units.h"
#include "shared/base/assert.h"

namespace spoor {
namespace {

double readValue(TableReader& thesis, const NamedParameter& parameter) {
  const Range range = namedRange(parameter.name);
  switch (parameter.kind) {
    case NamedKind::number:
      return thesis.number(parameter.name, range);
    case NamedKind::integer:
      return double(thesis.integer(parameter.name, range));
    case NamedKind::flag:
      return thesis.flag(parameter.name, false) ? 1 : 0;
    case NamedKind::choice:
      break;
  }
  const auto chosen = std::ranges::find(parameter.choices, thesis.choice(parameter.name, parameter.choices));
  return double(std::min(chosen - parameter.choices.begin(), std::ssize(parameter.choices) - 1));
}

}  // namespace

std::vector<NamedValue> readNamedValues(TableReader& table, NamedKeys keys) {
  std::vector<NamedValue> values;
  for (const NamedParameter& parameter : namedParameters())
    if ((keys == NamedKeys::all || parameter.isOfMaterial()) && table.has(parameter.name))
      values.push_back({&parameter, readValue(table, parameter)});
  return values;
}

void applyToTable(const std::vector<NamedValue>& values, std::int32_t cell_q, TableReader& table,
                  NamedSettings& settings, std::vector<std::string>& notes) {
  std::vector<std::string> new_notes;
  if (const auto error = applyNamed(values, cell_q, settings, new_notes))
    table.wrong(error->parameter->name, error->why);
  for (const std::string& text : new_notes) notes.push_back(table.keyPath(text));
}

Range namedRange(std::string_view name) {
  const NamedParameter* parameter = findNamed(name);
  SPOOR_ASSERT(parameter != nullptr);
  return {parameter->lowest, parameter->highest, parameter->unit};
}

void refuseBoth(TableReader& thesis, std::string_view key, const TableReader& other, std::string_view other_key) {
  if (thesis.has(key) && other.has(other_key))
    thesis.wrong(key, other.keyPath(other_key) + " is given too and says the same; give one of the two");
}

void readSoil(TableReader& soil, TableReader& thesis, const std::vector<NamedValue>& named, ScenePack& pack,
              std::vector<std::string>& notes) {
  for (const char* key : {"slopeThreshold", "angleOfRepose"}) refuseBoth(thesis, key, soil, "repose_deg");
  refuseBoth(thesis, "obstacleThreshold", soil, "obstacle_threshold_m");
  refuseBoth(thesis, "numIterationsEvenOutSlopes", soil, "sweeps_per_tick");
  std::vector<NamedValue> preset, single;
  std::ranges::partition_copy(
      named, std::back_inserter(preset), std::back_inserter(single),
      [](const NamedValue& value) { return !value.parameter->isOfMaterial() && value.parameter->isShortName(); });
  NamedSettings settings;
  applyToTable(preset, pack.cell_q, thesis, settings, notes);
  pack.parameters = settings.parameters;
  const double repose_deg = soil.number("repose_deg", {0, kReposeLimitDeg, "degrees"}, kDefaultReposeDeg);
  if (!thesis.has("slopeThreshold") && !thesis.has("angleOfRepose")) setReposeAngle(pack, repose_deg, notes);
  const double obstacle_m = soil.number("obstacle_threshold_m", {0, 100, "m"}, 0);
  if (soil.has("obstacle_threshold_m")) pack.parameters.obstacle_threshold_q = toUnits(obstacle_m);
  pack.parameters.sweeps_per_tick =
      std::int32_t(soil.integer("sweeps_per_tick", {0, kIterationsLimit, ""}, pack.parameters.sweeps_per_tick));
  settings.parameters = pack.parameters;
  applyToTable(single, pack.cell_q, thesis, settings, notes);
  pack.parameters = settings.parameters;
  pack.patches_per_row = settings.patches_per_row;
  pack.normal_blur_passes = settings.normal_blur_passes;
  soil.finish();
}

}  // namespace spoor
