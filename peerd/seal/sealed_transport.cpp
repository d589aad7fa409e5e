#include "peerd/seal/sealed_transport.hpp"

#include <cassert>
#include <utility>

namespace peerd::seal {
namespace {

constexpr RegionId kAll{0};
constexpr Duration kWarnedApart = std::chrono::minutes(1);

// What a person should know of a refusal; empty: nothing.
std::string sentence_of(Refusal why) {
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
  if (Sealer::is_announcement(arrival.datagram)) {
    const auto refused = arrival.region == kAll ? sealer_.hear(arrival.datagram, clock_.now()) : Refusal::kForged;
    if (refused) return refuse(*refused, arrival);
    ++refused_.announcements_in;
    return wait();  // it may want an answer
  }
  const auto opened = sealer_.open(arrival.region, arrival.datagram);
  if (!opened) return refuse(opened.error(), arrival);
  handler_({.region = arrival.region, .datagram = *opened, .at = arrival.at, .from = arrival.from});
}

void SealedTransport::refuse(Refusal why, const net::Arrival& arrival) {
  switch (why) {
    case Refusal::kOpen:
      ++refused_.in_open;
      break;
    case Refusal::kOwn:
      ++refused_.in_own;
      break;
    case Refusal::kUnproven:
      ++refused_.in_unproven;
      break;
    case Refusal::kForged:
      ++refused_.in_forged;
      break;
    case Refusal::kReplayed:
      ++refused_.in_replayed;
      break;
    case Refusal::kTooMany:
      ++refused_.in_too_many_boots;
      break;
  }
  const std::string sentence = sentence_of(why);
  if (sentence.empty()) return;
  const auto [at, is_first] = warned_.try_emplace(why, arrival.at);
  if (!is_first && arrival.at - at->second < kWarnedApart) return;
  at->second = arrival.at;
  warn_(arrival.from.address().to_string() + " " + sentence);
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
  counters_ = carrier_->counters();
  counters_.announcements_in = refused_.announcements_in;
  counters_.in_open = refused_.in_open;
  counters_.in_own = refused_.in_own;
  counters_.in_unproven = refused_.in_unproven;
  counters_.in_forged = refused_.in_forged;
  counters_.in_replayed = refused_.in_replayed;
  counters_.in_too_many_boots = refused_.in_too_many_boots;
  counters_.packets_in -= refused_.announcements_in + refused_.in_open + refused_.in_own + refused_.in_unproven +
                          refused_.in_forged + refused_.in_replayed + refused_.in_too_many_boots;
  return counters_;
}

}  // namespace peerd::seal
