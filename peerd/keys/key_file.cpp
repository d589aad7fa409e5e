#include "peerd/keys/key_file.hpp"

#include <algorithm>
#include <system_error>

#include "peerd/input/user_folder.hpp"
#include "peerd/keys/secret_file.hpp"

namespace peerd::seal {
namespace {

namespace fs = std::filesystem;

SecretFile key_at(const fs::path& file) { return {file, "key"}; }
SecretFile identity_at(const fs::path& file) { return {file, "identity"}; }

bool is_missing(const fs::path& file) {
  std::error_code failed;
  return !fs::exists(file, failed) && !failed;
}

}  // namespace

std::optional<fs::path> default_key_file(const std::string& world) {
  const auto settings = user_folder("XDG_CONFIG_HOME", ".config");
  if (!settings) return std::nullopt;
  std::string name = world;
  std::ranges::replace(name, '/', '_');
  return *settings / "peerd" / "keys" / (name + ".key");
}

Result<fs::path> chosen_key_file(const fs::path& said, const std::string& world) {
  if (!said.empty()) return said;
  if (auto own = default_key_file(world)) return *std::move(own);
  return std::unexpected(InputError{"error: this user has no home for a key: say --key FILE, or --open", 2});
}

Result<SymmetricKey> read_key(const fs::path& file) {
  const auto secret = read_secret(key_at(file));
  if (!secret) return std::unexpected(secret.error());
  const auto key = SymmetricKey::of_text(secret->line());
  if (!key) return std::unexpected(key_at(file).wrong("has no key", 2));
  return *key;
}

Result<SymmetricKey> read_or_make_key(const fs::path& file) {
  if (is_missing(file)) {
    if (const auto made = make_secret(key_at(file), Secret(SymmetricKey::random().text())); !made) {
      return std::unexpected(made.error());
    }
  }
  return read_key(file);
}

Result<void> keep_key(const fs::path& file, const SymmetricKey& key) {
  if (auto made = make_secret(key_at(file), Secret(key.text())); !made) return made;
  const auto kept = read_key(file);
  if (!kept) return std::unexpected(kept.error());
  if (*kept != key) {
    return std::unexpected(key_at(file).wrong(
        "is another one than that of the invitation, of another world of this name; move that file away", 2));
  }
  return {};
}

Result<fs::path> chosen_identity_file(const fs::path& said) {
  if (!said.empty()) return said;
  if (const auto settings = user_folder("XDG_CONFIG_HOME", ".config")) return *settings / "peerd" / "identity.key";
  return std::unexpected(InputError{"error: this user has no home for an identity: say --identity FILE", 2});
}

Result<Identity> read_identity(const fs::path& file) {
  const auto secret = read_secret(identity_at(file));
  if (!secret) return std::unexpected(secret.error());
  const auto identity = Identity::of_text(secret->line());
  if (!identity) return std::unexpected(identity_at(file).wrong("has no identity", 2));
  return *identity;
}

Result<Identity> read_or_make_identity(const fs::path& file) {
  if (is_missing(file)) {
    if (const auto made = make_secret(identity_at(file), Secret(Identity::random().text())); !made) {
      return std::unexpected(made.error());
    }
  }
  return read_identity(file);
}

}  // namespace peerd::seal
