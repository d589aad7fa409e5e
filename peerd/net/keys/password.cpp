#include "peerd/net/keys/password.hpp"

#include <sodium.h>
#include <unistd.h>

#include <algorithm>
#include <array>

#include "peerd/input/secret_line.hpp"
#include "peerd/net/keys/secret_file.hpp"

namespace peerd::keys {
namespace {

constexpr std::string_view kSaltOfName = "peerd password 1";
// The limits are a part of what makes the key, so that they are not the library's to change.
constexpr std::size_t kMemory_bytes = std::size_t{256} << 20;
constexpr unsigned long long kPasses = 3;

static_assert(kSaltOfName.size() == crypto_generichash_KEYBYTES_MIN);
static_assert(kMemory_bytes == crypto_pwhash_argon2id_MEMLIMIT_MODERATE);
static_assert(kPasses == crypto_pwhash_argon2id_OPSLIMIT_MODERATE);

const std::uint8_t* password_bytes(std::string_view text) { return reinterpret_cast<const std::uint8_t*>(text.data()); }

// Empty: it may be one.
std::string_view why_no_password(std::string_view text) {
  if (text.size() < kPasswordMin_bytes) return "is shorter than eight bytes";
  // An editor has left another end of the line than the one that was taken off, or it has several lines.
  const auto is_control = [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; };
  if (std::ranges::any_of(text, is_control)) return "has more than one line, or a control character";
  return "";
}

}  // namespace

Result<SecretText> read_password(const std::filesystem::path& file) {
  const bool is_typed = file == "-";
  auto text =
      is_typed ? read_secret_line(STDIN_FILENO, "password: ", "the password") : read_private_line(file, "password");
  if (!text) return text;
  const std::string_view why = why_no_password(text->view());
  if (why.empty()) return text;
  const std::string where = is_typed ? "" : " " + file.string();
  return std::unexpected(InputError{"error: the password" + where + " " + std::string(why), kWrongUse});
}

Result<SymmetricKey> key_of_password(std::string_view password, const std::string& world) {
  need_sodium();
  std::array<std::uint8_t, crypto_pwhash_argon2id_SALTBYTES> salt{};
  crypto_generichash(salt.data(), salt.size(), password_bytes(world), world.size(), password_bytes(kSaltOfName),
                     kSaltOfName.size());
  std::array<std::uint8_t, SymmetricKey::kBytes> bits{};
  const int failed = crypto_pwhash_argon2id(bits.data(), bits.size(), password.data(), password.size(), salt.data(),
                                            kPasses, kMemory_bytes, crypto_pwhash_argon2id_ALG_ARGON2ID13);
  if (failed != 0) {
    return std::unexpected(
        InputError{"error: a password takes 256 MiB of memory for a moment, and there is less", kSystemFailed});
  }
  SymmetricKey key = SymmetricKey::of_bytes(bits);
  sodium_memzero(bits.data(), bits.size());
  return key;
}

}  // namespace peerd::keys
