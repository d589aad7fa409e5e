#include "peerd/cli/commands/keygen_command.hpp"

#include "peerd/cli/shell/print.hpp"
#include "peerd/net/keys/key_file.hpp"

namespace peerd {

int run_keygen(const KeygenOptions& options, std::ostream& out) {
  const auto file = keys::chosen_identity_file(options.identity);
  if (!file) return failed(file.error());
  const auto identity = keys::read_or_make_identity(*file);
  if (!identity) return failed(identity.error());
  out << identity->public_key().text() << '\n';
  return 0;
}

}  // namespace peerd
