#pragma once

#include <cstdint>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shared/base/result.h"
#include "shared/world/state.h"

namespace spoor {

// A session file is "SPRS", a format version, and records, each
//   u32 payload bytes | u8 kind | payload | u64 hash of kind and payload
// The first record is the pack; then one for each tick, in order. A file may end anywhere: what is whole counts.

/// One tick as recorded: its inputs, and what they led to.
struct TickRecord {
  std::int32_t tick = 0;
  std::vector<Pose> poses;
  std::uint64_t state_hash = 0;
  Ledger ledger;
  std::optional<Parameters> parameters = {};  // from this tick on, where they changed
  std::vector<Crater> craters = {};           // that came with it
  std::vector<Snowfall> snowfalls = {};       // the same
};

/// Appends to a session file from a thread of its own: append() never waits for the disk.
class SessionWriter {
 public:
  /// Creates the file (an existing one is replaced) and writes the pack. Errors: it cannot be created.
  static Result<std::unique_ptr<SessionWriter>> create(const std::string& path,
                                                       std::span<const std::uint8_t> encoded_pack);
  virtual ~SessionWriter() = default;

  virtual void append(TickRecord record) = 0;
  /// Writes what is queued and closes. Errors: the disk refused something, now or earlier.
  [[nodiscard]] virtual Status close() = 0;
};

/// Reads a session file record by record. Safe on untrusted bytes.
class SessionReader {
 public:
  /// Errors: no such file, not a session, no whole pack record.
  static Result<std::unique_ptr<SessionReader>> open(const std::string& path);

  const ScenePack& pack() const { return pack_; }
  const PackId& id() const { return id_; }

  /// The next tick; nothing at the end. Errors: a damaged record (where, and why). A record that is cut off by the end
  /// of the file is the end, and sets truncated().
  Result<std::optional<TickRecord>> next();
  bool truncated() const { return truncated_; }

 private:
  struct Record {
    std::uint8_t kind;
    std::vector<std::uint8_t> payload;
  };
  Result<std::optional<Record>> nextRecord();

  std::ifstream file_;
  std::string path_;
  ScenePack pack_;
  PackId id_;
  std::int64_t position_ = 0;
  std::int32_t last_tick_ = 0;
  std::size_t crater_count_ = 0;    // of the ticks read
  std::size_t snowfall_count_ = 0;  // the same, and of the pack
  bool truncated_ = false;
};

}  // namespace spoor
