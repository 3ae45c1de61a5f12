#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/base/result.h"
#include "shared/world/pack.h"

namespace spoor {

/// What the names say: the parameters of the ticks, and what shapes the world before the first. As made: the defaults.
struct NamedSettings {
  NamedSettings() { parameters.obstacle_threshold_q = 10; }

  Parameters parameters;
  std::vector<std::string> materials = {"soil"};  // names, of as many as the parameters have
  double terrain_size_m = 0;                      // 0: not given, the same below
  std::int32_t heightmap_size = 0;
  std::int32_t patches_per_row = 0;
  std::int32_t normal_blur_passes = 0;
  bool operator==(const NamedSettings&) const = default;
};

enum class NamedKind : std::uint8_t { number, integer, choice, flag };

/// A parameter as people name it: in the [thesis] table of a scene, in --set, on the console, in listings. There is one
/// list of them, in named_list.cpp, in the order in which values apply; its defaults are those of NamedSettings.
/// Those of a material are also keys of a scene's [[material]] tables; MATERIAL.NAME is one material's, NAME all's.
struct NamedParameter {
  std::string_view name;
  NamedKind kind;
  double lowest, highest;
  std::string_view unit;
  std::vector<std::string> choices;  // of a choice, whose values are indices here
  std::string_view fixed_because;    // why a running session cannot change it; empty: it can
  /// Writes a value (in range) to the settings. Errors say why not. nullptr: it is a material's.
  Status (*apply)(double value, std::int32_t cell_q, NamedSettings& settings) = nullptr;
  /// Reads it back, about; nothing where it has no value just now. nullptr: it is a material's, or a short name for
  /// others.
  std::optional<double> (*read)(const NamedSettings& settings, std::int32_t cell_q) = nullptr;
  /// The same of a material's parameter.
  void (*apply_to)(double value, std::int32_t cell_q, MaterialRules& rules) = nullptr;
  double (*read_of)(const MaterialRules& rules, std::int32_t cell_q) = nullptr;

  bool isOfMaterial() const { return apply_to != nullptr; }
  bool isShortName() const { return read == nullptr && read_of == nullptr; }
};
std::span<const NamedParameter> namedParameters();

/// nullptr: there is none.
const NamedParameter* findNamed(std::string_view name);

/// A value of a parameter, within its range. Flags: 0 and 1; choices: the index.
struct NamedValue {
  const NamedParameter* parameter = nullptr;
  double value = 0;
  std::string material = {};  // whose it is, of a material's parameter; empty: all materials'
};

/// Is this a name that --set and the console can say: 1 to 64 letters, digits, _ or -?
bool isMaterialName(std::string_view name);

/// "roughness", "mud.roughness"
std::string nameOf(const NamedValue& value);

/// "0 .. 1", "1 .. 64 cells", "euclidean, manhattan, chebyshev", "true, false".
std::string rangeText(const NamedParameter& parameter);

/// Reads "NAME=VALUE" or "MATERIAL.NAME=VALUE". Safe on untrusted text: unknown names, other kinds of values and values
/// out of range are errors. Whether there is such a material shows when the value is applied.
Result<NamedValue> parseNamed(std::string_view assignment);

/// What does not go: which value, and why.
struct NamedError {
  const NamedParameter* parameter;
  std::string name;  // nameOf
  std::string why;
};

/// The step from names to numbers: writes values to the settings, in the list's order, however they are ordered, those
/// of single materials after all others. Lengths and shares are rounded to their integers here.
/// @param cell_q  side of a cell, 0.1 mm: slopeThreshold and activeAreaMargin count in cells in the end
/// @param notes   gets a line where a value does not do what one may think
/// Errors, which leave the settings untouched: a name given twice, a material that is not there, what cannot go
/// together.
std::optional<NamedError> applyNamed(std::span<const NamedValue> values, std::int32_t cell_q, NamedSettings& settings,
                                     std::vector<std::string>& notes);

/// The same in a running session. Errors besides: the world's shape would change, or validateParameters refuses.
Result<Parameters> changeParameters(const ScenePack& pack, const Parameters& from, std::span<const NamedValue> values,
                                    std::vector<std::string>& notes);

/// "NAME VALUE" for every parameter that has one, each value the shortest decimal that gives the same integers; of a
/// material's parameter one line where all materials have the same, else "MATERIAL.NAME VALUE" for each.
/// @param parameters  of the pack's session
std::vector<std::string> describeParameters(const ScenePack& pack, const Parameters& parameters);
/// "NAME OLD -> NEW, MATERIAL.NAME OLD -> NEW"; empty where nothing differs.
std::string describeChange(const ScenePack& pack, const Parameters& from, const Parameters& to);

/// slopeThreshold as an integer: the largest height difference of neighbours for which atan(dh) / d > s does not hold.
/// @param per_metre  s, >= 0
/// @param cell_q     d, 0.1 mm
/// @return  0.1 mm; kNeverSteep where s * d is a right angle or more, or the threshold is beyond 53 km.
/// dh is whole, so dh > floor(tan(s * d)) is the same rule. That floor is never in doubt but by rounding: s and d are
/// rational, and the tangent of a rational angle other than 0 is irrational (Lambert), so it is no whole number. The
/// candidate from tan() is corrected by the rule itself, atan() in extended precision; a difference that is steep by
/// less than the last two bits of s rests, so that s written as atan(dh) / d, which is rounded, means that dh.
/// Source: Persson 2019, equation 4.1
std::int32_t slopeThreshold(double per_metre, std::int32_t cell_q);

/// The threshold of diagonal neighbours, sqrt(2) further apart, rounded down.
std::int32_t diagonalThreshold(std::int32_t slope_threshold_q);

/// Sets both thresholds and the angle of a material. Thresholds are rounded down, the angle to nearest; no threshold is
/// 0.
/// @param repose_deg  0 .. kReposeLimitDeg
/// Returns whether the angle is less than 0.1 mm per cell, so that a threshold was rounded up.
bool setRepose(double repose_deg, std::int32_t cell_q, MaterialRules& rules);
inline constexpr double kReposeLimitDeg = 89;

}  // namespace spoor
