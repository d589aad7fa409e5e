#include "peerd/net/seal/sealer.hpp"

#include <sodium.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <ranges>

#include "peerd/net/keys/little_endian.hpp"

namespace peerd::seal {
namespace {

using Seconds = std::chrono::seconds;
using Milliseconds = std::chrono::milliseconds;

// Announcements come so often, sooner while a boot that has been heard of is unproven here, and as an answer to who has
// not heard of this one. A boot is named by others until it has been silent for kForgotten.
constexpr Duration kAnnounced = Seconds(1), kAnnouncedSoon = Milliseconds(200), kAnswersApart = Milliseconds(20);
constexpr Duration kForgotten = Seconds(10);
// So long without an announcement, what is not signed is not taken any more: nothing shows whose it is.
constexpr Duration kUnsignedFor = Seconds(5);
// A peer that is new has the time to hear this one's announcements, the next ones of which come soon.
constexpr Duration kHeardWithin = Milliseconds(1750);
// A peer that sends much announces itself sooner, after so many datagrams, so that most of them have a print.
constexpr std::uint64_t kAnnouncedAfter = 128;
// A peer says that it signs each datagram for so long after somebody has spoken in its name, and twice as long each
// time that it happens again. It goes on for a little after it has said that no more, for those who have not heard it
// yet.
constexpr Duration kSignsAllLeast = Seconds(60), kSignsAllMost = std::chrono::hours(1), kSignsOn = Seconds(3);
// Answers before their time: at once, and in the long run.
constexpr net::TokenRate kAnswers{8.0, 4.0};
// Boots that are new, whose signatures are checked, from one address and from all. Where a server lies between,
// addresses are not known, and the limit of all is the only one.
constexpr net::SourceBuckets::Limits kNewcomers{{128.0, 16.0}, {500.0, 200.0}, Duration{0}};
constexpr std::size_t kRefusedBootsMax = 8;

// The first byte: what it is, in two bits that no open datagram, region header or greeting begins with; whether it is
// signed; the epoch.
constexpr std::uint8_t kDatagram = 0x80, kAnnouncement = 0xC0, kKind = 0xC0, kSigned = 0x20;
constexpr std::size_t kTag_bytes = crypto_aead_chacha20poly1305_ietf_ABYTES;
constexpr std::size_t kSender_bytes = 4, kCounter_bytes = 3;
constexpr std::string_view kDatagramUse = "datagram";
static_assert(Sealer::kHeader_bytes == 1 + kSender_bytes + kCounter_bytes);
static_assert(Sealer::kAdded_bytes == Sealer::kHeader_bytes + kTag_bytes && kTag_bytes == kDatagramTag_bytes);

struct Header {
  bool is_signed = false;
  PeerId sender;
  std::uint64_t lowest = 0;  // bytes of the counter
};
// Reads the header of a sealed datagram of this epoch, which is long enough.
Header header_of(std::span<const std::byte> sealed) {
  const auto in = keys::as_octets(sealed);
  return {(in[0] & kSigned) != 0, PeerId{static_cast<std::uint32_t>(keys::get(in.subspan(1, kSender_bytes)))},
          keys::get(in.subspan(1 + kSender_bytes, kCounter_bytes))};
}
Tag tag_of(std::span<const std::byte> sealed) { return keys::as_octets(sealed).last<kTag_bytes>(); }

// The counter with these lowest bytes that is nearest to one that is known.
std::uint64_t counter_near(std::uint64_t known, std::uint64_t lowest) {
  constexpr std::uint64_t kRange = std::uint64_t{1} << (8 * kCounter_bytes);
  const std::uint64_t same = (known & ~(kRange - 1)) | lowest;
  if (same + kRange / 2 < known) return same + kRange;
  if (same > known + kRange / 2 && same >= kRange) return same - kRange;
  return same;
}

}  // namespace

// A Place is what belongs to a datagram besides its bytes; the key has its sender, its boot and its epoch.
struct Sealer::Place {
  std::array<std::uint8_t, crypto_aead_chacha20poly1305_ietf_NPUBBYTES> nonce{};
  std::array<std::uint8_t, Sealer::kHeader_bytes + 4> associated{};

