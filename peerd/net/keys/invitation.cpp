#include "peerd/net/keys/invitation.hpp"

#include <sodium.h>

#include <array>
#include <vector>

#include "peerd/net/keys/base64.hpp"

namespace peerd::keys {
namespace {

constexpr std::string_view kKeyInvitationBegin = "peerd-invite-1:", kRosterInvitationBegin = "peerd-invite-2:";
constexpr std::size_t kWorldMax_bytes = 255;
// The first bytes of a hash of the rest end it, by which damage is noticed.
constexpr std::size_t kCheck_bytes = 8;

std::array<std::uint8_t, crypto_generichash_BYTES> hash_of(const std::uint8_t* bytes, std::size_t size) {
  std::array<std::uint8_t, crypto_generichash_BYTES> hash{};
  crypto_generichash(hash.data(), hash.size(), bytes, size, nullptr, 0);
  return hash;
}

std::optional<Invitation> roster_invitation(std::string_view text) {
  std::vector<std::uint8_t> bytes(Roster::kText_bytes);
  const auto read = read_base64(text, bytes);
  if (!read) return std::nullopt;
  auto roster = Roster::of_text(std::string_view(reinterpret_cast<const char*>(bytes.data()), *read));
  if (!roster) return std::nullopt;
  std::string world = roster->world();
  return Invitation{std::move(world), std::nullopt, std::move(roster)};
}

}  // namespace

std::string text_of(const Roster& roster) {
  const std::string& text = roster.text();
  return std::string(kRosterInvitationBegin) +
         base64_of(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
}

std::string text_of(const std::string& world, const SymmetricKey& key) {
  std::vector<std::uint8_t> bytes(key.data(), key.data() + SymmetricKey::kBytes);
  bytes.insert(bytes.end(), world.begin(), world.end());
  const auto hash = hash_of(bytes.data(), bytes.size());
  bytes.insert(bytes.end(), hash.begin(), hash.begin() + kCheck_bytes);
  std::string text = std::string(kKeyInvitationBegin) + base64_of(bytes);
  sodium_memzero(bytes.data(), bytes.size());
  return text;
}

std::optional<Invitation> read_invitation(std::string_view text) {
  if (text.starts_with(kRosterInvitationBegin)) return roster_invitation(text.substr(kRosterInvitationBegin.size()));
  if (!text.starts_with(kKeyInvitationBegin)) return std::nullopt;
  text.remove_prefix(kKeyInvitationBegin.size());
  std::vector<std::uint8_t> bytes(SymmetricKey::kBytes + kWorldMax_bytes + kCheck_bytes);
  const auto read = read_base64(text, bytes);
  if (!read || *read <= SymmetricKey::kBytes + kCheck_bytes) return std::nullopt;
  const std::size_t checked = *read - kCheck_bytes;
  const auto hash = hash_of(bytes.data(), checked);
  if (sodium_memcmp(hash.data(), bytes.data() + checked, kCheck_bytes) != 0) return std::nullopt;
  std::string world(bytes.begin() + SymmetricKey::kBytes, bytes.begin() + static_cast<std::ptrdiff_t>(checked));
  if (!is_world_name(world)) return std::nullopt;
  Invitation invitation{std::move(world), SymmetricKey::of_bytes(std::span(bytes).first<SymmetricKey::kBytes>()), {}};
  sodium_memzero(bytes.data(), bytes.size());
  return invitation;
}

}  // namespace peerd::keys
