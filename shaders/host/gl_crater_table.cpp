#include "shaders/host/gl_crater_table.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "shaders/host/gl_context.h"
#include "shaders/host/shader_loader.h"
#include "shared/base/assert.h"

namespace spoor {
namespace {

constexpr int kGroup = 64;
static_assert(sizeof(rules::CraterHead) == 32 && sizeof(rules::CraterNode) == 20);

constexpr rules::CraterHead kNone{1, 0, 0, -1, 0, 1, {}};
constexpr std::int64_t kNodesBytes =
    std::int64_t(sizeof(std::int32_t) + rules::kCraterNodesAtOnce * sizeof(rules::CraterNode));

GlProgram kernel(const std::string& name, int group = kGroup) {
  return makeProgram({"sim/crater_" + name + ".comp"}, {{"SPOOR_GROUP", std::to_string(group)}});
}

/// Hash cells that a crater meets.
int cellsOf(const CraterTable& table, const Crater& crater) {
  const auto outer = int(crater.outerRadius());
  const auto along = [&](int centre, int size) {
    const int first = rules::craterFirstCell(centre, outer, table.side_q);
    return std::max(rules::craterLastCell(centre, outer, table.side_q, size) - first + 1, 0);
  };
  return along(crater.x_q, table.width_q) * along(crater.y_q, table.height_q);
}

void clear(const GrowingBuffer& buffer, std::int64_t bytes) {
  glClearNamedBufferSubData(buffer.name(), GL_R32I, 0, bytes, GL_RED_INTEGER, GL_INT, nullptr);
}

}  // namespace

/// In the order in which they run.
struct GlCraterTable::Programs {
  GlProgram count = kernel("count"), sums = kernel("sums"), scan = kernel("scan", rules::kCraterScanLanes),
            first = kernel("first");
  GlProgram list = kernel("list"), place = kernel("place"), settle = kernel("settle");
};

GlCraterTable::GlCraterTable(std::int64_t block_bytes)
    : head_(makeBuffer()),
      shapes_("the craters", block_bytes, GrowingBuffer::Content::kept),
      first_("the first places of craters' buckets", block_bytes),
      used_("the filling of craters' buckets", block_bytes),
      entries_("the entries of craters", block_bytes),
      starts_("the stretches of craters' buckets", block_bytes),
      heads_("the lists of craters' buckets", block_bytes),
      nodes_("the new entries of craters", block_bytes) {
  glNamedBufferStorage(head_.name(), sizeof kNone, &kNone, GL_DYNAMIC_STORAGE_BIT);
}

GlCraterTable::~GlCraterTable() = default;

void GlCraterTable::forgetRecords() {
  sent_count_ = inserted_count_ = 0;
  built_count_ = 0;
  bucket_count_ = 0;
}

Status GlCraterTable::compile() {
  try {
    if (programs_ == nullptr) programs_ = std::make_unique<Programs>();
  } catch (const std::runtime_error& error) {
    return Error{error.what()};
  }
  return {};
}

Status GlCraterTable::update(const CraterSet& craters, std::int32_t cell_q) {
  Status status = bringTo(craters, cell_q);
  if (!status) forgetRecords();
  return status;
}

Status GlCraterTable::bringTo(const CraterSet& craters, std::int32_t cell_q) {
  const CraterTable& table = craters.table();
  if (craters.size() < sent_count_) forgetRecords();
  if (craters.size() == 0) return sendHead(kNone), glStatus("sending craters");
  // Of sets with the same first records those that were built with as many are laid out alike.
  const bool laid_out = table.built_count == built_count_ && std::int64_t(table.used.size()) == bucket_count_;
  if (craters.size() == inserted_count_ && laid_out) return {};
  if (Status status = compile(); !status) return status;
  if (Status status = sendShapes(craters.records().subspan(sent_count_)); !status) return status;
  sendHead({table.side_q, table.width_q, table.height_q, table.mask(), int(craters.size()), cell_q, {}});
  if (!laid_out)
    if (Status status = layOut(table); !status) return status;
  insert(table, craters.records().subspan(inserted_count_));
  inserted_count_ = craters.size();
  return glStatus("building the craters' hash");
}

Status GlCraterTable::sendShapes(std::span<const Crater> craters) {
  constexpr std::size_t kAtOnce = 1 << 16;
  constexpr auto kBytes = std::int64_t(sizeof(rules::CraterShape));
  if (Status status = shapes_.reserve(std::int64_t(sent_count_ + craters.size()) * kBytes); !status) return status;
  std::vector<rules::CraterShape> shapes;
  for (; !craters.empty(); craters = craters.subspan(shapes.size())) {
    shapes.clear();
    for (const Crater& crater : craters.first(std::min(craters.size(), kAtOnce))) shapes.push_back(shapeOf(crater));
    const std::int64_t bytes = std::int64_t(shapes.size()) * kBytes;
    glNamedBufferSubData(shapes_.name(), std::int64_t(sent_count_) * kBytes, bytes, shapes.data());
    sent_count_ += shapes.size();
    copied_bytes_ += bytes;
  }
  return {};
}

void GlCraterTable::sendHead(const rules::CraterHead& head) {
  glNamedBufferSubData(head_.name(), 0, sizeof head, &head);
  copied_bytes_ += std::int64_t(sizeof head);
}

/// Counting and a prefix sum: empty buckets, with room for the records that set the host's layout and half as many.
Status GlCraterTable::layOut(const CraterTable& table) {
  const auto buckets = std::int64_t(table.used.size());
  const std::int64_t lanes = (buckets + rules::kCraterLaneBuckets - 1) / rules::kCraterLaneBuckets;
  const auto bytes = [](std::int64_t count) { return count * std::int64_t(sizeof(std::int32_t)); };
  const auto entries_bytes = std::int64_t(table.entries.size() * sizeof(rules::CraterEntry));
  const std::pair<GrowingBuffer*, std::int64_t> needs[] = {
      {&first_, bytes(buckets)}, {&used_, bytes(buckets)}, {&heads_, bytes(buckets)},
      {&starts_, bytes(lanes)},  {&nodes_, kNodesBytes},   {&entries_, entries_bytes},
  };
  for (const auto& [buffer, need] : needs)
    if (Status status = buffer->reserve(need); !status) return status;
  bind(0);
  starts_.bind(rules::kBindCraterStarts);
  heads_.bind(rules::kBindCraterHeads);
  nodes_.bind(rules::kBindCraterNodes);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);  // shaders wrote there
  clear(used_, bytes(buckets));
  clear(entries_, entries_bytes);
  clear(nodes_, bytes(1));
  dispatch(programs_->count.name(), table.built_count, 0, int(table.built_count), kGroup);
  dispatch(programs_->sums.name(), lanes, 0, 0, kGroup);
  dispatch(programs_->scan.name(), 1, 0, int(lanes), rules::kCraterScanLanes);
  dispatch(programs_->first.name(), lanes, 0, 0, kGroup);
  inserted_count_ = 0;
  built_count_ = table.built_count;
  bucket_count_ = buckets;
  return {};
}

