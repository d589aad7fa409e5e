#include "peerd/seal/sealer.hpp"

#include <sodium.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <iterator>
#include <ranges>
#include <utility>

namespace peerd::seal {
namespace {

using Seconds = std::chrono::seconds;
using Milliseconds = std::chrono::milliseconds;

// Announcements come so often, sooner while a boot that has been heard of is unproven here, and as an answer to who has
// not heard of this one. A boot is named by others until it has been silent for kForgotten.
constexpr Duration kAnnounced = Seconds(1), kAnnouncedSoon = Milliseconds(200), kAnswersApart = Milliseconds(20);
constexpr Duration kForgotten = Seconds(10);
// Answers before their time, after a rest and in the long run.
constexpr double kAnswersMost = 8.0, kAnswersPerSecond = 4.0;

// The first byte: what it is, in two bits that no open datagram, region header or greeting begins with, and the epoch.
constexpr std::uint8_t kDatagram = 0x80, kAnnouncement = 0xC0, kKind = 0xC0;
constexpr std::uint8_t kEpoch = 0;
// An announcement names a boot by the first bytes of its id. The last bit of these says whether its sender has proven
// it.
constexpr std::size_t kName_bytes = 8;
constexpr std::uint8_t kProven = 0x80;
using Name = std::array<std::uint8_t, kName_bytes>;
constexpr std::size_t kNonce_bytes = crypto_aead_xchacha20poly1305_ietf_NPUBBYTES;
constexpr std::size_t kTag_bytes = crypto_aead_chacha20poly1305_ietf_ABYTES;
constexpr std::size_t kSender_bytes = 4, kCounter_bytes = 3, kCount_bytes = 8;
constexpr std::size_t kAnnouncementHeader_bytes = 1 + kSender_bytes + kNonce_bytes;
constexpr std::size_t kBoot_bytes = std::tuple_size_v<Sealer::BootId>;
constexpr std::size_t kAnnouncedLeast_bytes = kBoot_bytes + kCount_bytes;
constexpr std::size_t kNamesMax =
    (Sealer::kAnnouncementMax_bytes - kAnnouncementHeader_bytes - kAnnouncedLeast_bytes - kTag_bytes) / kName_bytes;
static_assert(Sealer::kHeader_bytes == 1 + kSender_bytes + kCounter_bytes);
static_assert(Sealer::kAdded_bytes == Sealer::kHeader_bytes + kTag_bytes);
static_assert(kTag_bytes == crypto_aead_xchacha20poly1305_ietf_ABYTES);

std::uint8_t* bytes_of(std::byte* bytes) { return reinterpret_cast<std::uint8_t*>(bytes); }
const std::uint8_t* bytes_of(const std::byte* bytes) { return reinterpret_cast<const std::uint8_t*>(bytes); }

// The lowest bytes of a number, the least significant one first.
void put(std::uint64_t number, std::size_t bytes, std::uint8_t* at) {
  for (std::size_t i = 0; i < bytes; ++i) at[i] = static_cast<std::uint8_t>(number >> (8 * i));
}
std::uint64_t get(const std::uint8_t* at, std::size_t bytes) {
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < bytes; ++i) number |= std::uint64_t{at[i]} << (8 * i);
  return number;
}

bool is_of_kind(std::span<const std::byte> datagram, std::uint8_t kind) {
  return !datagram.empty() && std::to_integer<std::uint8_t>(datagram.front()) == (kind | kEpoch);
}

Name name_of(const Sealer::BootId& boot, bool is_proven) {
  Name name;
  std::copy_n(boot.begin(), kName_bytes, name.begin());
  name.back() = static_cast<std::uint8_t>((name.back() & ~kProven) | (is_proven ? kProven : 0));
  return name;
}

PeerId sender_of(const std::byte* header) {
  return PeerId{static_cast<std::uint32_t>(get(bytes_of(header) + 1, kSender_bytes))};
}

// A Place is what belongs to a datagram besides its bytes; the key has its sender, its boot and its epoch.
struct Place {
  std::array<std::uint8_t, crypto_aead_chacha20poly1305_ietf_NPUBBYTES> nonce{};
  std::array<std::uint8_t, Sealer::kHeader_bytes + 4> associated{};

