#include "peerd/net/keys/key_file.hpp"

#include <algorithm>
#include <system_error>

#include "peerd/input/user_folder.hpp"
#include "peerd/net/keys/secret_file.hpp"

namespace peerd::keys {
namespace {

namespace fs = std::filesystem;

constexpr const char *kKey = "key", *kIdentity = "identity";

bool is_missing(const fs::path& file) {
  std::error_code failed;
  return !fs::exists(file, failed) && !failed;
}

// Two worlds have two names. A "/" can't be in a file's, and stands there as "%2F"; what reads like that in a world's
// name gets another "%25".
std::string file_name_of(const std::string& world) {
  std::string name;
  for (std::size_t i = 0; i < world.size(); ++i) {
    const std::string_view next = std::string_view(world).substr(i + 1, 2);
    const bool is_escape = world[i] == '%' && (next == "2F" || next == "25");
    name += world[i] == '/' ? "%2F" : is_escape ? "%25" : std::string(1, world[i]);
  }
  return name;
}

}  // namespace

std::optional<fs::path> default_key_file(const std::string& world) {
  const auto settings = user_folder("XDG_CONFIG_HOME", ".config");
  if (!settings) return std::nullopt;
  return *settings / "peerd" / "keys" / (file_name_of(world) + ".key");
}

Result<fs::path> chosen_key_file(const fs::path& said, const std::string& world) {
  if (!said.empty()) return said;
  if (auto own = default_key_file(world)) return *std::move(own);
  return std::unexpected(InputError{"error: this user has no home for a key: say --key FILE, or --open", kWrongUse});
}

Result<SymmetricKey> read_key(const fs::path& file) {
  const auto line = read_private_line(file, kKey);
  if (!line) return std::unexpected(line.error());
  const auto key = SymmetricKey::of_text(line->view());
  if (!key) return std::unexpected(wrong_secret(file, kKey, "has no key", 2));
  return *key;
}

Result<SymmetricKey> read_or_make_key(const fs::path& file) {
  if (is_missing(file)) {
    if (const auto made = make_private_line(file, kKey, SymmetricKey::random().text() + "\n"); !made) {
      return std::unexpected(made.error());
    }
  }
  return read_key(file);
}

Result<void> keep_key(const fs::path& file, const SymmetricKey& key) {
  if (auto made = make_private_line(file, kKey, key.text() + "\n"); !made) return made;
  const auto kept = read_key(file);
  if (!kept) return std::unexpected(kept.error());
  if (*kept != key) {
    return std::unexpected(wrong_secret(
        file, kKey, "is another one than that of the invitation, of another world of this name; move that file away",
        2));
  }
  return {};
}

Result<fs::path> chosen_identity_file(const fs::path& said) {
  if (!said.empty()) return said;
  if (const auto settings = user_folder("XDG_CONFIG_HOME", ".config")) return *settings / "peerd" / "identity.key";
  return std::unexpected(InputError{"error: this user has no home for an identity: say --identity FILE", kWrongUse});
}

Result<Identity> read_identity(const fs::path& file) {
  const auto line = read_private_line(file, kIdentity);
  if (!line) return std::unexpected(line.error());
  const auto identity = Identity::of_text(line->view());
  if (!identity) return std::unexpected(wrong_secret(file, kIdentity, "has no identity", 2));
  return *identity;
}

Result<Identity> read_or_make_identity(const fs::path& file) {
  if (is_missing(file)) {
    if (const auto made = make_private_line(file, kIdentity, Identity::random().text() + "\n"); !made) {
      return std::unexpected(made.error());
    }
  }
  return read_identity(file);
}

}  // namespace peerd::keys
