#include "peerd/commands/invite_command.hpp"

#include <iostream>

#include "peerd/commands/problems.hpp"
#include "peerd/seal/invitation.hpp"
#include "peerd/seal/key_file.hpp"

namespace peerd {

int run_invite(const InviteOptions& options, std::ostream& out) {
  const auto file = seal::chosen_key_file(options.key, options.world);
  if (!file) return failed(file.error());
  const auto key = seal::read_key(*file);
  if (!key) {
    return failed(InputError{key.error().text + "; a peer of this user makes one when it first runs that world",
                             key.error().exit_code});
  }
  out << "peerd join --invite " << seal::text_of({options.world, *key}) << '\n';
  std::cerr << "That line is as secret as the key: whoever has it is in. Where others use the other computer, too, run "
               "there\n  peerd join --invite -\nand paste it, or say < FILE: then no list of processes and no shell's "
               "history has it.\n";
  return 0;
}

}  // namespace peerd