  Place(const std::byte* header, RegionId region, std::uint64_t counter) {
    put(region.value, 4, nonce.data());
    put(counter, 8, nonce.data() + 4);
    std::memcpy(associated.data(), header, Sealer::kHeader_bytes);
    put(region.value, 4, associated.data() + Sealer::kHeader_bytes);
  }
};

// The counter with these lowest bytes that is nearest to one that is known.
std::uint64_t counter_near(std::uint64_t known, std::uint64_t lowest) {
  constexpr std::uint64_t kRange = std::uint64_t{1} << (8 * kCounter_bytes);
  const std::uint64_t same = (known & ~(kRange - 1)) | lowest;
  if (same + kRange / 2 < known) return same + kRange;
  if (same > known + kRange / 2 && same >= kRange) return same - kRange;
  return same;
}

}  // namespace

Sealer::Sealer(const SymmetricKey& session, PeerId self, const BootId& boot)
    : session_(session),
      announcing_(session.derived("announcement", {})),
      self_(self),
      boot_(boot),
      key_(key_of(self, boot)),
      answers_left_(kAnswersMost) {}

Sealer::BootId Sealer::random_boot() {
  need_sodium();
  BootId boot;
  randombytes_buf(boot.data(), boot.size());
  return boot;
}

SymmetricKey Sealer::key_of(PeerId sender, const BootId& boot) const {
  std::array<std::uint8_t, 1 + kSender_bytes + kBoot_bytes> of{};
  of[0] = kEpoch;
  put(sender.value, kSender_bytes, of.data() + 1);
  std::ranges::copy(boot, of.begin() + 1 + kSender_bytes);
  return session_.derived("datagrams", of);
}

std::span<const std::byte> Sealer::seal(RegionId region, std::span<const std::byte> datagram) {
  sealed_.resize(datagram.size() + kAdded_bytes);
  std::uint8_t* const out = bytes_of(sealed_.data());
  const std::uint64_t counter = ++sent_;
  out[0] = kDatagram | kEpoch;
  put(self_.value, kSender_bytes, out + 1);
  put(counter, kCounter_bytes, out + 1 + kSender_bytes);
  const Place place(sealed_.data(), region, counter);
  crypto_aead_chacha20poly1305_ietf_encrypt(out + kHeader_bytes, nullptr, bytes_of(datagram.data()), datagram.size(),
                                            place.associated.data(), place.associated.size(), nullptr,
                                            place.nonce.data(), key_.data());
  return sealed_;
}

std::expected<std::span<const std::byte>, Refusal> Sealer::open(RegionId region, std::span<const std::byte> sealed) {
  if (!is_of_kind(sealed, kDatagram)) {
    const bool is_of_another_epoch =
        !sealed.empty() && (std::to_integer<std::uint8_t>(sealed.front()) & kKind) == kDatagram;
    return std::unexpected(is_of_another_epoch ? Refusal::kForged : Refusal::kOpen);
  }
  if (sealed.size() < kAdded_bytes) return std::unexpected(Refusal::kForged);
  const PeerId sender = sender_of(sealed.data());
  const auto not_opened = [&](Refusal why) { return std::unexpected(sender == self_ ? Refusal::kOwn : why); };
  const auto of_sender = boots_.find(sender);
  if (of_sender == boots_.end()) return not_opened(Refusal::kUnproven);
  opened_.resize(sealed.size() - kAdded_bytes);
  const std::uint64_t lowest = get(bytes_of(sealed.data()) + 1 + kSender_bytes, kCounter_bytes);
  bool all_proven = true;
  for (Boot& boot : of_sender->second | std::views::reverse) {
    all_proven = all_proven && boot.is_proven;
    if (!boot.is_proven) continue;
    const std::uint64_t counter = counter_near(boot.newest, lowest);
    const Place place(sealed.data(), region, counter);
    const int failed = crypto_aead_chacha20poly1305_ietf_decrypt(
        bytes_of(opened_.data()), nullptr, nullptr, bytes_of(sealed.data()) + kHeader_bytes,
        sealed.size() - kHeader_bytes, place.associated.data(), place.associated.size(), place.nonce.data(),
        boot.key.data());
    if (failed != 0) continue;
    if (counter < boot.begins || !boot.windows[region].take(counter)) return std::unexpected(Refusal::kReplayed);
    boot.newest = std::max(boot.newest, counter);
    return opened_;
  }
  return not_opened(all_proven ? Refusal::kForged : Refusal::kUnproven);
}

