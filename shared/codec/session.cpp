#include "shared/codec/session.h"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

#include "shared/base/bytes.h"
#include "shared/base/hash.h"
#include "shared/world/pose_bytes.h"

namespace spoor {
namespace {

constexpr std::uint32_t kMagic = 0x53525053;  // "SPRS"
constexpr std::uint32_t kVersion = 4;
constexpr std::uint8_t kPackRecord = 1;
constexpr std::uint8_t kTickRecord = 2;

std::vector<std::uint8_t> recordBytes(std::uint8_t kind, std::span<const std::uint8_t> payload) {
  ByteWriter writer;
  writer.put(std::uint32_t(payload.size()));
  writer.put(kind);
  writer.putBytes(payload);
  writer.put(hashBytes(payload, kind));
  return std::move(writer.bytes);
}

template <typename LedgerType, typename Visit>
void visitLedger(LedgerType& ledger, Visit visit) {
  for (auto* value : {&ledger.initial, &ledger.ground, &ledger.compacted, &ledger.craters, &ledger.events})
    visit(*value);
}

std::vector<std::uint8_t> tickBytes(const TickRecord& record) {
  ByteWriter writer;
  writer.put(record.tick);
  writer.put(record.state_hash);
  visitLedger(record.ledger, [&](auto value) { writer.put(value); });
  writer.put(std::uint32_t(record.poses.size()));
  for (const Pose& pose : record.poses) putPose(writer, pose);
  writer.put(std::uint32_t(record.craters.size()));
  for (const Crater& crater : record.craters) putCrater(writer, crater);
  writer.put(std::uint32_t(record.snowfalls.size()));
  for (const Snowfall& snowfall : record.snowfalls) putSnowfall(writer, snowfall);
  if (record.parameters) putParameters(writer, *record.parameters);
  return recordBytes(kTickRecord, writer.bytes);
}

class FileWriter final : public SessionWriter {
 public:
  FileWriter(std::ofstream file, std::string path)
      : file_(std::move(file)), path_(std::move(path)), thread_([this] { serve(); }) {}
  ~FileWriter() override { stop(); }

  void append(TickRecord record) override {
    {
      const std::lock_guard lock(mutex_);
      queue_.push_back(std::move(record));
    }
    wake_.notify_one();
  }

  Status close() override {
    stop();
    if (!file_.is_open()) return {};
    file_.close();
    if (file_.fail()) return Error{"session file " + path_ + ": not everything could be written"};
    return {};
  }

 private:
  void stop() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    wake_.notify_one();
    if (thread_.joinable()) thread_.join();
  }

  void serve() {
    for (;;) {
      std::deque<TickRecord> batch;
      {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, [this] { return stopping_ || !queue_.empty(); });
        if (queue_.empty()) return;
        batch.swap(queue_);
      }
      for (const TickRecord& record : batch) {
        const auto bytes = tickBytes(record);
        file_.write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
      }
      file_.flush();
    }
  }

  std::ofstream file_;
  std::string path_;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<TickRecord> queue_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace

Result<std::unique_ptr<SessionWriter>> SessionWriter::create(const std::string& path,
                                                             std::span<const std::uint8_t> encoded_pack) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  ByteWriter header;
  header.put(kMagic);
  header.put(kVersion);
  header.putBytes(recordBytes(kPackRecord, encoded_pack));
  file.write(reinterpret_cast<const char*>(header.bytes.data()), std::streamsize(header.bytes.size()));
  file.flush();
  if (!file) return Error{"session file " + path + ": cannot be written"};
  return std::unique_ptr<SessionWriter>(std::make_unique<FileWriter>(std::move(file), path));
}

Result<std::unique_ptr<SessionReader>> SessionReader::open(const std::string& path) {
  auto reader = std::make_unique<SessionReader>();
  reader->path_ = path;
  reader->file_.open(path, std::ios::binary);
  if (!reader->file_) return Error{path + ": cannot be opened"};
  std::uint32_t header[2] = {};
  reader->file_.read(reinterpret_cast<char*>(header), sizeof header);
  if (!reader->file_ || header[0] != kMagic) return Error{path + ": not a Spoor session file"};
  if (header[1] != kVersion)
    return Error{path + ": session format " + std::to_string(header[1]) + ", this program reads " +
                 std::to_string(kVersion)};
  reader->position_ = sizeof header;
  auto record = reader->nextRecord();
  if (!record) return Error{record.error()};
  if (!*record || (*record)->kind != kPackRecord) return Error{path + ": does not begin with a whole pack"};
  auto pack = decodePack((*record)->payload);
  if (!pack) return Error{path + ": " + pack.error()};
  reader->id_ = packId((*record)->payload);
  reader->pack_ = std::move(*pack);
  reader->snowfall_count_ = reader->pack_.snowfalls.size();
  return reader;
}

