#include "peerd/cli/commands/run_command.hpp"

#include "peerd/cli/shell/print.hpp"
#include "peerd/daemon/open/opened_peer.hpp"
#include "peerd/net/os/service_manager.hpp"

namespace peerd {

int run_peer(PeerOptions options) {
  const auto manager = net::ServiceManager::of_environment();
  for (;;) {
    const auto peer = OpenedPeer::open(options, [](const std::string& warning) { print_warnings({&warning, 1}); });
    if (!peer) return failed(peer.error());
    const auto code = (*peer)->run(manager);
    if (!code) return failed(code.error());
    const auto line = (*peer)->goes_over();
    if (!line) return *code;
    options.store.fresh = true;
    options.store.fresh_line = *line;
    options.take_over = true;  // it has asked
  }
}

}  // namespace peerd
