#include "peerd/cli/commands/run_command.hpp"

#include "peerd/cli/shell/print.hpp"
#include "peerd/daemon/open/opened_peer.hpp"

namespace peerd {

int run_peer(const PeerOptions& options) {
  const auto peer = OpenedPeer::open(options, [](const std::string& warning) { print_warnings({&warning, 1}); });
  if (!peer) return failed(peer.error());
  const auto code = (*peer)->run();
  return code ? *code : failed(code.error());
}

}  // namespace peerd
