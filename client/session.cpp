#include "client/session.h"

#include <chrono>
#include <utility>

#include "client/follower.h"
#include "protocol/enet_transport.h"

namespace spoor {
namespace {

std::int64_t nowMs() {
  using namespace std::chrono;
  return duration_cast<milliseconds>(steady_clock::now().time_since_epoch()).count();
}

class EnetSession final : public ClientSession {
 public:
  EnetSession(EnetClient client, FollowerOptions options)
      : transport_(std::move(client.transport)), follower_(*transport_, client.server, std::move(options), nowMs()) {}

  Status update(int wait_ms) override { return follower_.update(nowMs(), wait_ms); }
  bool inSync() const override { return follower_.inSync(); }
  bool ended() const override { return follower_.ended(); }
  const ScenePack& pack() const override { return follower_.pack(); }
  const BaseTerrain& base() const override { return follower_.base(); }
  const WorldState& state() const override { return follower_.state(); }
  int mismatchCount() const override { return follower_.mismatchCount(); }
  std::vector<TileCoordinate> takeChangedTiles() override { return follower_.takeChangedTiles(); }
  std::uint32_t requestCrater(const CraterWish& wish) override { return follower_.requestCrater(wish); }
  std::vector<CraterOutcome> takeCraterOutcomes() override { return follower_.takeCraterOutcomes(); }

 private:
  std::unique_ptr<Transport> transport_;
  Follower follower_;
};

}  // namespace

Result<std::unique_ptr<ClientSession>> ClientSession::start(const ConnectOptions& options) {
  if (options.name.empty() || options.name.size() > kNameLimit || !isPrintable(options.name)) {
    return Error{"client name '" + printableText(options.name, kNameLimit) +
                 "': must be 1 to 64 printable ASCII characters"};
  }
  auto client = connectEnet(options.host, options.port);
  if (!client) return Error{client.error()};
  FollowerOptions follower{options.host + ":" + std::to_string(options.port), options.name,
                           std::int64_t(options.timeout_s * 1000)};
  std::unique_ptr<ClientSession> session = std::make_unique<EnetSession>(std::move(*client), std::move(follower));
  return session;
}

}  // namespace spoor