Result<std::optional<SessionReader::Record>> SessionReader::nextRecord() {
  const std::string where = path_ + ", byte " + std::to_string(position_) + ": ";
  const auto cutOff = [this] {
    truncated_ = true;
    return std::optional<Record>();
  };
  const auto read = [this](void* to, std::size_t count) {
    file_.read(static_cast<char*>(to), std::streamsize(count));
    return std::size_t(file_.gcount());
  };
  std::uint32_t size = 0;
  const std::size_t got = read(&size, sizeof size);
  if (got == 0) return std::optional<Record>();
  if (got < sizeof size) return cutOff();
  if (size > kPackBytesLimit) return Error{where + "record of " + std::to_string(size) + " bytes is over the limit"};
  Record record;
  if (read(&record.kind, 1) < 1) return cutOff();
  // In pieces, so that a lying size costs no more memory than the file has bytes.
  while (record.payload.size() < size) {
    const std::size_t at = record.payload.size();
    const std::size_t piece = std::min<std::size_t>(size - at, 1 << 20);
    record.payload.resize(at + piece);
    if (read(record.payload.data() + at, piece) < piece) return cutOff();
  }
  std::uint64_t hash = 0;
  if (read(&hash, sizeof hash) < sizeof hash) return cutOff();
  if (hash != hashBytes(record.payload, record.kind)) return Error{where + "record is damaged (its hash differs)"};
  position_ += std::int64_t(sizeof size + 1 + size + sizeof hash);
  return std::optional<Record>(std::move(record));
}

Result<std::optional<TickRecord>> SessionReader::next() {
  const std::string where = path_ + ", byte " + std::to_string(position_) + ": ";
  auto record = nextRecord();
  if (!record) return Error{record.error()};
  if (!*record) return std::optional<TickRecord>();
  if ((*record)->kind != kTickRecord) return Error{where + "unknown kind of record"};
  ByteReader reader((*record)->payload);
  TickRecord tick;
  tick.tick = reader.get<std::int32_t>();
  tick.state_hash = reader.get<std::uint64_t>();
  visitLedger(tick.ledger, [&](auto& value) { value = reader.get<std::int64_t>(); });
  const std::size_t count = reader.get<std::uint32_t>();
  const std::size_t pose_bytes = pack_.bodies.size() * kPoseBytes;
  if (count != pack_.bodies.size() || reader.left() < pose_bytes)
    return Error{where + "tick record does not fit the pack's bodies"};
  for (std::size_t i = 0; i < count; ++i) tick.poses.push_back(getPose(reader));
  const std::size_t crater_count = reader.get<std::uint32_t>();
  if (crater_count > reader.left() / kCraterBytes) return Error{where + "tick record is of a wrong size"};
  for (std::size_t i = 0; i < crater_count; ++i) tick.craters.push_back(getCrater(reader));
  const std::size_t snowfall_count = reader.get<std::uint32_t>();
  if (snowfall_count > reader.left() / kSnowfallBytes) return Error{where + "tick record is of a wrong size"};
  for (std::size_t i = 0; i < snowfall_count; ++i) tick.snowfalls.push_back(getSnowfall(reader));
  const std::size_t parameter_bytes = parametersBytes(pack_.materials.size());
  if (reader.failed() || (reader.left() != 0 && reader.left() != parameter_bytes))
    return Error{where + "tick record is of a wrong size"};
  if (Status status = validateNewCraters(pack_, tick.craters, crater_count_); !status)
    return Error{where + status.error()};
  for (const Crater& crater : tick.craters)
    if (crater.tick != tick.tick || crater.id != crater_count_++)
      return Error{where + "a crater of another tick or id"};
  if (Status status = validateNewSnowfalls(pack_, tick.snowfalls, tick.tick, snowfall_count_); !status)
    return Error{where + status.error()};
  snowfall_count_ += snowfall_count;
  if (reader.left() > 0) {
    tick.parameters = getParameters(reader);
    if (Status status = validateParameters(pack_, *tick.parameters); !status) return Error{where + status.error()};
  }
  if (tick.tick != last_tick_ + 1)
    return Error{where + "tick " + std::to_string(tick.tick) + " follows tick " + std::to_string(last_tick_)};
  last_tick_ = tick.tick;
  return std::optional<TickRecord>(std::move(tick));
}

}  // namespace spoor
