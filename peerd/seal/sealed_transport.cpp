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
    case Refusal::kOwn:
    case Refusal::kUnproven:
    case Refusal::kReplayed:
      return "";
  }
  return "";
}

}  // namespace

SealedTransport::SealedTransport(boost::asio::io_context& io, const net::HostClock& clock,
                                 std::unique_ptr<net::Transport> carrier, const SymmetricKey& session, PeerId self,
                                 Warn warn)
    : clock_(clock),
      carrier_(std::move(carrier)),
      strangers_(random_key(), {}),
      sealer_(session, self, Sealer::random_boot()),
      warn_(std::move(warn)),
      timer_(io) {
  assert(carrier_ && warn_);
}

void SealedTransport::on_receive(ReceiveHandler handler) {
  handler_ = std::move(handler);
  carrier_->on_receive([this](const net::Arrival& arrival) { take(arrival); });
  announce();
}

void SealedTransport::send(RegionId region, std::span<const std::byte> datagram) {
  carrier_->send(region, sealer_.seal(region, datagram));
}

void SealedTransport::take(const net::Arrival& arrival) {
  using Kind = net::SourceBuckets::Kind;
  const bool announces = Sealer::is_announcement(arrival.datagram);
  if (!strangers_.admits(arrival.from.address(), announces ? Kind::kAnnouncement : Kind::kDatagram, arrival.at)) {
    ++flood_;
    return;
  }
  if (announces) {
    const auto refused = arrival.region == kAll ? sealer_.hear(arrival.datagram, clock_.now()) : Refusal::kForged;
    if (refused) return refuse(*refused, arrival);
    ++announcements_in_;
    return wait();  // it may want an answer
  }
  const auto opened = sealer_.open(arrival.region, arrival.datagram);
  if (!opened) return refuse(opened.error(), arrival);
  strangers_.has_proven(arrival.from.address(), arrival.at);
  handler_({.region = arrival.region, .datagram = *opened, .at = arrival.at, .from = arrival.from});
}

void SealedTransport::refuse(Refusal why, const net::Arrival& arrival) {
  ++refused_.at(static_cast<std::size_t>(why));
  const std::string_view sentence = sentence_of(why);
  if (sentence.empty()) return;
  const auto [at, is_first] = warned_.try_emplace(why, arrival.at);
  if (!is_first && arrival.at - at->second < kWarnedApart) return;
  at->second = arrival.at;
  warn_(arrival.from.address().to_string() + " " + std::string(sentence));
}

void SealedTransport::announce() {
  if (const auto announcement = sealer_.announcement_due(clock_.now())) {
    carrier_->send(kAll, *announcement);
    carrier_->flush();
  }
  wait();
}

void SealedTransport::wait() {
  timer_.expires_after(std::max(Duration{0}, sealer_.next_announcement() - clock_.now()));
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
  counters_.in_flood = flood_;
  return counters_;
}

}  // namespace peerd::seal
