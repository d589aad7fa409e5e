#include "peerd/net/seal/sealed_transport.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <string_view>
#include <utility>

#include "peerd/net/greeting/sip_hash.hpp"

namespace peerd::seal {
namespace {

constexpr RegionId kAll{0};
constexpr Duration kWarnedApart = std::chrono::minutes(1);
// Of the datagrams that wait for a check of their signature, kTurns are checked each kTurnsApart.
constexpr Duration kTurnsApart = std::chrono::milliseconds(2);
constexpr std::size_t kTurns = 8;

// Whether a signature was checked before that was found.
bool is_after_check(Refusal why) {
  return why == Refusal::kUnsigned || why == Refusal::kNoMember || why == Refusal::kImpostor;
}

// The predicate of a sentence for people about a datagram's sender; empty: they need not know.
std::string_view sentence_of(Refusal why) {
  switch (why) {
    case Refusal::kOpen:
      return "sends datagrams that are not sealed: it was started with --open, and this peer does not hear it";
    case Refusal::kForged:
      return "sends datagrams that this peer's key does not open: it has another key, or forges";
    case Refusal::kTooMany:
      return "has another start of a peer in whose place so many others came that it is not heard any more";
    case Refusal::kNoMember:
      return "has the session's key, and is no member of it: this peer does not hear it";
    case Refusal::kImpostor:
      return "has the number of a peer of somebody else's: this peer does not hear it";
    case Refusal::kUnsigned:
      return "has the session's key and speaks in another peer's name: this peer does not hear it";
    case Refusal::kWrongSender:
      return "sends datagrams that say another sender than they are sealed by: this peer does not hear them";
    case Refusal::kObserver:
      return "is an observer and would change the world: this peer does not hear that";
    case Refusal::kOwn:
    case Refusal::kUnproven:
    case Refusal::kReplayed:
    case Refusal::kOtherEpoch:
    case Refusal::kUnchecked:
      return "";
  }
  return "";
}

std::string sentence_of(Sealer::Finding::Kind kind, PeerId peer) {
  const std::string name = "peer " + std::to_string(peer.value);
  switch (kind) {
    case Sealer::Finding::Kind::kImpersonated:
      return "somebody who has the session's key speaks in the name of " + name +
             ", which signs each datagram for some time now";
    case Sealer::Finding::Kind::kNumberTaken:
      return name + " does not hear this peer, whose number it knows as somebody else's; --id says another one";
    case Sealer::Finding::Kind::kNoMember:
      return name + " does not hear this peer: its key is no member's there";
  }
  return "";
}

}  // namespace

SealedTransport::SealedTransport(boost::asio::io_context& io, const net::HostClock& clock,
                                 std::unique_ptr<net::Transport> carrier, const keys::SymmetricKey& session,
                                 Sealer::Self self, Examine examine, Warn warn)
    : clock_(clock),
      carrier_(std::move(carrier)),
      strangers_(net::random_key(), {}),
      wrong_(net::random_key()),
      checks_timer_(io),
      self_(std::move(self)),
      sealer_(session, self_),
      examine_(std::move(examine)),
      warn_(std::move(warn)),
      timer_(io) {
  assert(carrier_ && examine_ && warn_);
}

SealedTransport::SealedTransport(boost::asio::io_context& io, const net::HostClock& clock,
                                 std::unique_ptr<net::Transport> carrier, RosterExchange& rosters, OnRoster on_roster,
                                 Sealer::Self self, Examine examine, Warn warn)
    : clock_(clock),
      carrier_(std::move(carrier)),
      strangers_(net::random_key(), {}),
      wrong_(net::random_key()),
      checks_timer_(io),
      self_(std::move(self)),
      rosters_(&rosters),
      on_roster_(std::move(on_roster)),
      sealer_(sealer_of_roster()),
      examine_(std::move(examine)),
      warn_(std::move(warn)),
      timer_(io) {
  assert(carrier_ && on_roster_ && examine_ && warn_);
}

// A boot of its own for each epoch: nothing of the one before holds in it.
Sealer SealedTransport::sealer_of_roster() const {
  assert(rosters_ != nullptr && rosters_->key());
  Sealer::Self self = self_;
  self.boot = Sealer::random_boot();
  self.epoch = epoch_bits(rosters_->current().epoch());
  return {*rosters_->key(), std::move(self),
          [roster = rosters_->current()](const keys::PublicKey& key) { return roster.has_member(key); }};
}

void SealedTransport::follow_roster() {
  sealer_ = sealer_of_roster();
  if (handler_) send_due();
}

void SealedTransport::on_receive(ReceiveHandler handler) {
  handler_ = std::move(handler);
  carrier_->on_receive([this](const net::Arrival& arrival) { take(arrival); });
  send_due();
}

void SealedTransport::send(RegionId region, std::span<const std::byte> datagram) {
  const auto contents = examine_(datagram);
  assert(contents);
  carrier_->send(region, sealer_.seal(clock_.now(), region, datagram, contents->must_be_signed));
}

void SealedTransport::take_announcement(const net::Arrival& arrival, bool may_check) {
  const HostTime now = clock_.now();
  const auto hear = [&](bool checks) {
    return arrival.region == kAll ? sealer_.hear(arrival.datagram, now, arrival.from.address(), checks)
                                  : std::optional(Refusal::kForged);
  };
  auto refused = hear(may_check && !wrong_.are_there(now));
  if (refused == Refusal::kUnchecked) {
    if (wrong_.contains(arrival.datagram, now)) return refuse(Refusal::kUnsigned, arrival);
    if (!may_check) return examine_later(arrival);
    refused = hear(true);
  }
  if (refused == Refusal::kUnsigned) wrong_.note(arrival.datagram, now);
  if (!refused || is_after_check(*refused)) checks_.note_check(clock_.now());
  say_findings();
  if (!refused) {
    ++announcements_in_;
    return wait();  // it may want an answer
  }
  const bool wants_roster =
      rosters_ != nullptr && *refused == Refusal::kOtherEpoch && rosters_->hear(arrival.datagram, clock_.now());
  if (!wants_roster) return refuse(*refused, arrival);
  ++announcements_in_;
  wait();
}

void SealedTransport::take_roster_part(const net::Arrival& arrival) {
  if (rosters_ == nullptr) return refuse(Refusal::kForged, arrival);
  const auto roster = rosters_->take(arrival.datagram, clock_.now());
  if (!roster) return refuse(roster.error(), arrival);
  ++announcements_in_;
  if (*roster) on_roster_(**roster);
}

void SealedTransport::take(const net::Arrival& arrival) {
  using Kind = net::SourceBuckets::Kind;
  const bool announces = Sealer::is_announcement(arrival.datagram), is_part = RosterExchange::is_part(arrival.datagram);
  const Kind kind = announces || is_part ? Kind::kAnnouncement : Kind::kDatagram;
  if (!strangers_.admits(arrival.from.address(), kind, arrival.at)) {
    ++flood_;
    return;
  }
  examine(arrival, checks_.is_free(clock_.now()));
}

void SealedTransport::examine_later(const net::Arrival& arrival) {
  const PeerId sender =
      Sealer::is_announcement(arrival.datagram) ? kNobody : Sealer::claimed_sender(arrival.datagram).value_or(kNobody);
  if (!checks_.push(arrival, sender)) ++flood_;
  if (!awaits_checks_) await_checks();
}

void SealedTransport::await_checks() {
  awaits_checks_ = checks_.size() > 0;
  if (!awaits_checks_) return;
  checks_timer_.expires_after(kTurnsApart);
  checks_timer_.async_wait([this](const boost::system::error_code& cancelled) {
    if (!cancelled) examine_waiting();
  });
}

// A few at a time, so that the peer's own ticks go on between them.
void SealedTransport::examine_waiting() {
  for (std::size_t turn = 0; turn < kTurns; ++turn) {
    const auto next = checks_.next(clock_.now());
    if (!next) break;
    examine({.region = next->region, .datagram = next->datagram, .at = next->at, .from = next->from}, true);
  }
  await_checks();
}

void SealedTransport::examine(const net::Arrival& arrival, bool may_check) {
  if (Sealer::is_announcement(arrival.datagram)) return take_announcement(arrival, may_check);
  if (RosterExchange::is_part(arrival.datagram)) return take_roster_part(arrival);
  const HostTime now = clock_.now();
  const bool is_signed = Sealer::is_signed(arrival.datagram);
  // A datagram whose signature would be checked is first looked up among the wrong ones, if any are remembered.
  const bool is_looked_up = is_signed && wrong_.are_there(now);
  auto opened = sealer_.open(arrival.at, arrival.region, arrival.datagram, may_check && !is_looked_up);
  if (!opened && opened.error() == Refusal::kUnchecked) {
    if (wrong_.contains(arrival.datagram, now)) return refuse(Refusal::kUnsigned, arrival);
    if (!may_check) return examine_later(arrival);
    opened = sealer_.open(arrival.at, arrival.region, arrival.datagram);
  }
  if (!opened && opened.error() == Refusal::kUnsigned && is_signed) wrong_.note(arrival.datagram, now);
  if (opened ? opened->is_signed : is_after_check(opened.error())) checks_.note_check(clock_.now());
  if (!opened) {
    if (opened.error() == Refusal::kOwn) say_findings();
    return refuse(opened.error(), arrival);
  }
  strangers_.has_proven(arrival.from.address(), arrival.at);
  const auto contents = examine_(opened->datagram);
  if (!contents || contents->sender != opened->sender) return refuse(Refusal::kWrongSender, arrival);
  if (contents->must_be_signed && !opened->is_signed) return refuse(Refusal::kUnsigned, arrival);
  const auto owner = rosters_ != nullptr && contents->changes_world ? sealer_.key_of(opened->sender) : std::nullopt;
  if (owner && !rosters_->current().may_write(*owner)) return refuse(Refusal::kObserver, arrival);
  handler_({.region = arrival.region, .datagram = opened->datagram, .at = arrival.at, .from = arrival.from});
}

void SealedTransport::refuse(Refusal why, const net::Arrival& arrival) {
  const auto kind = static_cast<std::size_t>(why);
  ++refused_.at(kind);
  std::optional<HostTime>& said = refusal_said_.at(kind);
  if (said && arrival.at - *said < kWarnedApart) return;
  const std::string_view sentence = sentence_of(why);
  if (sentence.empty()) return;
  said = arrival.at;
  const auto from = arrival.from.address();  // unspecified where a server lies between
  warn_((from.is_unspecified() ? "somebody" : from.to_string()) + " " + std::string(sentence));
}

void SealedTransport::say_findings() {
  for (const auto& [kind, peer] : sealer_.take_findings()) {
    const std::string line = sentence_of(kind, peer);
    const HostTime now = clock_.now();
    const auto [said, is_first] = finding_said_.try_emplace(line, now);
    if (!is_first && now - said->second < kWarnedApart) continue;
    said->second = now;
    warn_(line);
  }
}

void SealedTransport::send_due() {
  const HostTime now = clock_.now();
  const auto announcement = sealer_.announcement_due(now);
  if (announcement) carrier_->send(kAll, *announcement);
  const auto parts = rosters_ == nullptr ? std::vector<std::vector<std::byte>>{} : rosters_->answers(now);
  for (const std::vector<std::byte>& part : parts) carrier_->send(kAll, part);
  if (announcement || !parts.empty()) carrier_->flush();
  wait();
}

void SealedTransport::flush() {
  carrier_->flush();
  if (handler_ && next_due() < waits_until_) wait();
}

HostTime SealedTransport::next_due() const {
  const HostTime announcement = sealer_.next_announcement();
  const auto answer = rosters_ == nullptr ? std::nullopt : rosters_->next_answer();
  return answer ? std::min(announcement, *answer) : announcement;
}

void SealedTransport::wait() {
  waits_until_ = next_due();
  timer_.expires_after(std::max(Duration{0}, waits_until_ - clock_.now()));
  timer_.async_wait([this](const boost::system::error_code& cancelled) {
    if (!cancelled) send_due();
  });
}

const net::TrafficCounters& SealedTransport::counters() const {
  const auto refused = [&](Refusal why) { return refused_.at(static_cast<std::size_t>(why)); };
  counters_ = carrier_->counters();
  counters_.packets_in -=
      std::accumulate(refused_.begin(), refused_.end(), announcements_in_ + flood_ + checks_.size());
  counters_.announcements_in = announcements_in_;
  counters_.in_open = refused(Refusal::kOpen);
  counters_.in_own = refused(Refusal::kOwn);
  counters_.in_unproven = refused(Refusal::kUnproven);
  counters_.in_forged = refused(Refusal::kForged);
  counters_.in_replayed = refused(Refusal::kReplayed);
  counters_.in_too_many_boots = refused(Refusal::kTooMany);
  counters_.in_no_member = refused(Refusal::kNoMember);
  counters_.in_impostor = refused(Refusal::kImpostor);
  counters_.in_unsigned = refused(Refusal::kUnsigned);
  counters_.in_wrong_sender = refused(Refusal::kWrongSender);
  counters_.in_observer = refused(Refusal::kObserver);
  counters_.in_other_epoch = refused(Refusal::kOtherEpoch);
  counters_.in_flood = flood_;
  return counters_;
}

}  // namespace peerd::seal
