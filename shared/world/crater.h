#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "shaders/rules/crater.h"
#include "shared/base/bytes.h"
#include "shared/base/result.h"
#include "shared/world/cell_box.h"

namespace spoor {

struct ScenePack;

/// An explosion's mark on the ground (Cossetin Neto et al. 2023): all there is of it on the wire, in the state and on
/// disk. Lengths in 0.1 mm; see rules/crater.h for what they do.
struct Crater {
  std::int32_t x_q = 0;  // centre, from the south-west corner of the world; it may lie outside
  std::int32_t y_q = 0;
  std::int32_t inner_radius_q = 0;  // R1: of the ellipsoid, and the torus's minor radius; 0 .. R2
  std::int32_t crest_radius_q = 1;  // R2: of the torus, where the crest stands; >= 1
  std::int32_t rim_height_q = 0;    // H4: of the crest
  std::int32_t depth_q = 0;         // D5: at the centre
  std::uint16_t noise_seed = 0;
  std::uint16_t noise_q16 = 0;  // amplitude as a share of H4 + D5; 65535 is just under 1, 0: none
  std::int32_t tick = 0;        // in which it enters the state, >= 1
  std::uint32_t id = 0;         // the how manieth of the session, from 0 on
  bool operator==(const Crater&) const = default;

  /// R3 = 2 R2 - R1, where it ends. 64 bits: a record from outside may hold anything.
  std::int64_t outerRadius() const { return std::int64_t(2) * crest_radius_q - inner_radius_q; }
};

inline constexpr std::size_t kCraterBytes = 6 * 4 + 2 * 2 + 2 * 4;
inline constexpr std::size_t kCratersLimit = std::size_t(1) << 21;      // of a session
inline constexpr std::size_t kTickCratersLimit = std::size_t(1) << 16;  // of a tick
// Of a session, all craters together: cells of the spatial hash that they are in. With their places to spare they fit
// the storage block of 128 MiB that every OpenGL 4.5 gives.
inline constexpr std::int64_t kCraterHashCellsLimit = std::int64_t(1) << 22;

/// What a scene admits. Clients see it with the pack; the server holds them to it.
struct CraterLimits {
  std::int32_t radius_q = 0;          // largest R3, up to rules::kCraterReachLimit; 0: no craters at all
  std::int32_t hash_cell_q = 750000;  // side of the spatial hash's cells; the bits do not depend on it
  // Of what a client may ask for:
  std::int32_t request_radius_q = 0;      // largest R3; 0: it may not ask
  std::int32_t request_height_q = 0;      // largest D5 and H4
  std::int32_t request_distance_q = 0;    // from its centre to the nearest body; 0: anywhere
  std::int32_t requests_per_minute = 30;  // of each client
  bool operator==(const CraterLimits&) const = default;
};

/// Checks limits of a pack. The error names the field.
[[nodiscard]] Status validateCraterLimits(const CraterLimits& limits);

/// Checks all of a crater but its tick and id against a pack: sizes and their order, and that the square about it meets
/// the map. The error names what is wrong, with the value and what is allowed.
[[nodiscard]] Status validateCrater(const ScenePack& pack, const Crater& crater);

/// Checks craters that are to be added to a session's `before` ones, which are in `hash_cells_before` hash cells.
[[nodiscard]] Status validateNewCraters(const ScenePack& pack, std::span<const Crater> craters, std::size_t before,
                                        std::int64_t hash_cells_before = 0);

/// In how many cells of the spatial hash a valid crater is.
std::int64_t hashCellsOf(const ScenePack& pack, const Crater& crater);

/// A length in metres for messages, without the unit: "17.5".
std::string metresText(std::int64_t value_q);

void putCrater(ByteWriter& writer, const Crater& crater);
/// Reads what putCrater wrote; values are not checked (validateCrater).
Crater getCrater(ByteReader& reader);

/// The crater must be valid.
rules::CraterShape shapeOf(const Crater& crater);

/// Cells that the crater can change, clipped to the world.
CellBox craterBox(std::int32_t cell_q, std::int32_t width_cells, std::int32_t height_cells, const Crater& crater);
CellBox craterBox(const ScenePack& pack, const Crater& crater);

/// The H4 that makes up for the cavity's volume: with it the profile's integral over the plane is zero, to the rounding
/// of H4. Algorithm 1 integrates to 2 pi (R2^2 (0.35 H4 - 0.15 D5) + H4 m ((2 - 3 pi / 8) R2 + 0.35 m)), m = R2 - R1.
/// Ranges: those of a valid crater.
std::int32_t balancedRimHeight(std::int32_t inner_radius_q, std::int32_t crest_radius_q, std::int32_t depth_q);

}  // namespace spoor
