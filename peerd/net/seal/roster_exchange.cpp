#include "peerd/net/seal/roster_exchange.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "peerd/net/keys/little_endian.hpp"
#include "peerd/net/seal/announcement.hpp"
#include "peerd/net/seal/nonce_seal.hpp"

namespace peerd::seal {
namespace {

constexpr std::uint8_t kRosterPart = 0xE0, kKindOfPart = 0xE0;
// A part in clear: the first byte, the roster's epoch, the number of the part and of all parts, and its piece.
constexpr std::size_t kMark_bytes = 1, kEpoch_bytes = 4, kCount_bytes = 2,
                      kPartHeader_bytes = kMark_bytes + kEpoch_bytes + 2 * kCount_bytes;
constexpr std::size_t kPartsMax =
    (keys::Roster::kText_bytes + RosterExchange::kPart_bytes - 1) / RosterExchange::kPart_bytes;

std::uint8_t first_of(std::span<const std::byte> datagram) {
  return datagram.empty() ? 0 : std::to_integer<std::uint8_t>(datagram.front());
}

}  // namespace

struct RosterExchange::Part {
  std::uint32_t epoch = 0;
  std::size_t number = 0, count = 0;
  std::string piece;

  [[nodiscard]] std::vector<std::byte> sealed(std::uint8_t first, const keys::SymmetricKey& key) const {
    std::vector<std::uint8_t> text(kPartHeader_bytes);
    text[0] = first;
    keys::put(epoch, std::span(text).subspan(kMark_bytes, kEpoch_bytes));
    keys::put(number, std::span(text).subspan(kMark_bytes + kEpoch_bytes, kCount_bytes));
    keys::put(count, std::span(text).last(kCount_bytes));
    text.insert(text.end(), piece.begin(), piece.end());
    return seal_by_nonce(text, kMark_bytes, key);
  }
  static std::optional<Part> opened(std::span<const std::byte> sealed, const keys::SymmetricKey& key) {
    const auto text = open_by_nonce(sealed, kMark_bytes, key);
    if (!text || text->size() < kPartHeader_bytes) return std::nullopt;
    const std::span header = std::span(*text).first(kPartHeader_bytes);
    return Part{static_cast<std::uint32_t>(keys::get(header.subspan(kMark_bytes, kEpoch_bytes))),
                keys::get(header.subspan(kMark_bytes + kEpoch_bytes, kCount_bytes)),
                keys::get(header.last(kCount_bytes)), std::string(text->begin() + kPartHeader_bytes, text->end())};
  }
};

std::uint8_t epoch_bits(std::uint32_t epoch) { return static_cast<std::uint8_t>(epoch & kEpochBits); }

RosterExchange::RosterExchange(keys::Roster current, const std::vector<keys::Roster>& earlier,
                               const keys::Identity& self)
    : self_(self), current_(std::move(current)), key_(current_.session_key(self_)) {
  for (const keys::Roster& each : earlier) learn(each);
  learn(current_);
}

void RosterExchange::learn(const keys::Roster& roster) {
  if (const auto key = roster.session_key(self_)) {
    epochs_.insert_or_assign(roster.epoch(), Epoch{announcing_key(*key), key->derived("roster", {})});
  }
}

bool RosterExchange::adopt(const keys::Roster& next) {
  if (!current_.is_followed_by(next)) return false;
  const auto key = next.session_key(self_);
  if (!key) {
    refused_epoch_ = std::max(refused_epoch_, next.epoch());
    return false;
  }
  current_ = next;
  key_ = key;
  learn(current_);
  for (auto& [number, epoch] : epochs_) epoch.heard.clear();
  coming_.clear();
  return true;
}

bool RosterExchange::is_part(std::span<const std::byte> datagram) {
  return (first_of(datagram) & kKindOfPart) == kRosterPart;
}

bool RosterExchange::hear(std::span<const std::byte> announcement, HostTime now) {
  for (auto& [number, epoch] : epochs_) {
    if (number == current_.epoch() || (first_of(announcement) & kEpochBits) != epoch_bits(number)) continue;
    const auto opened = OpenedAnnouncement::open(announcement, epoch.announcing);
    if (!opened) continue;
    const Duration apart = current_.has_member(opened->says().key) ? kApart : kApartFormer;
    const bool is_early = epoch.answer_at || (epoch.answered && now < *epoch.answered + apart);
    if (!is_early && opened->is_signed()) {
      epoch.answer_at = now + kTurn * (self_.public_key().bytes().front() % kTurns);
      epoch.heard.clear();
    }
    return true;
  }
  return false;
}

std::optional<HostTime> RosterExchange::next_answer() const {
  std::optional<HostTime> next;
  for (const auto& [number, epoch] : epochs_) {
    if (epoch.answer_at && (!next || *epoch.answer_at < *next)) next = epoch.answer_at;
  }
  return next;
}

std::vector<std::string> RosterExchange::pieces() const {
  std::vector<std::string> pieces;
  for (std::size_t at = 0; at < current_.text().size(); at += kPart_bytes) {
    pieces.push_back(current_.text().substr(at, kPart_bytes));
  }
  return pieces;
}

std::vector<std::vector<std::byte>> RosterExchange::answers(HostTime now) {
  std::vector<std::vector<std::byte>> parts;
  for (auto& [number, epoch] : epochs_) {
    if (!epoch.answer_at || now < *epoch.answer_at) continue;
    epoch.answer_at.reset();
    epoch.answered = now;
    const auto all = pieces();
    for (std::size_t i = 0; i < all.size(); ++i) {
      parts.push_back(
          Part{current_.epoch(), i, all.size(), all[i]}.sealed(kRosterPart | epoch_bits(number), epoch.parts));
    }
  }
  return parts;
}

std::expected<std::optional<keys::Roster>, Refusal> RosterExchange::take(std::span<const std::byte> sealed,
                                                                         HostTime now) {
  for (auto& [number, epoch] : epochs_) {
    if ((first_of(sealed) & kEpochBits) != epoch_bits(number)) continue;
    auto part = Part::opened(sealed, epoch.parts);
    if (!part) continue;
    if (number == current_.epoch()) return add(*std::move(part));
    on_answer_of_another(epoch, *part, now);
    return std::nullopt;
  }
  return std::unexpected(Refusal::kForged);
}

// Only the very roster that this one would send spares it that: a former member may send others.
void RosterExchange::on_answer_of_another(Epoch& epoch, const Part& part, HostTime now) {
  const auto all = pieces();
  if (!epoch.answer_at || part.number >= all.size() || part.piece != all[part.number]) return;
  epoch.heard.insert(part.number);
  if (epoch.heard.size() < all.size()) return;
  epoch.answer_at.reset();
  epoch.answered = now;
}

std::optional<keys::Roster> RosterExchange::add(Part part) {
  const bool is_news = part.epoch > std::max(current_.epoch(), refused_epoch_);
  if (!is_news || part.count > kPartsMax || part.number >= part.count) return std::nullopt;
  if (coming_.size() != part.count || coming_epoch_ != part.epoch) {
    coming_.assign(part.count, {});
    coming_epoch_ = part.epoch;
  }
  coming_[part.number] = std::move(part.piece);
  if (std::ranges::any_of(coming_, &std::string::empty)) return std::nullopt;
  const auto roster = keys::Roster::of_text(std::accumulate(coming_.begin(), coming_.end(), std::string()));
  coming_.clear();
  return roster && current_.is_followed_by(*roster) ? roster : std::nullopt;
}

}  // namespace peerd::seal
