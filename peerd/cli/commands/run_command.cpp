#include "peerd/cli/commands/run_command.hpp"

#include "peerd/cli/shell/print.hpp"
#include "peerd/daemon/open/opened_peer.hpp"

namespace peerd {

int run_peer(PeerOptions options) {
  for (;;) {
    const auto peer = OpenedPeer::open(options, [](const std::string& warning) { print_warnings({&warning, 1}); });
    if (!peer) return failed(peer.error());
    const auto code = (*peer)->run();
    if (!code) return failed(code.error());
    const auto line = (*peer)->goes_over();
    if (!line) return *code;
    options.store.fresh = true;
    options.store.fresh_line = *line;
    options.take_over = true;  // it has asked
  }
}

}  // namespace peerd
