#include "peerd/seal/invitation.hpp"

#include <sodium.h>

#include <vector>

namespace peerd::seal {
namespace {

constexpr std::string_view kInvitationBegin = "peerd-invite-1:";
constexpr int kInvitationVariant = sodium_base64_VARIANT_URLSAFE_NO_PADDING;
constexpr std::size_t kWorldMax_bytes = 255;
// What was cut or changed on the way is noticed: the first bytes of a hash of the rest.
constexpr std::size_t kCheck_bytes = 8;

std::array<std::uint8_t, crypto_generichash_BYTES> hash_of(const std::uint8_t* bytes, std::size_t size) {
  std::array<std::uint8_t, crypto_generichash_BYTES> hash{};
  crypto_generichash(hash.data(), hash.size(), bytes, size, nullptr, 0);
  return hash;
}

}  // namespace

std::string text_of(const Invitation& invitation) {
  need_sodium();
  std::vector<std::uint8_t> bytes(invitation.key.data(), invitation.key.data() + SymmetricKey::kBytes);
  bytes.insert(bytes.end(), invitation.world.begin(), invitation.world.end());
  const auto hash = hash_of(bytes.data(), bytes.size());
  bytes.insert(bytes.end(), hash.begin(), hash.begin() + kCheck_bytes);
  std::string encoded(sodium_base64_ENCODED_LEN(bytes.size(), kInvitationVariant), '\0');
  sodium_bin2base64(encoded.data(), encoded.size(), bytes.data(), bytes.size(), kInvitationVariant);
  encoded.resize(encoded.find('\0'));
  sodium_memzero(bytes.data(), bytes.size());
  return std::string(kInvitationBegin) + encoded;
}

std::optional<Invitation> read_invitation(std::string_view text) {
  need_sodium();
  if (!text.starts_with(kInvitationBegin)) return std::nullopt;
  text.remove_prefix(kInvitationBegin.size());
  std::vector<std::uint8_t> bytes(SymmetricKey::kBytes + kWorldMax_bytes + kCheck_bytes);
  std::size_t size = 0;
  const char* end = nullptr;
  const int failed =
      sodium_base642bin(bytes.data(), bytes.size(), text.data(), text.size(), nullptr, &size, &end, kInvitationVariant);
  if (failed != 0 || end != text.data() + text.size() || size <= SymmetricKey::kBytes + kCheck_bytes)
    return std::nullopt;
  const std::size_t checked = size - kCheck_bytes;
  const auto hash = hash_of(bytes.data(), checked);
  if (sodium_memcmp(hash.data(), bytes.data() + checked, kCheck_bytes) != 0) return std::nullopt;
  std::string world(bytes.begin() + SymmetricKey::kBytes, bytes.begin() + static_cast<std::ptrdiff_t>(checked));
  Invitation invitation{std::move(world), SymmetricKey::of_bytes(std::span(bytes).first<SymmetricKey::kBytes>())};
  sodium_memzero(bytes.data(), bytes.size());
  return invitation;
}

}  // namespace peerd::seal
