#include "peerd/seal/sealed_transport.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>
#include <string_view>
#include <utility>

#include "peerd/transport/transport_options.hpp"

namespace peerd::seal {
namespace {

constexpr RegionId kAll{0};
constexpr Duration kWarnedApart = std::chrono::minutes(1);

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
      return "";
  }
  return "";
}

std::string sentence_of(Sealer::Finding::Kind kind, PeerId peer) {
  const std::string name = "peer " + std::to_string(peer.value);
  switch (kind) {
    case Sealer::Finding::Kind::kImpersonated:
      return "somebody who has the session's key speaks in the name of " + name +
             ", which signs each datagram until that has stopped for a minute";
    case Sealer::Finding::Kind::kNumberTaken:
      return name + " does not hear this peer, whose number it knows as somebody else's; --id says another one";
    case Sealer::Finding::Kind::kNoMember:
      return name + " does not hear this peer: its key is no member's there";
  }
  return "";
}

}  // namespace

SealedTransport::SealedTransport(boost::asio::io_context& io, const net::HostClock& clock,
                                 std::unique_ptr<net::Transport> carrier, const SymmetricKey& session,
                                 Sealer::Self self, Examine examine, Warn warn)
    : clock_(clock),
      carrier_(std::move(carrier)),
      strangers_(random_key(), {}),
      self_(std::move(self)),
      sealer_(session, self_),
      examine_(std::move(examine)),
      warn_(std::move(warn)),
      timer_(io) {
  assert(carrier_ && examine_ && warn_);
}

SealedTransport::SealedTransport(boost::asio::io_context& io, const net::HostClock& clock,
                                 std::unique_ptr<net::Transport> carrier, RosterExchange rosters, Sealer::Self self,
                                 Examine examine, Warn warn)
    : clock_(clock),
      carrier_(std::move(carrier)),
      strangers_(random_key(), {}),
      self_(std::move(self)),
      rosters_(std::move(rosters)),
      sealer_(sealer_of_roster()),
      examine_(std::move(examine)),
      warn_(std::move(warn)),
      timer_(io) {
  assert(carrier_ && examine_ && warn_);
}

// A boot of its own for each epoch: nothing of the one before holds in it.
Sealer SealedTransport::sealer_of_roster() const {
  assert(rosters_ && rosters_->key());
  Sealer::Self self = self_;
  self.boot = Sealer::random_boot();
  self.epoch = epoch_bits(rosters_->current().epoch());
  return {*rosters_->key(), std::move(self),
          [roster = rosters_->current()](const PublicKey& key) { return roster.has_member(key); }};
}

void SealedTransport::adopt(const Roster& roster) {
  assert(rosters_);
  RosterExchange next = *rosters_;
  if (!next.adopt(roster)) return;
  if (!next.key()) {
    return say("no member", clock_.now(),
               "this peer is no member of \"" + roster.world() + "\" any more: it goes on by itself");
  }
  rosters_ = std::move(next);
  sealer_ = sealer_of_roster();
  if (handler_) announce();
}

void SealedTransport::on_receive(ReceiveHandler handler) {
  handler_ = std::move(handler);
  carrier_->on_receive([this](const net::Arrival& arrival) { take(arrival); });
  announce();
}

void SealedTransport::send(RegionId region, std::span<const std::byte> datagram) {
  const auto contents = examine_(datagram);
  assert(contents);
  carrier_->send(region, sealer_.seal(clock_.now(), region, datagram, contents->must_be_signed));
}

void SealedTransport::take_announcement(const net::Arrival& arrival) {
  const auto refused = arrival.region == kAll ? sealer_.hear(arrival.datagram, clock_.now()) : Refusal::kForged;
  say_findings();
  if (!refused) {
    ++announcements_in_;
    return wait();  // it may want an answer
  }
  const auto parts = rosters_ && *refused == Refusal::kOtherEpoch ? rosters_->answer(arrival.datagram, clock_.now())
                                                                  : std::vector<std::vector<std::byte>>{};
  for (const std::vector<std::byte>& part : parts) carrier_->send(kAll, part);
  if (parts.empty()) return refuse(*refused, arrival);
  carrier_->flush();
  ++announcements_in_;
}

