#include "peerd/net/transport/island_member.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "peerd/net/greeting/read_greeting.hpp"

namespace peerd::net {
namespace {

constexpr RegionId kGreetingRegion{0};
// A relay asks four times a second (relay/island.cpp), and forgets who has not answered for three and a half.
constexpr Duration kReportsApart = std::chrono::milliseconds(900), kRelayForgotten = std::chrono::seconds(5);

}  // namespace

IslandMember::IslandMember(const HostClock& clock, std::unique_ptr<Transport> carrier, const Options& options)
    : clock_(clock),
      carrier_(std::move(carrier)),
      options_(options),
      instance_(AddressNumbers(options.key).instance()),
      strangers_(options.key, {}) {
  assert(carrier_);
}

IslandMember::~IslandMember() {
  const HostTime now = clock_.now();
  if (!has_relay(now)) return;
  report(now, /*leaving=*/true);
  carrier_->flush();
}

bool IslandMember::has_relay(HostTime now) const { return relay_asked_ && now - *relay_asked_ <= kRelayForgotten; }

void IslandMember::on_receive(ReceiveHandler handler) {
  handler_ = std::move(handler);
  carrier_->on_receive([this](const Arrival& arrival) {
    if (arrival.region == kGreetingRegion && looks_like_greeting(arrival.datagram)) return on_greeting(arrival);
    handler_(arrival);
  });
}

std::expected<void, NetError> IslandMember::join(RegionId region) {
  auto joined = carrier_->join(region);
  if (joined && joined_.insert(region).second) report_due_ = true;
  return joined;
}

std::expected<void, NetError> IslandMember::leave(RegionId region) {
  if (joined_.erase(region) > 0) report_due_ = true;
  return carrier_->leave(region);
}

// Several joins and leaves of one step cause one report.
void IslandMember::flush() {
  if (report_due_ && relay_asked_) {  // without a relay no clock is read
    const HostTime now = clock_.now();
    if (has_relay(now)) report(now, /*leaving=*/false);
  }
  carrier_->flush();
}

void IslandMember::on_greeting(const Arrival& arrival) {
  ++greetings_passed_;
  greeting_bytes_ += arrival.datagram.size();
  const auto greeting =
      read_greeting(arrival.datagram, options_.v4, options_.seal.get(), arrival.at, arrival.from, strangers_, own_);
  if (!greeting) return;
  ++own_.greetings_in;
  strangers_.has_proven(arrival.from.address(), arrival.at);
  const bool is_relay = greeting->link && !greeting->link->path.empty();
  if (!is_relay || greeting->leaving) return;  // another member's report
  relay_asked_ = arrival.at;
  const HostTime now = clock_.now();
  if (!report_due_ && reported_ && now - *reported_ < kReportsApart) return;
  report(now, /*leaving=*/false);
  carrier_->flush();
}

void IslandMember::report(HostTime now, bool leaving) {
  last_report_ns_ = std::max(now.time_since_epoch().count(), last_report_ns_ + 1);
  Greeting greeting{.instance = instance_, .leaving = leaving};
  if (!leaving) greeting.regions.assign(joined_.begin(), joined_.end());
  greeting.link = LinkNote{.sent_at_ns = last_report_ns_, .group_offset = options_.group_offset};
  const auto bytes = encode(greeting, options_.v4);
  carrier_->send(kGreetingRegion, options_.seal ? options_.seal->seal(bytes) : bytes);
  ++own_.greetings_out;
  reported_ = now;
  report_due_ = false;
}

const TrafficCounters& IslandMember::counters() const {
  counters_ = carrier_->counters();
  counters_.packets_in -= greetings_passed_;
  counters_.bytes_in -= greeting_bytes_;
  counters_.greetings_in = own_.greetings_in;
  counters_.greetings_out = own_.greetings_out;
  counters_.greetings_unopened = own_.greetings_unopened;
  counters_.greetings_flood = own_.greetings_flood;
  counters_.in_malformed += own_.in_malformed;
  return counters_;
}

}  // namespace peerd::net
