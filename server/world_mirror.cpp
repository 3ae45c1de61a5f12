#include "server/world_mirror.h"

namespace spoor {

WorldMirror::WorldMirror(const ScenePack& pack, const PackId& id) : base_(pack), state_(initialState(id, base_)) {
  hashes_.push_back(stateHash(state_));
  poses_ = state_.poses;
}

Status WorldMirror::apply(const TickUpdate& update) {
  last_tick_ = update.tick;
  poses_ = update.poses;
  hashes_.push_back(update.state_hash);
  if (hashes_.size() > kHashesKept) hashes_.pop_front();
  if (broken_) return {};  // said once
  const Status status = applyTick(state_, base_, update);
  if (!status) broken_ = status.error();
  return status;
}

std::optional<std::uint64_t> WorldMirror::hashAt(std::int32_t tick) const {
  const std::int64_t back = std::int64_t(last_tick_) - tick;
  if (back < 0 || back >= std::int64_t(hashes_.size())) return {};
  return hashes_[hashes_.size() - 1 - std::size_t(back)];
}

Result<const BulkPackage*> WorldMirror::snapshot() {
  if (broken_) return Error{"the server cannot make snapshots: " + *broken_};
  if (const auto found = snapshots_.find(last_tick_); found != snapshots_.end()) return &std::as_const(found->second);
  auto raw = encodeSnapshot(state_, base_);
  if (raw.size() > kSnapshotBytesLimit) {
    return Error{"the state is too large to send: " + std::to_string(raw.size()) + " bytes"};
  }
  const auto made = snapshots_.emplace(last_tick_, makeBulkPackage(BulkKind::snapshot, std::move(raw))).first;
  return &std::as_const(made->second);
}

}  // namespace spoor