  Place(std::span<const std::byte> sealed, RegionId region, std::uint64_t counter) {
    keys::put(region.value, std::span(nonce).first<4>());
    keys::put(counter, std::span(nonce).last<8>());
    std::ranges::copy(keys::as_octets(sealed).first<Sealer::kHeader_bytes>(), associated.begin());
    keys::put(region.value, std::span(associated).last<4>());
  }
};

Sealer::Sealer(const keys::SymmetricKey& session, Self self, IsMember is_member)
    : session_(session),
      announcing_(announcing_key(session)),
      signing_(session.derived("signatures of datagrams", {})),
      self_(std::move(self)),
      is_member_(std::move(is_member)),
      key_(datagram_key(self_.peer, self_.identity.public_key(), self_.boot)),
      known_(self_.peer, self_.identity.public_key()),
      newcomers_(net::random_key(), kNewcomers),
      answers_(kAnswers),
      newcomers_from_nowhere_(kNewcomers.of_all),
      signs_all_for_(kSignsAllLeast) {
  assert(self_.epoch <= kEpochBits);
}

BootId Sealer::random_boot() {
  keys::need_sodium();
  BootId boot;
  randombytes_buf(boot.data(), boot.size());
  return boot;
}

keys::SymmetricKey Sealer::datagram_key(PeerId sender, const keys::PublicKey& owner, const BootId& boot) const {
  std::vector<std::uint8_t> of(1 + kSender_bytes);
  of[0] = self_.epoch;
  keys::put(sender.value, std::span(of).last<kSender_bytes>());
  of.insert(of.end(), owner.bytes().begin(), owner.bytes().end());
  of.insert(of.end(), boot.begin(), boot.end());
  return session_.derived("datagrams", of);
}

std::vector<std::uint8_t> Sealer::signed_bytes(const BootId& boot, const Place& place,
                                               std::span<const std::byte> datagram) const {
  std::vector<std::uint8_t> all(signing_.data(), signing_.data() + keys::SymmetricKey::kBytes);
  const auto add = [&](std::span<const std::uint8_t> bytes) { all.insert(all.end(), bytes.begin(), bytes.end()); };
  add(boot);
  add(place.associated);
  add(place.nonce);
  add(keys::as_octets(datagram));
  return all;
}

std::span<const std::byte> Sealer::seal(HostTime now, RegionId region, std::span<const std::byte> datagram,
                                        bool is_signed) {
  is_signed = is_signed || now < signs_all_until_ + kSignsOn;
  const std::size_t contents = datagram.size() + (is_signed ? keys::PublicKey::kSignature_bytes : 0);
  sealed_.resize(contents + kAdded_bytes);
  const auto out = keys::as_octets(std::span(sealed_));
  const std::uint64_t counter = sent_.count() + 1;
  out[0] = static_cast<std::uint8_t>(kDatagram | self_.epoch | (is_signed ? kSigned : 0));
  keys::put(self_.peer.value, out.subspan(1, kSender_bytes));
  keys::put(counter, out.subspan(1 + kSender_bytes, kCounter_bytes));
  const Place place(sealed_, region, counter);
  std::ranges::copy(keys::as_octets(datagram), out.begin() + kHeader_bytes);
  if (is_signed) {
    const auto signature = self_.identity.sign(kDatagramUse, signed_bytes(self_.boot, place, datagram));
    std::ranges::copy(signature, out.subspan(kHeader_bytes + datagram.size()).begin());
  }
  crypto_aead_chacha20poly1305_ietf_encrypt(out.data() + kHeader_bytes, nullptr, out.data() + kHeader_bytes, contents,
                                            place.associated.data(), place.associated.size(), nullptr,
                                            place.nonce.data(), key_.data());
  sent_.note(counter, tag_of(sealed_));
  if (announced_ && sent_.since_checkpoint() >= kAnnouncedAfter) {
    announce_at_ = std::min(announce_at_, std::max(now, *announced_ + kAnnouncedSoon));
  }
  return sealed_;
}

// Opens a sealed datagram by one key. False: the key is not that of its sender, or it is damaged.
bool Sealer::decrypt(std::span<const std::byte> sealed, const Place& place, const keys::SymmetricKey& key) {
  opened_.resize(sealed.size() - kAdded_bytes);
  const auto encrypted = keys::as_octets(sealed).subspan(kHeader_bytes);
  return crypto_aead_chacha20poly1305_ietf_decrypt(keys::as_octets(std::span(opened_)).data(), nullptr, nullptr,
                                                   encrypted.data(), encrypted.size(), place.associated.data(),
                                                   place.associated.size(), place.nonce.data(), key.data()) == 0;
}

std::optional<PeerId> Sealer::claimed_sender(std::span<const std::byte> sealed) {
  return sealed.size() < kAdded_bytes ? std::nullopt : std::optional(header_of(sealed).sender);
}

bool Sealer::is_signed(std::span<const std::byte> sealed) {
  return sealed.size() >= kAdded_bytes && header_of(sealed).is_signed;
}

std::expected<Sealer::Opened, Refusal> Sealer::open(HostTime now, RegionId region, std::span<const std::byte> sealed,
                                                    bool may_check) {
  const std::uint8_t first = sealed.empty() ? 0 : std::to_integer<std::uint8_t>(sealed.front());
  if ((first & kKind) != kDatagram) return std::unexpected(Refusal::kOpen);
  if ((first & kEpochBits) != self_.epoch) return std::unexpected(Refusal::kOtherEpoch);
  if (sealed.size() < kAdded_bytes) return std::unexpected(Refusal::kForged);
  const Header header = header_of(sealed);
  bool all_proven = true;
  if (const auto of_sender = boots_.find(header.sender); of_sender != boots_.end()) {
    for (Boot& boot : of_sender->second | std::views::reverse) {
      all_proven = all_proven && boot.is_proven();
      if (!boot.is_proven()) continue;
      const std::uint64_t counter = counter_near(boot.newest, header.lowest);
      const Place place(sealed, region, counter);
      if (!decrypt(sealed, place, boot.key)) continue;
      if (counter < boot.begins || !boot.windows[region].would_take(counter)) {
        return std::unexpected(Refusal::kReplayed);
      }
      if (!header.is_signed && boot.heard + kUnsignedFor < now) return std::unexpected(Refusal::kUnproven);
      if (header.is_signed && !may_check) return std::unexpected(Refusal::kUnchecked);
      if (!is_by_sender(boot, now, place, counter, header.is_signed, tag_of(sealed))) {
        return std::unexpected(Refusal::kUnsigned);
      }
      boot.windows[region].take(counter);
      boot.newest = std::max(boot.newest, counter);
      return Opened{header.sender, opened_, header.is_signed};
    }
  } else {
    all_proven = false;
  }
  if (header.sender == self_.peer) {
    on_own_number(now, region, sealed, header.lowest);
    return std::unexpected(Refusal::kOwn);
  }
  return std::unexpected(all_proven ? Refusal::kForged : Refusal::kUnproven);
}

// Whether opened_ is from the boot's own process, as far as that shows now. It loses its signature.
bool Sealer::is_by_sender(Boot& boot, HostTime now, const Place& place, std::uint64_t counter, bool is_signed,
                          Tag tag) {
  if (is_signed) {
    if (opened_.size() < keys::PublicKey::kSignature_bytes) return false;
    std::array<std::uint8_t, keys::PublicKey::kSignature_bytes> signature{};
    std::ranges::copy(keys::as_octets(std::span(std::as_const(opened_))).last<keys::PublicKey::kSignature_bytes>(),
                      signature.begin());
    opened_.resize(opened_.size() - keys::PublicKey::kSignature_bytes);
    return boot.owner.has_signed(kDatagramUse, signed_bytes(boot.id, place, opened_), signature);
  }
  if (boot.signs_all) return false;
  boot.unsigned_heard.note(numbered(counter, tag), now);
  return true;
}

// A datagram with this peer's number, which its own socket hears, too. What its key opens and it has not sent is by
// somebody who speaks in its name.
void Sealer::on_own_number(HostTime now, RegionId region, std::span<const std::byte> sealed, std::uint64_t lowest) {
  const std::uint64_t counter = counter_near(sent_.count(), lowest);
  if (counter + SentDatagrams::kKept <= sent_.count() || sent_.contains(numbered(counter, tag_of(sealed)))) return;
  if (decrypt(sealed, Place(sealed, region, counter), key_)) on_impersonated(now);
}

void Sealer::on_impersonated(HostTime now) {
  if (signs_all(now)) return;
  findings_.push_back({Finding::Kind::kImpersonated, self_.peer});
  announce_early(now);
  signs_all_until_ = now + signs_all_for_;
  signs_all_for_ = std::min(2 * signs_all_for_, kSignsAllMost);
}

bool Sealer::is_announcement(std::span<const std::byte> datagram) {
  return !datagram.empty() && (std::to_integer<std::uint8_t>(datagram.front()) & ~kEpochBits) == kAnnouncement;
}

// Why an announcement is not taken; none: it is.
std::optional<Refusal> Sealer::refused(const OpenedAnnouncement& announcement, HostTime now,
                                       const boost::asio::ip::address& from, bool may_check) {
  const Announcement& says = announcement.says();
  if (says.boot == self_.boot) return Refusal::kOwn;
  if (given_up_.contains({says.sender, says.boot})) return Refusal::kTooMany;
  const Boot* known = find(says);
  if (known != nullptr && says.number <= known->announcements) return Refusal::kReplayed;
  if (known == nullptr) {
    if (known_.is_record(says.sender, says.boot, says.number)) return Refusal::kReplayed;
    first_heard_.note(says.boot, now);
    if (!has_room(says, now)) return Refusal::kUnproven;
    if (may_check && !may_come(from, now)) return Refusal::kUnproven;
  }
  if (!may_check) return Refusal::kUnchecked;
  if (!announcement.is_signed()) return Refusal::kUnsigned;
  if (is_member_ && !is_member_(says.key)) return refuse(says, Named::kUnknown, now);
  const auto key = known_.key_of(says.sender);
  if (key && *key != says.key) return refuse(says, Named::kTaken, now);
  return std::nullopt;
}

// Whether the signature of one more boot that is new is checked.
bool Sealer::may_come(const boost::asio::ip::address& from, HostTime now) {
  if (from.is_unspecified()) return newcomers_from_nowhere_.take(kNewcomers.of_all, now);
  return newcomers_.admits(from, net::SourceBuckets::Kind::kAnnouncement, now);
}

// The boot is told by the next announcements.
Refusal Sealer::refuse(const Announcement& says, Named::Flag why, HostTime now) {
  const Named name = name_of(says.boot, why);
  std::erase_if(refused_boots_, [&](const RefusedBoot& each) { return each.name == name; });
  if (refused_boots_.size() >= kRefusedBootsMax) refused_boots_.erase(refused_boots_.begin());
  refused_boots_.push_back({name, now});
  return why == Named::kTaken ? Refusal::kImpostor : Refusal::kNoMember;
}

const Sealer::Boot* Sealer::find(const Announcement& says) const {
  const auto of_sender = boots_.find(says.sender);
  if (of_sender == boots_.end()) return nullptr;
  const auto boot = std::ranges::find_if(
      of_sender->second, [&](const Boot& each) { return each.id == says.boot && each.owner == says.key; });
  return boot == of_sender->second.end() ? nullptr : &*boot;
}

// Whether a boot may be kept that is not. Anybody can say recorded announcements once more: they take no room from
// newer ones.
bool Sealer::has_room(const Announcement& says, HostTime now) const {
  const auto of_sender = boots_.find(says.sender);
  if (of_sender == boots_.end() || !first_heard_.is_old(says.boot, now)) return true;
  return std::ranges::count(of_sender->second, false, &Boot::is_proven) < std::ptrdiff_t{kBootsOfPeerMax};
}

// The boot is the last of its sender's from then on.
Sealer::Boot& Sealer::boot_of(const Announcement& says, HostTime now) {
  std::vector<Boot>& of_sender = boots_[says.sender];
  if (const Boot* known = find(says); known != nullptr) {
    const auto boot = of_sender.begin() + (known - of_sender.data());
    std::rotate(boot, boot + 1, of_sender.end());
    return of_sender.back();
  }
  // Anybody can say recorded announcements once more: what these are of never takes the place of a proven boot.
  if (std::ranges::count(of_sender, false, &Boot::is_proven) >= std::ptrdiff_t{kBootsOfPeerMax}) {
    const auto old = std::ranges::find_if(
        of_sender, [&](const Boot& each) { return !each.is_proven() && first_heard_.is_old(each.id, now); });
    of_sender.erase(old != of_sender.end() ? old : std::ranges::find(of_sender, false, &Boot::is_proven));
  }
  of_sender.push_back(
      {.id = says.boot, .owner = says.key, .key = datagram_key(says.sender, says.key, says.boot), .heard = now});
  return of_sender.back();
}

// Proves the boot that was heard of last. False: too many have been given up.
bool Sealer::prove(PeerId sender, HostTime now) {
  std::vector<Boot>& of_sender = boots_[sender];
  if (std::ranges::count(of_sender, true, &Boot::is_proven) >= std::ptrdiff_t{kBootsOfPeerMax}) {
    if (given_up_.size() >= kGivenUpMax) return false;
    const auto oldest = std::ranges::find(of_sender, true, &Boot::is_proven);
    given_up_.emplace(sender, oldest->id);
    of_sender.erase(oldest);
  }
  if (!known_.key_of(sender) && !known_.bind(sender, of_sender.back().owner, now)) return false;
  of_sender.back().flags |= Named::kProven;
  return true;
}

void Sealer::forget_silent(HostTime now) {
  for (const PeerId peer : known_.take_forgotten(now)) {
    const auto boots = boots_.find(peer);
    if (boots == boots_.end()) continue;
    for (const Boot& boot : boots->second) known_.note_boot(peer, boot.id, boot.announcements);
    boots_.erase(boots);
  }
  for (auto& [sender, boots] : boots_) {
    std::erase_if(boots, [&](const Boot& boot) { return !boot.is_proven() && boot.heard + kForgotten < now; });
  }
  std::erase_if(boots_, [](const auto& of_sender) { return of_sender.second.empty(); });
  std::erase_if(refused_boots_, [&](const RefusedBoot& each) { return each.heard + kForgotten < now; });
}

void Sealer::announce_early(HostTime now) {
  if (!announced_) return;
  const HostTime at = std::max(now, *announced_ + kAnswersApart);
  // Announcements that were recorded want answers, too, and these may be longer.
  if (at < announce_at_ && answers_.take(kAnswers, now)) announce_at_ = at;
}

std::optional<Refusal> Sealer::hear(std::span<const std::byte> announcement, HostTime now,
                                    const boost::asio::ip::address& from, bool may_check) {
  assert(is_announcement(announcement));
  const std::uint8_t first = std::to_integer<std::uint8_t>(announcement.front());
  if (first != (kAnnouncement | self_.epoch)) return Refusal::kOtherEpoch;
  const auto opened = OpenedAnnouncement::open(announcement, announcing_);
  if (!opened) return Refusal::kForged;
  if (const auto why = refused(*opened, now, from, may_check)) return why;
  const Announcement& says = opened->says();
  Boot* boot = &boot_of(says, now);
  boot->heard = now;
  boot->announcements = says.number;
  const auto us = std::ranges::find(says.names, name_of(self_.boot).boot, &Named::boot);
  if (us != says.names.end()) {
    if (!boot->is_proven()) {
      boot->begins = says.sent + 1;  // what it sent before may be a record
      if (!prove(says.sender, now)) return Refusal::kTooMany;
      boot = &boots_[says.sender].back();
    }
    on_named(*boot, says, *us, now);
  } else if (says.names.size() < kNamesMax && !boot->unnamed) {
    boot->unnamed = now;
  }
  if (boot->is_proven()) {
    known_.note_heard(says.sender, now);
    check(*boot, says, now);
  }
  const bool wants_answer = !boot->named_us || *boot->named_us + kForgotten < now || !boot->has_proven_us;
  if (wants_answer) announce_early(now);
  return std::nullopt;
}

void Sealer::on_named(Boot& boot, const Announcement& says, const Named& us, HostTime now) {
  boot.newest = std::max(boot.newest, says.sent);
  boot.named_us = now;
  boot.unnamed.reset();
  boot.has_proven_us = (us.flags & Named::kProven) != 0;
  if ((us.flags & Named::kForged) != 0) on_impersonated(now);
  if ((us.flags & Named::kTaken) != 0) findings_.push_back({Finding::Kind::kNumberTaken, says.sender});
  if ((us.flags & Named::kUnknown) != 0) findings_.push_back({Finding::Kind::kNoMember, says.sender});
}

// Looks for what others have sent in the boot's name.
void Sealer::check(Boot& boot, const Announcement& says, HostTime now) {
  if (boot.unsigned_heard.forged(says.checkpoint, says.sent, now) > 0) {
    if (!boot.forged || *boot.forged + kForgotten < now) {
      findings_.push_back({Finding::Kind::kImpersonated, says.sender});
    }
    boot.forged = now;
    announce_early(now);  // its own process may not have heard them
  }
  const bool begins_to = says.signs_all && !boot.signs_all;
  boot.signs_all = says.signs_all;
  if (!begins_to) return;
  // Forged counters may be far ahead. What was not signed until now has come, or is lost.
  boot.begins = says.sent + 1;
  boot.newest = says.sent;
  boot.windows.clear();
  boot.unsigned_heard.clear();
}

std::vector<Named> Sealer::names(HostTime now, bool& all_proven) {
  std::vector<Named> all;
  for (const auto& [sender, boots] : boots_) {
    for (const Boot& boot : boots) {
      if (boot.heard + kForgotten < now) continue;
      const bool is_forged = boot.forged && now < *boot.forged + kForgotten;
      all.push_back(name_of(boot.id, static_cast<std::uint8_t>(boot.flags | (is_forged ? Named::kForged : 0))));
      all_proven = all_proven && boot.is_proven();
    }
  }
  for (const RefusedBoot& each : refused_boots_) all.push_back(each.name);
  if (all.size() <= kNamesMax) return all;
  std::ranges::rotate(all, all.begin() + static_cast<std::ptrdiff_t>(named_ % all.size()));
  named_ += kNamesMax;
  all.resize(kNamesMax);
  return all;
}

std::optional<std::vector<std::byte>> Sealer::announcement_due(HostTime now) {
  if (announced_ && now < announce_at_) return std::nullopt;
  forget_silent(now);
  bool all_proven = true;
  const Announcement says{.sender = self_.peer,
                          .boot = self_.boot,
                          .number = ++announcements_,
                          .sent = sent_.count(),
                          .key = self_.identity.public_key(),
                          .signs_all = signs_all(now),
                          .checkpoint = sent_.checkpoint(),
                          .names = names(now, all_proven)};
  announced_ = now;
  announce_at_ = now + (all_proven ? kAnnounced : kAnnouncedSoon);
  return seal_announcement(says, static_cast<std::uint8_t>(kAnnouncement | self_.epoch), announcing_, self_.identity);
}

std::vector<Sealer::Finding> Sealer::take_findings() { return std::exchange(findings_, {}); }

std::size_t Sealer::proven_count() const {
  std::size_t count = 0;
  for (const auto& [sender, boots] : boots_) {
    count += static_cast<std::size_t>(std::ranges::count_if(boots, &Boot::is_proven));
  }
  return count;
}

std::vector<PeerId> Sealer::deaf_peers(HostTime now) const {
  const auto is_deaf = [&](const Boot& boot) {
    return !boot.is_proven() && boot.unnamed && now - *boot.unnamed >= kHeardWithin && now - boot.heard < kUnsignedFor;
  };
  std::vector<PeerId> deaf;
  for (const auto& [sender, boots] : boots_) {
    if (sender != self_.peer && std::ranges::any_of(boots, is_deaf)) deaf.push_back(sender);
  }
  return deaf;
}

std::size_t Sealer::heard_count() const {
  std::size_t count = 0;
  for (const auto& [sender, boots] : boots_) count += boots.size();
  return count;
}

}  // namespace peerd::seal
