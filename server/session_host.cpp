#include "server/session_host.h"

#include <spdlog/spdlog.h>

#include <atomic>
#include <chrono>
#include <iterator>
#include <mutex>
#include <thread>
#include <utility>

#include "protocol/enet_transport.h"
#include "server/client_book.h"
#include "shared/base/assert.h"

namespace spoor {
namespace {

constexpr int kServeWait_ms = 2;           // a published tick waits this long at most
constexpr std::int64_t kClosing_ms = 500;  // for connections to close in order at the end
constexpr std::size_t kSparePeers = 16;    // so that whoever is refused hears why
constexpr std::size_t kQueueWarning = 1024;

std::int64_t nowMs() {
  using namespace std::chrono;
  return duration_cast<milliseconds>(steady_clock::now().time_since_epoch()).count();
}

class EnetSessionHost final : public SessionHost {
 public:
  EnetSessionHost(EnetServer server, const HostOptions& options, const ScenePack& pack,
                  std::vector<std::uint8_t> encoded_pack)
      : transport_(std::move(server.transport)),
        port_(server.port),
        book_(*transport_, pack, std::move(encoded_pack), BookOptions{.max_clients = options.max_clients}),
        thread_([this] { run(); }) {}

  ~EnetSessionHost() override {
    if (thread_.joinable()) (void)finish(0);
  }
  EnetSessionHost(const EnetSessionHost&) = delete;
  EnetSessionHost& operator=(const EnetSessionHost&) = delete;

  std::uint16_t port() const override { return port_; }

  void publish(TickUpdate update) override {
    const std::lock_guard lock(mutex_);
    queue_.push_back(std::move(update));
  }

  std::vector<CraterOrder> tryTakeCraters() override {
    const std::unique_lock lock(mutex_, std::try_to_lock);
    if (!lock.owns_lock()) return {};
    return std::exchange(orders_, {});
  }

  void answer(std::vector<CraterAnswer> answers) override {
    if (answers.empty()) return;
    const std::lock_guard lock(mutex_);
    answers_.insert(answers_.end(), std::make_move_iterator(answers.begin()), std::make_move_iterator(answers.end()));
  }

  int clientsInSync() const override { return clients_in_sync_; }

  std::vector<ClientReport> finish(double timeout_s) override {
    SPOOR_ASSERT(thread_.joinable());  // once
    {
      const std::lock_guard lock(mutex_);
      finish_timeout_ms_ = std::int64_t(timeout_s * 1000);
      is_finishing_ = true;
    }
    thread_.join();
    return book_.reports();
  }

 private:
  void run();
  /// True once the session is to end with what has been published so far.
  bool publishQueued();
  /// Hands over what the clients ask for.
  void passOrders();

  std::unique_ptr<Transport> transport_;
  std::uint16_t port_;
  ClientBook book_;  // the thread's, until it has been joined
  std::atomic<int> clients_in_sync_ = 0;
  bool has_warned_ = false;

  std::mutex mutex_;
  std::vector<TickUpdate> queue_;
  std::vector<CraterAnswer> answers_;  // of ticks in the queue, or before
  std::vector<CraterOrder> orders_;
  bool is_finishing_ = false;
  std::int64_t finish_timeout_ms_ = 0;

  std::thread thread_;  // last: it uses all of the above
};

bool EnetSessionHost::publishQueued() {
  std::vector<TickUpdate> updates;
  std::vector<CraterAnswer> answers;
  bool is_finishing;
  {
    const std::lock_guard lock(mutex_);
    updates.swap(queue_);
    answers.swap(answers_);
    is_finishing = is_finishing_;
  }
  if (updates.size() > kQueueWarning && !std::exchange(has_warned_, true)) {
    spdlog::warn("sending lags {} ticks behind the session", updates.size());
  }
  for (TickUpdate& update : updates) {
    book_.publish(std::move(update));
    book_.serve(nowMs(), 0);  // a session that runs ahead must not keep the network waiting
    passOrders();
  }
  book_.answer(answers);
  return is_finishing;
}

void EnetSessionHost::passOrders() {
  const std::vector<CraterOrder> orders = book_.takeCraters();
  if (orders.empty()) return;
  const std::lock_guard lock(mutex_);
  orders_.insert(orders_.end(), orders.begin(), orders.end());
}

void EnetSessionHost::run() {
  while (!publishQueued()) {
    book_.serve(nowMs(), kServeWait_ms);
    passOrders();
    clients_in_sync_ = book_.clientsInSync();
  }
  book_.sayGoodbye("the session is over");
  const std::int64_t finish_until_ms =
      nowMs() + finish_timeout_ms_;  // from here: a backlog of ticks is not the clients' time
  while (!book_.allDone() && nowMs() < finish_until_ms) book_.serve(nowMs(), kServeWait_ms);
  book_.letGo();
  const std::int64_t until_ms = nowMs() + kClosing_ms;
  while (book_.isClosing() && nowMs() < until_ms) book_.serve(nowMs(), kServeWait_ms);
  clients_in_sync_ = 0;
  if (transport_->failureCount() > 0) spdlog::warn("{} network failures were ignored", transport_->failureCount());
}

}  // namespace

Result<std::unique_ptr<SessionHost>> SessionHost::open(const HostOptions& options, const ScenePack& pack,
                                                       std::vector<std::uint8_t> encoded_pack) {
  auto server = listenEnet(options.port, std::size_t(options.max_clients) + kSparePeers);
  if (!server) return Error{server.error()};
  std::unique_ptr<SessionHost> host =
      std::make_unique<EnetSessionHost>(std::move(*server), options, pack, std::move(encoded_pack));
  return host;
}

}  // namespace spoor