bool Sealer::is_announcement(std::span<const std::byte> datagram) {
  return !datagram.empty() && (std::to_integer<std::uint8_t>(datagram.front()) & kKind) == kAnnouncement;
}

// The boot is the last of its sender's from then on. Null: it was given up.
Sealer::Boot* Sealer::boot_of(PeerId sender, const BootId& id, HostTime now) {
  if (given_up_.contains({sender, id})) return nullptr;
  std::vector<Boot>& of_sender = boots_[sender];
  const auto boot = std::ranges::find(of_sender, id, &Boot::id);
  if (boot != of_sender.end()) {
    std::rotate(boot, boot + 1, of_sender.end());
    return &of_sender.back();
  }
  // Anybody can say recorded announcements once more: what these are of never takes the place of a proven boot.
  if (std::ranges::count(of_sender, false, &Boot::is_proven) >= std::ptrdiff_t{kBootsOfPeerMax}) {
    of_sender.erase(std::ranges::find(of_sender, false, &Boot::is_proven));
  }
  of_sender.push_back({.id = id, .key = key_of(sender, id), .heard = now, .windows = {}});
  return &of_sender.back();
}

// Proves the boot that was heard of last. False: too many have been given up.
bool Sealer::prove(PeerId sender) {
  std::vector<Boot>& of_sender = boots_[sender];
  if (std::ranges::count(of_sender, true, &Boot::is_proven) >= std::ptrdiff_t{kBootsOfPeerMax}) {
    if (given_up_.size() >= kGivenUpMax) return false;
    const auto oldest = std::ranges::find(of_sender, true, &Boot::is_proven);
    given_up_.emplace(sender, oldest->id);
    of_sender.erase(oldest);
  }
  of_sender.back().is_proven = true;
  return true;
}

void Sealer::forget_silent(HostTime now) {
  for (auto& [sender, boots] : boots_) {
    std::erase_if(boots, [&](const Boot& boot) { return !boot.is_proven && boot.heard + kForgotten < now; });
  }
  std::erase_if(boots_, [](const auto& of_sender) { return of_sender.second.empty(); });
}

// Announcements that were recorded want answers, too, and these may be longer.
bool Sealer::may_answer(HostTime now) {
  const double since_s = answers_counted_ ? to_seconds(now - *answers_counted_) : 0.0;
  answers_left_ = std::min(kAnswersMost, answers_left_ + since_s * kAnswersPerSecond);
  answers_counted_ = now;
  if (answers_left_ < 1.0) return false;
  answers_left_ -= 1.0;
  return true;
}

