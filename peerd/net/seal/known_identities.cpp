#include "peerd/net/seal/known_identities.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::seal {
namespace {

// The pause between two searches for identities that were heard for less than kShortLife.
constexpr Duration kDueAfter = std::chrono::seconds(5);

}  // namespace

KnownIdentities::KnownIdentities(PeerId own, const keys::PublicKey& key) {
  known_.emplace(own, Known{key, HostTime{}, HostTime{Duration::max() / 2}});
}

std::optional<keys::PublicKey> KnownIdentities::key_of(PeerId peer) const {
  const auto known = known_.find(peer);
  return known == known_.end() ? std::nullopt : std::optional(known->second.key);
}

bool KnownIdentities::bind(PeerId peer, const keys::PublicKey& key, HostTime now) {
  assert(!known_.contains(peer));
  if (known_.size() >= kMost && !make_room(now)) return false;
  known_.emplace(peer, Known{key, now, now});
  return true;
}

void KnownIdentities::note_heard(PeerId peer, HostTime now) {
  if (const auto known = known_.find(peer); known != known_.end()) known->second.heard = now;
}

void KnownIdentities::forget(PeerId peer) {
  known_.erase(peer);
  forgotten_.push_back(peer);
}

// The quarter that has been silent for the longest time makes room. False: all are heard at present.
bool KnownIdentities::make_room(HostTime now) {
  std::vector<std::pair<HostTime, PeerId>> silent;
  for (const auto& [peer, known] : known_) {
    if (known.heard + kSilent < now) silent.emplace_back(known.heard, peer);
  }
  if (silent.empty()) return false;
  const std::size_t most = std::min(silent.size(), kMost / 4);
  std::ranges::nth_element(silent, silent.begin() + static_cast<std::ptrdiff_t>(most - 1));
  silent.resize(most);
  for (const auto& [heard, peer] : silent) forget(peer);
  return true;
}

std::vector<PeerId> KnownIdentities::take_forgotten(HostTime now) {
  if (now >= due_) {
    due_ = now + kDueAfter;
    std::vector<PeerId> over;
    for (const auto& [peer, known] : known_) {
      if (known.heard - known.since < kShortLife && known.heard + kShortLife < now) over.push_back(peer);
    }
    for (const PeerId peer : over) forget(peer);
  }
  return std::exchange(forgotten_, {});
}

void KnownIdentities::note_boot(PeerId peer, const BootId& boot, std::uint64_t announcements) {
  if (boots_.insert_or_assign({peer, boot}, announcements).second) boots_by_age_.emplace_back(peer, boot);
  for (; boots_by_age_.size() > kForgottenMax; boots_by_age_.pop_front()) boots_.erase(boots_by_age_.front());
}

bool KnownIdentities::is_record(PeerId peer, const BootId& boot, std::uint64_t announcement) const {
  const auto known = boots_.find({peer, boot});
  return known != boots_.end() && announcement <= known->second;
}

}  // namespace peerd::seal
