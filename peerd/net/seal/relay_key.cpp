#include "peerd/net/seal/relay_key.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "peerd/net/keys/base64.hpp"
#include "peerd/net/keys/secret_file.hpp"
#include "peerd/net/seal/sealed_greetings.hpp"

namespace peerd::seal {
namespace {

constexpr std::string_view kRelayKeyBegin = "peerd-relay-1:";
constexpr int kWrongFile = 2;

}  // namespace

std::string relay_key_text(const keys::SymmetricKey& session) {
  const keys::SymmetricKey key = SealedGreetings::key_of(session);
  return std::string(kRelayKeyBegin) + keys::base64_of(std::span(key.data(), keys::SymmetricKey::kBytes));
}

Result<keys::SymmetricKey> read_relay_key(const std::filesystem::path& file) {
  const auto line = keys::read_private_line(file, "relay key");
  if (!line) return std::unexpected(line.error());
  std::string_view text = line->view();
  std::array<std::uint8_t, keys::SymmetricKey::kBytes> bits{};
  if (text.starts_with(kRelayKeyBegin)) {
    text.remove_prefix(kRelayKeyBegin.size());
    if (keys::read_base64(text, bits) == bits.size()) return keys::SymmetricKey::of_bytes(bits);
  }
  return std::unexpected(
      keys::wrong_secret(file, "relay key", "has no line of peerd invite WORLD --relay", kWrongFile));
}

}  // namespace peerd::seal
