#pragma once

#include <string>
#include <vector>

#include "server/tick_loop.h"
#include "shared/base/json.h"

namespace spoor {

/// A finished session in figures: what the table and the JSON file show (DESIGN.md, "Programs").
struct SessionReport {
  std::string scene, backend, renderer, pack_id;
  std::int32_t ticks = 0;
  LoopFigures figures;
  Ledger ledger;
  std::uint64_t server_hash = 0;
  std::vector<ClientReport> clients;
  std::size_t live_tiles = 0, store_bytes = 0;
};

/// Why the session does not hold what Spoor promises: a hash or the ledger is off, or a client was lost. Empty: it
/// does.
std::vector<std::string> faultsOf(const SessionReport& report, int expected_clients);

std::string tableOf(const SessionReport& report);
JsonWriter jsonOf(const SessionReport& report);

}  // namespace spoor
