#pragma once
#include "peerd/daemon/open/peer_options.hpp"

namespace peerd {

// `peerd run`, and with a capture `peerd record`: runs one peer in the foreground, until SIGTERM or SIGINT.
[[nodiscard]] int run_peer(PeerOptions options);

}  // namespace peerd
