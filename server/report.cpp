#include "server/report.h"

#include <fmt/format.h>

#include <numeric>

#include "shared/base/statistics.h"

namespace spoor {
namespace {

std::int64_t meanCells(const LoopFigures& figures) {
  if (figures.active_cells.empty()) return 0;
  return std::int64_t(std::accumulate(figures.active_cells.begin(), figures.active_cells.end(), 0.0) /
                      double(figures.active_cells.size()));
}

double bytesPerTick(const ClientReport& client) {
  return client.ticks_sent > 0 ? double(client.tick_bytes_sent) / client.ticks_sent : 0;
}

double meanBytesPerTick(const SessionReport& report) {
  double sum = 0;
  for (const ClientReport& client : report.clients) sum += bytesPerTick(client);
  return report.clients.empty() ? 0 : sum / double(report.clients.size());
}

bool endedEqual(const SessionReport& report, const ClientReport& client) {
  return client.confirmed_tick == report.ticks && client.confirmed_hash == report.server_hash;
}

}  // namespace

std::vector<std::string> faultsOf(const SessionReport& report, int expected_clients) {
  std::vector<std::string> faults;
  if (report.figures.unbalanced_ticks > 0)
    faults.push_back(fmt::format("the ledger was off in {} ticks", report.figures.unbalanced_ticks));
  if (report.ledger.error() != 0) faults.push_back(fmt::format("the ledger is off by {} units", report.ledger.error()));
  int equal = 0;
  for (const ClientReport& client : report.clients) {
    equal += endedEqual(report, client) ? 1 : 0;
    if (client.mismatches > 0)
      faults.push_back(fmt::format("client '{}' had {} wrong hashes", client.name, client.mismatches));
    if (client.confirmed_tick == report.ticks && client.confirmed_hash != report.server_hash)
      faults.push_back(fmt::format("client '{}' ended on another hash", client.name));
  }
  if (equal < expected_clients)
    faults.push_back(fmt::format("{} of {} clients ended on the server's hash", equal, expected_clients));
  return faults;
}

std::string tableOf(const SessionReport& report) {
  const LoopFigures& figures = report.figures;
  const double busy_ms = std::accumulate(figures.tick_ms.begin(), figures.tick_ms.end(), 0.0);
  const double kept_ticks = double(figures.tick_ms.size());
  std::string text;
  const auto row = [&](std::string_view name, const std::string& value) {
    text += fmt::format("{:<22} {}\n", name, value);
  };
  row("scene", fmt::format("{} (pack {})", report.scene, report.pack_id));
  row("backend", fmt::format("{}, renderer {}", report.backend, report.renderer));
  row("ticks", fmt::format("{} in {:.2f} s = {:.1f} ticks/s; {:.1f} ticks/s were possible; {} began late", report.ticks,
                           figures.wall_s, report.ticks / figures.wall_s, busy_ms > 0 ? kept_ticks / busy_ms * 1e3 : 0,
                           figures.late_ticks));
  row("ms per tick", fmt::format("{:.3f} median, {:.3f} 99th percentile", percentile(figures.tick_ms, 0.5),
                                 percentile(figures.tick_ms, 0.99)));
  for (int stage = 0; stage < kStageCount; ++stage)
    if (percentile(figures.stage_ms[stage], 1) > 0)
      row(fmt::format("  {}", kStageNames[stage]),
          fmt::format("{:.3f} median, {:.3f} 99th percentile", percentile(figures.stage_ms[stage], 0.5),
                      percentile(figures.stage_ms[stage], 0.99)));
  row("active cells", fmt::format("{} mean; {} live tiles, {:.2f} MB", meanCells(figures), report.live_tiles,
                                  double(report.store_bytes) / 1e6));
  row("bytes per tick, client", fmt::format("{:.0f}", meanBytesPerTick(report)));
  row("ledger", fmt::format("initial {} = ground {} + compacted {} - craters {} - events {}; error {}",
                            report.ledger.initial, report.ledger.ground, report.ledger.compacted, report.ledger.craters,
                            report.ledger.events, report.ledger.error()));
  std::int64_t asked = 0, refused = 0;
  for (const ClientReport& client : report.clients) {
    asked += client.craters_asked;
    refused += client.craters_refused;
  }
  if (figures.craters > 0 || figures.craters_refused > 0 || asked > 0)
    row("craters", fmt::format("{}; {} left out; clients asked for {}, {} refused", figures.craters,
                               figures.craters_refused, asked, refused));
  if (figures.snowfalls > 0 || figures.snowfalls_refused > 0)
    row("snowfalls", fmt::format("{} besides the scene's; {} left out", figures.snowfalls, figures.snowfalls_refused));
  if (figures.waiting_ticks > 0)
    row("too much", fmt::format("in {} ticks more than {} tiles were awake, and some waited", figures.waiting_ticks,
                                kTickTilesLimit));
  if (figures.too_fast_ticks > 0)
    row("too fast", fmt::format("in {} ticks a body outran its sub-steps", figures.too_fast_ticks));
  if (figures.kept_back > 0)
    row("kept back",
        fmt::format("{} units of soil found no room beside bodies, summed over sub-steps", figures.kept_back));
  row("hash server", hexText(report.server_hash));
  for (const ClientReport& client : report.clients)
    row(fmt::format("hash {}", client.name),
        fmt::format("{} at tick {}{}{}; {:.0f} B/tick, joined with {} B", hexText(client.confirmed_hash),
                    client.confirmed_tick, endedEqual(report, client) ? ", equal" : "",
                    client.left_because.empty() ? "" : ", left: " + client.left_because, bytesPerTick(client),
                    client.snapshot_bytes_sent));
  return text;
}

JsonWriter jsonOf(const SessionReport& report) {
  const auto times = [](JsonWriter& json, const char* key, const std::vector<double>& values) {
    json.beginObject(key);
    json.value("median", percentile(values, 0.5));
    json.value("p99", percentile(values, 0.99));
    json.end();
  };
  JsonWriter json;
  json.beginObject();
  json.value("scene", report.scene);
  json.value("pack_id", report.pack_id);
  json.value("ticks", std::int64_t(report.ticks));
  json.value("backend", report.backend);
  json.value("renderer", report.renderer);
  json.value("ticks_per_second", report.figures.wall_s > 0 ? report.ticks / report.figures.wall_s : 0);
  json.beginObject("tick_ms");
  times(json, "whole", report.figures.tick_ms);
  for (int stage = 0; stage < kStageCount; ++stage) times(json, kStageNames[stage], report.figures.stage_ms[stage]);
  json.end();
  json.value("active_cells", meanCells(report.figures));
  json.value("live_tiles", std::int64_t(report.live_tiles));
  json.value("bytes_per_tick_client", meanBytesPerTick(report));
  json.beginObject("ledger");
  json.value("initial", report.ledger.initial);
  json.value("ground", report.ledger.ground);
  json.value("compacted", report.ledger.compacted);
  json.value("craters", report.ledger.craters);
  json.value("events", report.ledger.events);
  json.value("error", report.ledger.error());
  json.end();
  json.value("kept_back", report.figures.kept_back);
  json.value("crater_count", report.figures.craters);
  json.value("craters_left_out", report.figures.craters_refused);
  json.value("snowfall_count", report.figures.snowfalls);
  json.value("snowfalls_left_out", report.figures.snowfalls_refused);
  json.hash("server_hash", report.server_hash);
  json.beginArray("client_hashes");
  for (const ClientReport& client : report.clients) {
    json.beginObject();
    json.value("name", client.name);
    json.hash("hash", client.confirmed_hash);
    json.value("tick", std::int64_t(client.confirmed_tick));
    json.value("equal", endedEqual(report, client));
    json.value("bytes_per_tick", bytesPerTick(client));
    json.value("craters_asked", std::int64_t(client.craters_asked));
    json.value("craters_refused", std::int64_t(client.craters_refused));
    json.value("left_because", client.left_because);
    json.end();
  }
  json.end();
  json.end();
  return json;
}

}  // namespace spoor
