#include "peerd/seal/invitation.hpp"

#include <sodium.h>

#include <array>
#include <vector>

#include "peerd/seal/base64.hpp"

namespace peerd::seal {
namespace {

constexpr std::size_t kWorldMax_bytes = 255;
// The first bytes of a hash of the rest end it, by which damage is noticed.
constexpr std::size_t kCheck_bytes = 8;

std::array<std::uint8_t, crypto_generichash_BYTES> hash_of(const std::uint8_t* bytes, std::size_t size) {
  std::array<std::uint8_t, crypto_generichash_BYTES> hash{};
  crypto_generichash(hash.data(), hash.size(), bytes, size, nullptr, 0);
  return hash;
}

}  // namespace

std::string text_of(const Invitation& invitation) {
  std::vector<std::uint8_t> bytes(invitation.key.data(), invitation.key.data() + SymmetricKey::kBytes);
  bytes.insert(bytes.end(), invitation.world.begin(), invitation.world.end());
  const auto hash = hash_of(bytes.data(), bytes.size());
  bytes.insert(bytes.end(), hash.begin(), hash.begin() + kCheck_bytes);
  std::string text = std::string(kInvitationBegin) + base64_of(bytes);
  sodium_memzero(bytes.data(), bytes.size());
  return text;
}

std::optional<Invitation> read_invitation(std::string_view text) {
  if (!text.starts_with(kInvitationBegin)) return std::nullopt;
  text.remove_prefix(kInvitationBegin.size());
  std::vector<std::uint8_t> bytes(SymmetricKey::kBytes + kWorldMax_bytes + kCheck_bytes);
  const auto read = read_base64(text, bytes);
  if (!read || *read <= SymmetricKey::kBytes + kCheck_bytes) return std::nullopt;
  const std::size_t checked = *read - kCheck_bytes;
  const auto hash = hash_of(bytes.data(), checked);
  if (sodium_memcmp(hash.data(), bytes.data() + checked, kCheck_bytes) != 0) return std::nullopt;
  std::string world(bytes.begin() + SymmetricKey::kBytes, bytes.begin() + static_cast<std::ptrdiff_t>(checked));
  Invitation invitation{std::move(world), SymmetricKey::of_bytes(std::span(bytes).first<SymmetricKey::kBytes>())};
  sodium_memzero(bytes.data(), bytes.size());
  return invitation;
}

}  // namespace peerd::seal
