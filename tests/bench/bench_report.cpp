// The report as JSON and CSV.
#include <cstdio>
#include <fstream>
#include <stdexcept>

#include "shared/base/json.h"
#include "tests/bench/bench_measures.h"

namespace spoor {
namespace {

void writeSeries(JsonWriter& json, const Series& series) {
  json.beginObject();
  json.value("scene", series.scene);
  json.value("label", series.label);
  json.value("backend", series.backend);
  json.value("skip_settled", series.skip_settled);
  json.value("ticks", std::int64_t(series.tick_ms.size()));
  json.value("tick_ratio", series.tick_ratio);
  for (const Figure& figure : figuresOf(series)) {
    if (figure.whole)
      json.value(figure.key, std::int64_t(figure.value));
    else
      json.value(figure.key, figure.value);
  }
  json.hash("hash", series.hashes.back());
  json.value("ledger_error", series.ledger_error);
  json.end();
}

void writeAreas(JsonWriter& json, const std::vector<AreasResult>& areas) {
  json.beginArray("areas");
  for (const AreasResult& result : areas) {
    json.beginObject();
    json.value("areas", std::int64_t(result.area_count));
    json.value("label", result.label);
    json.value("time_ratio", result.time_ratio);
    json.value("most_dispatches", result.most_dispatches);
    json.value("dispatches_met", result.dispatches_met);
    json.value("time_met", result.time_met);
    json.end();
  }
  json.end();
  json.value("areas_time_goal", kAreasTimeGoal);
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

std::string csvNumber(const Figure& figure) {
  char text[32];
  std::snprintf(text, sizeof text, figure.whole ? "%.0f" : "%.6g", figure.value);
  return text;
}

std::string csvText(const Report& report) {
  if (report.runs.empty()) return "copy_gb_per_s\n" + csvNumber({"", "", report.copy_gb_per_s, false, false}) + "\n";
  std::string text = "scene,label,backend,skip_settled,ticks,tick_ratio";
  for (const Figure& figure : figuresOf(report.runs.front())) text += "," + figure.key;
  text += ",hash,ledger_error\n";
  for (const Series& series : report.runs) {
    text += quoted(series.scene) + "," + quoted(series.label) + "," + quoted(series.backend) + "," +
            (series.skip_settled ? "1," : "0,") + std::to_string(series.tick_ms.size()) + "," +
            csvNumber({"", "", series.tick_ratio, false, false});
    for (const Figure& figure : figuresOf(series)) text += "," + csvNumber(figure);
    text += "," + hexText(series.hashes.back()) + "," + std::to_string(series.ledger_error) + "\n";
  }
  return text;
}

}  // namespace

void writeReportJson(const Report& report, const std::string& measurement, const std::string& path) {
  JsonWriter json;
  json.beginObject();
  json.value("measurement", measurement);
  if (report.copy_gb_per_s > 0) json.value("copy_gb_per_s", report.copy_gb_per_s);
  json.beginObject("thesis_bytes_per_map_cell");
  json.value("with_storage_buffers", std::int64_t(kThesisBufferBytes));
  json.value("iterative", std::int64_t(kThesisIterativeBytes));
  json.end();
  json.beginArray("runs");
  for (const Series& series : report.runs) writeSeries(json, series);
  json.end();
  if (!report.areas.empty()) writeAreas(json, report.areas);
  json.beginArray("faults");
  for (const std::string& fault : report.faults) json.value({}, fault);
  json.end();
  json.value("good", report.faults.empty());
  json.end();
  if (Status status = json.writeFile(path); !status) throw std::runtime_error(status.error());
}

void writeReportCsv(const Report& report, const std::string& path) {
  std::ofstream file(path, std::ios::binary);
  if (!(file << csvText(report)) || !file.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace spoor
