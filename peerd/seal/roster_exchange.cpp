#include "peerd/seal/roster_exchange.hpp"

#include <sodium.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "peerd/seal/announcement.hpp"
#include "peerd/seal/little_endian.hpp"

namespace peerd::seal {
namespace {

constexpr std::uint8_t kRosterPart = 0xE0, kKindOfPart = 0xE0, kEpochMask = 0x1F;
constexpr std::size_t kPartNonce_bytes = crypto_aead_xchacha20poly1305_ietf_NPUBBYTES;
constexpr std::size_t kPartTag_bytes = crypto_aead_xchacha20poly1305_ietf_ABYTES;
// The contents: the roster's epoch, the number of the part and of all parts, and the part.
constexpr std::size_t kEpoch_bytes = 4, kCount_bytes = 2, kPartHeader_bytes = kEpoch_bytes + 2 * kCount_bytes;
constexpr std::size_t kPartsMax = (Roster::kText_bytes + RosterExchange::kPart_bytes - 1) / RosterExchange::kPart_bytes;

std::vector<std::byte> seal_part(std::span<const std::uint8_t> contents, std::uint8_t first, const SymmetricKey& key) {
  std::vector<std::byte> part(1 + kPartNonce_bytes + contents.size() + kPartTag_bytes);
  const auto out = as_octets(std::span(part));
  out[0] = first;
  randombytes_buf(out.data() + 1, kPartNonce_bytes);
  crypto_aead_xchacha20poly1305_ietf_encrypt(out.data() + 1 + kPartNonce_bytes, nullptr, contents.data(),
                                             contents.size(), out.data(), 1, nullptr, out.data() + 1, key.data());
  return part;
}

std::optional<std::vector<std::uint8_t>> open_part(std::span<const std::byte> part, const SymmetricKey& key) {
  if (part.size() < 1 + kPartNonce_bytes + kPartHeader_bytes + kPartTag_bytes) return std::nullopt;
  const auto in = as_octets(part);
  std::vector<std::uint8_t> contents(part.size() - 1 - kPartNonce_bytes - kPartTag_bytes);
  const int failed = crypto_aead_xchacha20poly1305_ietf_decrypt(
      contents.data(), nullptr, nullptr, in.data() + 1 + kPartNonce_bytes, in.size() - 1 - kPartNonce_bytes, in.data(),
      1, in.data() + 1, key.data());
  return failed == 0 ? std::optional(std::move(contents)) : std::nullopt;
}

}  // namespace

std::uint8_t epoch_bits(std::uint32_t epoch) { return static_cast<std::uint8_t>(epoch & kEpochMask); }

RosterExchange::RosterExchange(Roster current, const std::vector<Roster>& earlier, const Identity& self)
    : self_(self), current_(std::move(current)) {
  for (const Roster& each : earlier) learn(each);
  learn(current_);
  key_ = current_.session_key(self_);
}

void RosterExchange::learn(const Roster& roster) {
  if (const auto key = roster.session_key(self_)) {
    epochs_.insert_or_assign(roster.epoch(), Epoch{announcing_key(*key), key->derived("roster", {})});
  }
}

bool RosterExchange::adopt(const Roster& next) {
  if (!current_.is_followed_by(next)) return false;
  current_ = next;
  learn(current_);
  key_ = current_.session_key(self_);
  coming_.clear();
  return true;
}

bool RosterExchange::is_part(std::span<const std::byte> datagram) {
  return !datagram.empty() && (std::to_integer<std::uint8_t>(datagram.front()) & kKindOfPart) == kRosterPart;
}

std::vector<std::vector<std::byte>> RosterExchange::answer(std::span<const std::byte> announcement, HostTime now) {
  for (auto& [number, epoch] : epochs_) {
    const bool may_be = !announcement.empty() &&
                        (std::to_integer<std::uint8_t>(announcement.front()) & kEpochMask) == epoch_bits(number);
    if (number == current_.epoch() || !may_be || (epoch.answered && now < *epoch.answered + kApart)) continue;
    if (!OpenedAnnouncement::open(announcement, epoch.announcing)) continue;
    epoch.answered = now;
    const std::string& text = current_.text();
    const std::size_t count = (text.size() + kPart_bytes - 1) / kPart_bytes;
    std::vector<std::vector<std::byte>> parts;
    for (std::size_t i = 0; i < count; ++i) {
      const std::string_view part = std::string_view(text).substr(i * kPart_bytes, kPart_bytes);
      std::vector<std::uint8_t> contents(kPartHeader_bytes);
      put(current_.epoch(), std::span(contents).first<kEpoch_bytes>());
      put(i, std::span(contents).subspan<kEpoch_bytes, kCount_bytes>());
      put(count, std::span(contents).last<kCount_bytes>());
      contents.insert(contents.end(), part.begin(), part.end());
      parts.push_back(seal_part(contents, kRosterPart | epoch_bits(number), epoch.parts));
    }
    return parts;
  }
  return {};
}

bool RosterExchange::opens(std::span<const std::byte> part) const {
  const auto own = epochs_.find(current_.epoch());
  return own != epochs_.end() && open_part(part, own->second.parts).has_value();
}

std::optional<Roster> RosterExchange::take(std::span<const std::byte> part) {
  const auto own = epochs_.find(current_.epoch());
  if (own == epochs_.end()) return std::nullopt;
  const auto contents = open_part(part, own->second.parts);
  if (!contents) return std::nullopt;
  const std::span<const std::uint8_t> all(*contents);
  const auto epoch = static_cast<std::uint32_t>(get(all.first<kEpoch_bytes>()));
  const std::size_t number = get(all.subspan<kEpoch_bytes, kCount_bytes>());
  const std::size_t count = get(all.subspan<kEpoch_bytes + kCount_bytes, kCount_bytes>());
  if (epoch <= current_.epoch() || count == 0 || count > kPartsMax || number >= count) return std::nullopt;
  if (coming_.size() != count || coming_epoch_ != epoch) {
    coming_.assign(count, {});
    coming_epoch_ = epoch;
  }
  coming_[number].assign(all.begin() + kPartHeader_bytes, all.end());
  if (std::ranges::any_of(coming_, &std::string::empty)) return std::nullopt;
  const auto roster = Roster::of_text(std::accumulate(coming_.begin(), coming_.end(), std::string()));
  coming_.clear();
  return roster && current_.is_followed_by(*roster) ? roster : std::nullopt;
}

}  // namespace peerd::seal