void SealedTransport::take(const net::Arrival& arrival) {
  using Kind = net::SourceBuckets::Kind;
  const bool announces = Sealer::is_announcement(arrival.datagram), is_part = RosterExchange::is_part(arrival.datagram);
  const Kind kind = announces || is_part ? Kind::kAnnouncement : Kind::kDatagram;
  if (!strangers_.admits(arrival.from.address(), kind, arrival.at)) {
    ++flood_;
    return;
  }
  if (announces) return take_announcement(arrival);
  if (is_part) {
    if (!rosters_ || !rosters_->opens(arrival.datagram)) return refuse(Refusal::kForged, arrival);
    ++announcements_in_;
    const auto roster = rosters_->take(arrival.datagram);
    if (roster && on_roster_) on_roster_(*roster);
    return;
  }
  const auto opened = sealer_.open(arrival.at, arrival.region, arrival.datagram);
  if (!opened) {
    if (opened.error() == Refusal::kOwn) say_findings();
    return refuse(opened.error(), arrival);
  }
  strangers_.has_proven(arrival.from.address(), arrival.at);
  const auto contents = examine_(opened->datagram);
  if (!contents || contents->sender != opened->sender) return refuse(Refusal::kWrongSender, arrival);
  if (contents->must_be_signed && !opened->is_signed) return refuse(Refusal::kUnsigned, arrival);
  const auto owner = rosters_ && contents->changes_world ? sealer_.key_of(opened->sender) : std::nullopt;
  if (owner && !rosters_->current().may_write(*owner)) return refuse(Refusal::kObserver, arrival);
  handler_({.region = arrival.region, .datagram = opened->datagram, .at = arrival.at, .from = arrival.from});
}

void SealedTransport::refuse(Refusal why, const net::Arrival& arrival) {
  ++refused_.at(static_cast<std::size_t>(why));
  const std::string_view sentence = sentence_of(why);
  if (!sentence.empty()) {
    say(std::to_string(static_cast<int>(why)), arrival.at,
        arrival.from.address().to_string() + " " + std::string(sentence));
  }
}

// Says a line, but not what was said less than a minute ago.
void SealedTransport::say(const std::string& what, HostTime now, std::string_view line) {
  const auto [at, is_first] = warned_.try_emplace(what, now);
  if (!is_first && now - at->second < kWarnedApart) return;
  at->second = now;
  warn_(std::string(line));
}

void SealedTransport::say_findings() {
  for (const auto& [kind, peer] : sealer_.take_findings()) {
    const std::string line = sentence_of(kind, peer);
    say(line, clock_.now(), line);
  }
}

void SealedTransport::announce() {
  if (const auto announcement = sealer_.announcement_due(clock_.now())) {
    carrier_->send(kAll, *announcement);
    carrier_->flush();
  }
  wait();
}

void SealedTransport::flush() {
  carrier_->flush();
  if (handler_ && sealer_.next_announcement() < waits_until_) wait();
}

void SealedTransport::wait() {
  waits_until_ = sealer_.next_announcement();
  timer_.expires_after(std::max(Duration{0}, waits_until_ - clock_.now()));
  timer_.async_wait([this](const boost::system::error_code& cancelled) {
    if (!cancelled) announce();
  });
}

const net::TrafficCounters& SealedTransport::counters() const {
  const auto refused = [&](Refusal why) { return refused_.at(static_cast<std::size_t>(why)); };
  counters_ = carrier_->counters();
  counters_.packets_in -= std::accumulate(refused_.begin(), refused_.end(), announcements_in_ + flood_);
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