/// Each record to its places, so many at once that no list grows long.
void GlCraterTable::insert(const CraterTable& table, std::span<const Crater> craters) {
  bind(0);
  heads_.bind(rules::kBindCraterHeads);
  nodes_.bind(rules::kBindCraterNodes);
  const auto at = [&](std::size_t i) { return int(inserted_count_ + i); };
  for (std::size_t first = 0, end = 0; first < craters.size(); first = end) {
    int nodes = 0;
    for (int more = 0; end < craters.size(); ++end, nodes += more) {
      more = cellsOf(table, craters[end]);
      if (nodes + more > rules::kCraterNodesAtOnce) break;
    }
    SPOOR_ASSERT(end > first);
    dispatch(programs_->list.name(), std::int64_t(end - first), at(first), at(end), kGroup);
    if (nodes == 0) continue;
    dispatch(programs_->place.name(), nodes, 0, nodes, kGroup);
    dispatch(programs_->settle.name(), nodes, 0, nodes, kGroup);
  }
}

void GlCraterTable::dispatch(GLuint program, std::int64_t lanes, int first, int end, int group) {
  const std::int64_t groups = (lanes + group - 1) / group;
  const std::int64_t columns = std::min<std::int64_t>(groups, rules::kCraterGroupsPerRow);
  glUseProgram(program);
  glUniform1i(0, first);
  glUniform1i(1, end);
  glDispatchCompute(GLuint(columns), GLuint((groups + columns - 1) / columns), 1);
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  ++dispatch_count_;
}

void GlCraterTable::bind(int first_binding) const {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, GLuint(first_binding), head_.name());
  int binding = first_binding;
  for (const GrowingBuffer* buffer : {&shapes_, &first_, &used_, &entries_}) buffer->bind(++binding);
}

void GlCraterTable::forget() {
  forgetRecords();
  sendHead(kNone);
}

std::int64_t GlCraterTable::deviceBytes() const {
  std::int64_t bytes = sizeof(rules::CraterHead);
  for (const GrowingBuffer* buffer : {&shapes_, &first_, &used_, &entries_, &starts_, &heads_, &nodes_})
    bytes += buffer->bytes();
  return bytes;
}

}  // namespace spoor
