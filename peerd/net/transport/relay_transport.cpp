#include "peerd/net/transport/relay_transport.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "peerd/net/greeting/address_text.hpp"
#include "peerd/net/greeting/read_greeting.hpp"
#include "peerd/net/os/udp_socket.hpp"

namespace peerd::net {
namespace {

using asio::ip::udp;

// In a round all relays of the list are greeted that it is time for, which keeps the flow through a NAT open and finds
// a relay that has failed. After a change some rounds are short, because a greeting may get lost.
constexpr Duration kRelayRound = std::chrono::milliseconds(200), kShortRelayRound = std::chrono::milliseconds(60);
constexpr int kShortRelayRounds = 3, kShortRelayRoundsAtStart = 10;
constexpr std::size_t kRelayedMax_bytes = kMaxDatagramBytes + kRelayHeaderBytes;

}  // namespace

std::expected<std::unique_ptr<RelayTransport>, NetError> RelayTransport::open(asio::io_context& io,
                                                                              const HostClock& clock,
                                                                              const RelayTransportOptions& options) {
  assert(!options.relays.empty());
  std::unique_ptr<RelayTransport> opened(new RelayTransport(io, clock, options));
  udp::socket& socket = opened->receiver_.socket();
  const UdpOptions wanted{options.family == IpFamily::kV4, options.dscp, options.receive_buffer_bytes};
  if (auto good = open_udp(socket, wanted); !good) return std::unexpected(good.error());
  if (auto good = bind_udp(socket, 0, "end a program that uses many"); !good) {
    return std::unexpected(good.error());
  }
  return opened;
}

RelayTransport::RelayTransport(asio::io_context& io, const HostClock& clock, const RelayTransportOptions& options)
    : options_(options),
      reading_(clock, counters_, kRelayedMax_bytes),
      receiver_(io, reading_),
      queue_(kRelayedMax_bytes),
      numbers_(options.key),
      choice_({.relays = options.relays, .self = numbers_.instance()}),
      strangers_(options.key, {}),
      timer_(io),
      hurried_rounds_(kShortRelayRoundsAtStart) {
  numbers_.advance(clock.now());
}

RelayTransport::~RelayTransport() {
  if (!handler_) return;  // no greeting has left yet
  for (RelayChoice::Relay& relay : choice_.relays()) {
    if (relay.number != 0) greet(relay, /*leaving=*/true);
  }
  queue_.flush(receiver_.socket().native_handle(), counters_);
}

int RelayTransport::receive_buffer_bytes() const { return granted_receive_buffer(receiver_.socket()); }

asio::ip::address RelayTransport::own_address() const {
  if (options_.family == IpFamily::kV4) return asio::ip::address_v4::any();
  return asio::ip::address_v6::any();
}

std::string RelayTransport::describe() const {
  std::string relays;
  for (const udp::endpoint& at : options_.relays) relays += (relays.empty() ? "" : ", else ") + address_text(at);
  return "relay " + relays;
}

std::optional<InterfaceChange> RelayTransport::follow_interface() {
  if (changes_.empty()) return std::nullopt;
  InterfaceChange change = std::move(changes_.front());
  changes_.pop_front();
  return change;
}

void RelayTransport::on_receive(ReceiveHandler handler) {
  assert(handler && !handler_);
  handler_ = std::move(handler);
  receiver_.start([this](const Received& received, HostTime at) { take(received, at); });
  next_round();
}

bool RelayTransport::receive_pending() { return receiver_.read(); }

std::expected<void, NetError> RelayTransport::join(RegionId region) {
  if (joined_.insert(region).second) changed();
  return {};
}

std::expected<void, NetError> RelayTransport::leave(RegionId region) {
  if (joined_.erase(region) > 0) changed();
  return {};
}

void RelayTransport::changed() {
  greeting_due_ = true;
  hurried_rounds_ = std::max(hurried_rounds_, kShortRelayRounds);
}

void RelayTransport::send(RegionId region, std::span<const std::byte> datagram) {
  if (datagram.size() > kMaxDatagramBytes) {
    ++counters_.out_too_large;
    return;
  }
  RelayChoice::Relay* const relay = choice_.chosen();
  if (relay == nullptr) {
    ++counters_.out_unreachable;
    return;
  }
  if (!RelayChoice::wants(*relay, region)) {
    ++counters_.out_unwanted;
    return;
  }
  if (queue_.full()) queue_.flush(receiver_.socket().native_handle(), counters_);
  queue_.push(relay->at, relay_header({region}), datagram);
  relay->meter.count_out();
}

// Several joins and leaves of one step cause one greeting.
void RelayTransport::flush() {
  if (std::exchange(greeting_due_, false) && handler_) next_round();
  queue_.flush(receiver_.socket().native_handle(), counters_);
}

void RelayTransport::take(const Received& received, HostTime at) {
  if (received.truncated) {
    ++counters_.in_truncated;
    return;
  }
  const auto header = read_relay_header(received.bytes);
  if (!header) return on_greeting(received, at);
  RelayChoice::Relay* const relay = choice_.chosen();
  if (relay == nullptr || relay->at != received.from) {
    ++counters_.in_stranger;
    return;
  }
  choice_.on_datagram(at);
  if (!joined_.contains(header->region)) {
    ++counters_.in_other_region;
    return;
  }
  ++counters_.packets_in;
  counters_.bytes_in += received.bytes.size();
  handler_({header->region, received.bytes.subspan(kRelayHeaderBytes), at, received.from});
}

void RelayTransport::on_greeting(const Received& received, HostTime at) {
  const auto greeting = read_greeting(received.bytes, options_.family == IpFamily::kV4, options_.seal.get(), at,
                                      received.from, strangers_, counters_);
  if (!greeting) return;
  ++counters_.greetings_in;
  RelayChoice::Relay* const relay = choice_.find(received.from);
  if (relay == nullptr || !numbers_.is_number_for(received.from, greeting->echo)) return;
  strangers_.has_proven(received.from.address(), at);
  const bool knows_us = greeting->link.has_value() || greeting->leaving, is_first = relay->number == 0;
  choice_.on_greeting(at, *relay, *greeting);
  choose(at);
  // The number is what was missing.
  if (is_first || !knows_us) greet(*relay, /*leaving=*/false);
  queue_.flush(receiver_.socket().native_handle(), counters_);
}

void RelayTransport::choose(HostTime now) {
  const RelayChoice::Relay* const before = choice_.chosen();
  const std::string was = before == nullptr ? "" : address_text(before->at);
  if (!choice_.update(now)) return;
  ++counters_.relay_changes;
  RelayChoice::Relay* const chosen = choice_.chosen();
  if (chosen == nullptr) {
    changes_.push_back({false, "relay " + was + " is silent, and no other one answers: nothing is sent or heard"});
    return;
  }
  changes_.push_back({true, was.empty() ? "goes through relay " + address_text(chosen->at)
                                        : "goes through relay " + address_text(chosen->at) + " in place of " + was});
  for (RelayChoice::Relay& relay : choice_.relays()) {
    if (relay.number != 0) greet(relay, /*leaving=*/false);  // the one before has nothing more to send here
  }
  hurried_rounds_ = std::max(hurried_rounds_, kShortRelayRounds);
}

void RelayTransport::greet(RelayChoice::Relay& relay, bool leaving) {
  Greeting greeting{.instance = numbers_.instance(), .number = numbers_.number_for(relay.at), .echo = relay.number};
  greeting.leaving = leaving;
  greeting.reply = relay.number == 0;  // bare: it could not verify this address
  if (!greeting.reply) {
    greeting.link = relay.meter.note(reading_.clock.now());
    if (&relay == choice_.chosen() && !leaving) greeting.regions.assign(joined_.begin(), joined_.end());
  }
  relay.greeted = reading_.clock.now();
  const auto bytes = encode(greeting, options_.family == IpFamily::kV4);
  if (queue_.full()) queue_.flush(receiver_.socket().native_handle(), counters_);
  queue_.push(relay.at, {}, options_.seal ? options_.seal->seal(bytes) : bytes);
  ++counters_.greetings_out;
}

void RelayTransport::next_round() {
  const HostTime now = reading_.clock.now();
  numbers_.advance(now);
  choose(now);
  const bool hurried = hurried_rounds_ > 0;
  if (hurried) --hurried_rounds_;
  for (RelayChoice::Relay& relay : choice_.relays()) {
    const bool repeats = hurried && &relay == choice_.chosen();
    if (repeats || choice_.is_greeting_due(relay, now)) greet(relay, /*leaving=*/false);
  }
  queue_.flush(receiver_.socket().native_handle(), counters_);
  timer_.expires_after(std::chrono::duration_cast<std::chrono::nanoseconds>(hurried ? kShortRelayRound : kRelayRound));
  timer_.async_wait([this, alive = std::weak_ptr(alive_)](const boost::system::error_code& ec) {
    if (!alive.expired() && !ec) next_round();
  });
}

}  // namespace peerd::net
