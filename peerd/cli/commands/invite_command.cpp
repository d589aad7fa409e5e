#include "peerd/cli/commands/invite_command.hpp"

#include <iostream>

#include "peerd/cli/shell/print.hpp"
#include "peerd/daemon/open/roster_file.hpp"
#include "peerd/net/keys/invitation.hpp"
#include "peerd/net/keys/key_file.hpp"
#include "peerd/net/seal/relay_key.hpp"

namespace peerd {

namespace {

// A member's own identity opens the key that the roster has.
int print_relay_key(const keys::Roster& roster, std::ostream& out) {
  const auto file = keys::chosen_identity_file({});
  if (!file) return failed(file.error());
  const auto identity = keys::read_identity(*file);
  if (!identity) return failed(identity.error());
  const auto key = roster.session_key(*identity);
  if (!key) return failed({"error: by the world's roster this user is no member", kWrongUse});
  out << seal::relay_key_text(*key) << '\n';
  return 0;
}

}  // namespace

int run_invite(const InviteOptions& options, std::ostream& out) {
  const auto roster_file = chosen_roster_file({}, options.world);
  if (roster_file && options.key.empty()) {
    const auto roster = read_roster(*roster_file);
    if (!roster) return failed(roster.error());
    if (*roster && options.relay) return print_relay_key(**roster, out);
    if (*roster) {
      out << "peerd join --invite " << keys::text_of(**roster) << '\n';
      return 0;
    }
  }
  const auto file = keys::chosen_key_file(options.key, options.world);
  if (!file) return failed(file.error());
  const auto key = keys::read_key(*file);
  if (!key) {
    return failed(InputError{key.error().text + "; a peer of this user makes one when it first runs that world",
                             key.error().exit_code});
  }
  if (options.relay) {
    out << seal::relay_key_text(*key) << '\n';
    return 0;
  }
  out << "peerd join --invite " << keys::text_of(options.world, *key) << '\n';
  std::cerr << "That line is as secret as the key: whoever has it is in. Where others use the other computer, too, run "
               "there\n  peerd join --invite -\nand paste it, or say < FILE: then no list of processes and no shell's "
               "history has it.\n";
  return 0;
}

}  // namespace peerd
