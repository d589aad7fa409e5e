#include "peerd/net/keys/session_key.hpp"

#include "peerd/net/keys/key_file.hpp"
#include "peerd/net/keys/password.hpp"

namespace peerd::keys {
namespace {

Result<SessionKey> key_by_password(const std::filesystem::path& file, const std::string& world) {
  const auto password = read_password(file);
  if (!password) return std::unexpected(password.error());
  const auto key = key_of_password(password->view(), world);
  if (!key) return std::unexpected(key.error());
  return SessionKey{*key, "a password"};
}

}  // namespace

Result<void> check(const KeyChoice& choice) {
  if (choice.key_file.empty() || choice.password_file.empty()) return {};
  return std::unexpected(
      InputError{"error: a session has one key: say a key's file or a password's, not both", kWrongUse});
}

Result<SessionKey> session_key(const KeyChoice& choice, const std::string& world, IfMissing if_missing) {
  if (const auto one = check(choice); !one) return std::unexpected(one.error());
  if (!choice.password_file.empty()) return key_by_password(choice.password_file, world);
  const auto file = chosen_key_file(choice.key_file, world);
  if (!file) return std::unexpected(file.error());
  const bool makes = choice.key_file.empty() && if_missing == IfMissing::kMake;
  const auto key = makes ? read_or_make_key(*file) : read_key(*file);
  if (!key) return std::unexpected(key.error());
  return SessionKey{*key, "the key " + file->string()};
}

}  // namespace peerd::keys
