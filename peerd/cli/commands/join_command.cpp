#include "peerd/cli/commands/join_command.hpp"

#include <iostream>
#include <optional>
#include <string_view>

#include <unistd.h>

#include <spdlog/fmt/fmt.h>
#include <nlohmann/json.hpp>

#include "peerd/cli/commands/run_command.hpp"
#include "peerd/cli/shell/print.hpp"
#include "peerd/daemon/join/worlds_here.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/input/secret_line.hpp"
#include "peerd/net/keys/invitation.hpp"

namespace peerd {
namespace {

void say(const LogLine& line) { std::cerr << line.text << '\n'; }

nlohmann::ordered_json json_of(const World& world) {
  nlohmann::ordered_json peers = nlohmann::ordered_json::array();
  for (const discovery::Found& peer : world.peers) {
    peers.push_back({{"id", peer.beacon.peer.value},
                     {"name", peer.beacon.name},
                     {"address", peer.address.to_string()},
                     {"snapshot_port", peer.beacon.snapshot_port}});
  }
  return {{"name", world.name},
          {"session", fmt::format("{:016x}", world.session)},
          {"protocol", world.peers.front().beacon.protocol},
          {"sealed", world.is_sealed()},
          {"peers", peers}};
}

// The invitation that somebody pastes, or a file has. It may be the whole line that peerd invite prints.
Result<std::optional<keys::Invitation>> pasted_invitation() {
  const auto line = read_secret_line(STDIN_FILENO, "what peerd invite has printed: ", "--invite -");
  if (!line) return std::unexpected(line.error());
  std::string_view text = line->view();
  while (text.ends_with(' ') || text.ends_with('\r')) text.remove_suffix(1);
  return keys::read_invitation(text.substr(text.rfind(' ') + 1));
}

// Accepts the invitation of --invite, where there is one.
Result<void> accept_invitation_of(JoinOptions& options) {
  if (options.invitation.empty()) return {};
  const auto invitation = options.invitation == "-"
                              ? pasted_invitation()
                              : Result<std::optional<keys::Invitation>>(keys::read_invitation(options.invitation));
  if (!invitation) return std::unexpected(invitation.error());
  if (!*invitation) {
    return std::unexpected(InputError{"error: --invite: that is no whole invitation of peerd invite", kWrongUse});
  }
  return accept_invitation(**invitation, options.request, say);
}

}  // namespace

int run_ls(const LsOptions& options, std::ostream& out) {
  const auto here = worlds_here(options.transport, from_seconds(options.seconds));
  if (!here) return failed(here.error());
  if (options.json) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const World& world : here->worlds) all.push_back(json_of(world));
    out << json_line({{"worlds", all}, {"asked", here->where}}) << '\n';
    return 0;
  }
  for (const World& world : here->worlds) out << line_of(world);
  if (here->worlds.empty()) {
    out << "no world answers by " << here->where
        << "; --interface NAME and --ipv6 ask elsewhere, and peerd doctor says what may be in the way\n";
  }
  return 0;
}

int run_join(JoinOptions& options) {
  if (const auto accepted = accept_invitation_of(options); !accepted) return failed(accepted.error());
  if (const auto joined = join_world(options.request, options.peer, say); !joined) return failed(joined.error());
  return run_peer(options.peer);
}

}  // namespace peerd
