#include "peerd/seal/relay_key.hpp"

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "peerd/keys/base64.hpp"
#include "peerd/keys/secret_file.hpp"
#include "peerd/seal/sealed_greetings.hpp"

namespace peerd::seal {
namespace {

constexpr std::string_view kRelayKeyBegin = "peerd-relay-1:";
constexpr int kWrongFile = 2;

}  // namespace

std::string relay_key_text(const SymmetricKey& session) {
  const SymmetricKey key = SealedGreetings::key_of(session);
  return std::string(kRelayKeyBegin) + base64_of(std::span(key.data(), SymmetricKey::kBytes));
}

Result<SymmetricKey> read_relay_key(const std::filesystem::path& file) {
  const auto line = read_private_line(file, "relay key");
  if (!line) return std::unexpected(line.error());
  std::string_view text = line->view();
  std::array<std::uint8_t, SymmetricKey::kBytes> bits{};
  if (text.starts_with(kRelayKeyBegin)) {
    text.remove_prefix(kRelayKeyBegin.size());
    if (read_base64(text, bits) == bits.size()) return SymmetricKey::of_bytes(bits);
  }
  return std::unexpected(wrong_secret(file, "relay key", "has no line of peerd invite WORLD --relay", kWrongFile));
}

}  // namespace peerd::seal
