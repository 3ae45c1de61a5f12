#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>

#include "protocol/transport.h"
#include "shared/base/result.h"

namespace spoor {

struct EnetServer {
  std::unique_ptr<Transport> transport;
  std::uint16_t port = 0;
};

/// Listens on all addresses. `port` 0: one the system picks. Errors: the port is taken.
Result<EnetServer> listenEnet(std::uint16_t port, std::size_t peers_limit);

struct EnetClient {
  std::unique_ptr<Transport> transport;
  PeerId server = 0;
};

/// Starts to connect; the event `connected` tells when it is done. Errors: an unknown host, no socket.
Result<EnetClient> connectEnet(const std::string& host, std::uint16_t port);

}  // namespace spoor