std::optional<Refusal> Sealer::hear(std::span<const std::byte> announcement, HostTime now) {
  assert(is_announcement(announcement));
  if (!is_of_kind(announcement, kAnnouncement)) return Refusal::kForged;  // of another epoch
  if (announcement.size() < kAnnouncementHeader_bytes + kAnnouncedLeast_bytes + kTag_bytes ||
      announcement.size() > kAnnouncementMax_bytes) {
    return Refusal::kForged;
  }
  const std::uint8_t* const in = bytes_of(announcement.data());
  const PeerId sender = sender_of(announcement.data());
  const std::size_t sealed_bytes = announcement.size() - kAnnouncementHeader_bytes;
  std::vector<std::uint8_t> said(sealed_bytes - kTag_bytes);
  const int failed = crypto_aead_xchacha20poly1305_ietf_decrypt(
      said.data(), nullptr, nullptr, in + kAnnouncementHeader_bytes, sealed_bytes, in, 1 + kSender_bytes,
      in + 1 + kSender_bytes, announcing_.data());
  if (failed != 0 || (said.size() - kAnnouncedLeast_bytes) % kName_bytes != 0) return Refusal::kForged;
  BootId id;
  std::copy_n(said.begin(), kBoot_bytes, id.begin());
  if (id == boot_) return Refusal::kOwn;
  Boot* boot = boot_of(sender, id, now);
  if (boot == nullptr) return Refusal::kTooMany;
  std::optional<bool> names_us;  // whether as one that it has proven
  for (auto at = said.begin() + kAnnouncedLeast_bytes; at != said.end(); at += kName_bytes) {
    for (const bool as_proven : {false, true}) {
      if (std::ranges::equal(std::span(at, kName_bytes), name_of(boot_, as_proven))) names_us = as_proven;
    }
  }
  boot->heard = now;
  if (names_us) {
    const std::uint64_t sent = get(said.data() + kBoot_bytes, kCount_bytes);
    if (!boot->is_proven) {
      boot->begins = sent + 1;  // what it sent before may be a record
      if (!prove(sender)) return Refusal::kTooMany;
      boot = &boots_[sender].back();
    }
    boot->newest = std::max(boot->newest, sent);
    boot->named_us = now;
    boot->has_proven_us = *names_us;
  }
  const bool wants_answer = !boot->named_us || *boot->named_us + kForgotten < now || !boot->has_proven_us;
  if (!wants_answer || !announced_) return std::nullopt;
  const HostTime answer_at = std::max(now, *announced_ + kAnswersApart);
  if (answer_at < announce_at_ && may_answer(now)) announce_at_ = answer_at;
  return std::nullopt;
}

std::optional<std::vector<std::byte>> Sealer::announcement_due(HostTime now) {
  if (announced_ && now < announce_at_) return std::nullopt;
  forget_silent(now);
  std::vector<const Boot*> heard;
  bool all_proven = true;
  for (const auto& [sender, boots] : boots_) {
    for (const Boot& boot : boots) {
      if (boot.heard + kForgotten < now) continue;
      heard.push_back(&boot);
      all_proven = all_proven && boot.is_proven;
    }
  }
  std::vector<std::uint8_t> says(boot_.begin(), boot_.end());
  says.resize(kAnnouncedLeast_bytes);
  put(sent_, kCount_bytes, says.data() + kBoot_bytes);
  const std::size_t names = std::min(heard.size(), kNamesMax);
  for (std::size_t i = 0; i < names; ++i) {
    const Boot& boot = *heard[(named_ + i) % heard.size()];
    std::ranges::copy(name_of(boot.id, boot.is_proven), std::back_inserter(says));
  }
  if (!heard.empty()) named_ = (named_ + names) % heard.size();
  std::vector<std::byte> announcement(kAnnouncementHeader_bytes + says.size() + kTag_bytes);
  std::uint8_t* const out = bytes_of(announcement.data());
  out[0] = kAnnouncement | kEpoch;
  put(self_.value, kSender_bytes, out + 1);
  randombytes_buf(out + 1 + kSender_bytes, kNonce_bytes);
  crypto_aead_xchacha20poly1305_ietf_encrypt(out + kAnnouncementHeader_bytes, nullptr, says.data(), says.size(), out,
                                             1 + kSender_bytes, nullptr, out + 1 + kSender_bytes, announcing_.data());
  announced_ = now;
  announce_at_ = now + (all_proven ? kAnnounced : kAnnouncedSoon);
  return announcement;
}

std::size_t Sealer::proven_count() const {
  std::size_t count = 0;
  for (const auto& [sender, boots] : boots_) {
    count += static_cast<std::size_t>(std::ranges::count_if(boots, &Boot::is_proven));
  }
  return count;
}

std::size_t Sealer::heard_count() const {
  std::size_t count = 0;
  for (const auto& [sender, boots] : boots_) count += boots.size();
  return count;
}

}  // namespace peerd::seal
