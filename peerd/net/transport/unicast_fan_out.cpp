#include "peerd/net/transport/unicast_fan_out.hpp"

#include <net/if.h>

#include <algorithm>
#include <cassert>
#include <utility>

#include "peerd/net/greeting/read_greeting.hpp"
#include "peerd/net/os/udp_socket.hpp"

namespace peerd::net {
namespace {

using asio::ip::udp;

// Each round greets all known peers and candidates. After a change, and at the start, some rounds are short: greetings
// may get lost, and a peer that does not know our regions sends nothing.
constexpr auto kRound = std::chrono::seconds(1);
constexpr auto kShortRound = std::chrono::milliseconds(100);
constexpr int kShortRounds = 3, kShortRoundsAtStart = 10;

}  // namespace

std::expected<std::unique_ptr<UnicastFanOut>, NetError> UnicastFanOut::open(asio::io_context& io,
                                                                            const HostClock& clock,
                                                                            const UnicastOptions& options) {
  if (options.port == 0) {
    return failure(NetError::Kind::kBadSetting, "a peer's own port is a number from 1 to 65535");
  }
  std::unique_ptr<UnicastFanOut> opened(new UnicastFanOut(io, clock, options));
  udp::socket& socket = opened->receiver_.socket();
  const UdpOptions wanted{options.family == IpFamily::kV4, options.dscp, options.receive_buffer_bytes};
  if (auto good = open_udp(socket, wanted); !good) return std::unexpected(good.error());
  if (!options.interface.empty()) {
    const auto interfaces = list_interfaces();
    if (!interfaces) return std::unexpected(interfaces.error());
    const auto named = std::ranges::find(*interfaces, options.interface, &Interface::name);
    if (named == interfaces->end()) {
      return failure(NetError::Kind::kNoSuchInterface, "no interface named \"" + options.interface + "\" here");
    }
    const auto lo = std::ranges::find_if(*interfaces, &Interface::loopback);
    opened->only_over_ = named->index;
    if (lo != interfaces->end()) opened->loopback_ = lo->index;
  }
  if (auto good =
          bind_udp(socket, options.port, "give this peer another port: by unicast each on a computer has its own");
      !good) {
    return std::unexpected(good.error());
  }
  return opened;
}

UnicastFanOut::UnicastFanOut(asio::io_context& io, const HostClock& clock, const UnicastOptions& options)
    : options_(options),
      reading_(clock, counters_, kMaxDatagramBytes + kRegionHeaderBytes),
      receiver_(io, reading_),
      queue_(kMaxDatagramBytes + kRegionHeaderBytes),
      known_({.key = options.key, .seeds = options.seeds}),
      strangers_(options.key, {}),
      timer_(io),
      hurried_rounds_(kShortRoundsAtStart) {}

UnicastFanOut::~UnicastFanOut() {
  if (!handler_) return;  // no greeting has left yet
  greet_all(/*leaving=*/true);
  queue_.flush(native_handle(), counters_);
}

int UnicastFanOut::receive_buffer_bytes() const { return granted_receive_buffer(receiver_.socket()); }

asio::ip::address UnicastFanOut::own_address() const {
  if (options_.family == IpFamily::kV4) return asio::ip::address_v4::any();
  return asio::ip::address_v6::any();
}

std::string UnicastFanOut::describe() const {
  return "unicast at port " + std::to_string(options_.port) + " to " + std::to_string(options_.seeds.size()) +
         " configured peers and whoever greets" +
         (options_.interface.empty() ? "" : " over " + options_.interface + " or lo");
}

// The routing table decides about outgoing datagrams; incoming ones are selected by the interface's index.
std::optional<InterfaceChange> UnicastFanOut::follow_interface() {
  if (!only_over_) return std::nullopt;
  const auto index = index_of(options_.interface);
  if (!index || std::exchange(*only_over_, *index) == *index) return std::nullopt;
  const std::string name = "interface \"" + options_.interface + '"';
  if (*index != 0) return InterfaceChange{true, name + " is another one by now: goes on over that"};
  return InterfaceChange{false, name + " is gone: nothing that comes over it is heard until it is back"};
}

void UnicastFanOut::on_receive(ReceiveHandler handler) {
  assert(handler && !handler_);
  handler_ = std::move(handler);
  receiver_.start([this](const Received& received, HostTime at) { take(received, at); });
  next_round();
}

bool UnicastFanOut::receive_pending() { return receiver_.read(); }

std::expected<void, NetError> UnicastFanOut::join(RegionId region) {
  if (joined_.insert(region).second) changed();
  return {};
}

std::expected<void, NetError> UnicastFanOut::leave(RegionId region) {
  if (joined_.erase(region) > 0) changed();
  return {};
}

void UnicastFanOut::changed() {
  round_due_ = true;
  hurried_rounds_ = std::max(hurried_rounds_, kShortRounds);
}

void UnicastFanOut::send(RegionId region, std::span<const std::byte> datagram) {
  if (datagram.size() > kMaxDatagramBytes) {
    ++counters_.out_too_large;
    return;
  }
  const auto header = region_header(region);
  for (const KnownPeers::Peer& peer : known_.peers()) {
    if (KnownPeers::wants(peer, region)) push(peer.at, header, datagram);
  }
}

void UnicastFanOut::push(const udp::endpoint& to, std::span<const std::byte> header,
                         std::span<const std::byte> datagram) {
  if (queue_.full()) queue_.flush(native_handle(), counters_);
  queue_.push(to, header, datagram);
}

// Several joins, leaves and new peers of one step cause one round of greetings.
void UnicastFanOut::flush() {
  if (std::exchange(round_due_, false) && handler_) next_round();
  queue_.flush(native_handle(), counters_);
}

void UnicastFanOut::take(const Received& received, HostTime at) {
  const bool elsewhere = only_over_ && received.interface_index != *only_over_ && received.interface_index != loopback_;
  if (received.truncated) {
    ++counters_.in_truncated;
  } else if (elsewhere) {
    ++counters_.in_other_interface;
  } else if (read_region_header(received.bytes)) {
    take_datagram(received, at);
  } else {
    on_greeting(received, at);
  }
}

void UnicastFanOut::take_datagram(const Received& received, HostTime at) {
  if (!known_.has_echoed(received.from)) {
    ++counters_.in_stranger;
    return;
  }
  const RegionId region = *read_region_header(received.bytes);
  if (!joined_.contains(region)) {
    ++counters_.in_other_region;
    return;
  }
  ++counters_.packets_in;
  counters_.bytes_in += received.bytes.size();
  handler_({region, received.bytes.subspan(kRegionHeaderBytes), at, received.from});
}

void UnicastFanOut::on_greeting(const Received& received, HostTime at) {
  const auto greeting = read_greeting(received.bytes, options_.family == IpFamily::kV4, options_.seal.get(), at,
                                      received.from, strangers_, counters_);
  if (!greeting) return;
  ++counters_.greetings_in;
  const std::size_t introduced = known_.introduced();
  const auto outcome = known_.on_greeting(at, received.from, *greeting);
  using Outcome = KnownPeers::Outcome;
  if (outcome == Outcome::kFull) ++counters_.peers_refused;
  // A round names the new peer to the others, and greets the addresses that the greeting has named.
  if (outcome == Outcome::kNew || known_.introduced() > introduced) round_due_ = true;
  // A sender that echoes the number of an earlier process at this address gets a greeting of this process in any case.
  const bool unverified = outcome == Outcome::kUnverified && !greeting->leaving;
  const bool known = outcome == Outcome::kNew || outcome == Outcome::kKnown;
  if (known) strangers_.has_proven(received.from.address(), at);
  const bool answered = outcome == Outcome::kKnown && !greeting->reply;  // it knows our regions
  if (!(known && !answered) && !(unverified && (greeting->reply || greeting->echo != 0))) return;
  Greeting reply{.echo = greeting->number, .reply = unverified};
  if (known) reply.regions.assign(joined_.begin(), joined_.end());
  greet(received.from, std::move(reply));
  queue_.flush(native_handle(), counters_);
}

void UnicastFanOut::greet(const udp::endpoint& to, Greeting greeting) {
  greeting.instance = known_.instance();
  greeting.number = known_.number_for(to);
  const auto bytes = encode(greeting, options_.family == IpFamily::kV4);
  push(to, {}, options_.seal ? options_.seal->seal(bytes) : bytes);
  ++counters_.greetings_out;
}

void UnicastFanOut::greet_all(bool leaving) {
  for (const KnownPeers::Peer& peer : known_.peers()) {
    Greeting greeting{.echo = peer.number, .leaving = leaving};
    greeting.regions.assign(joined_.begin(), joined_.end());
    if (!leaving) greeting.peers = known_.introductions(peer, round_);
    greet(peer.at, std::move(greeting));
  }
  if (leaving) return;
  for (const udp::endpoint& candidate : known_.candidates()) greet(candidate, {.reply = true});
}

void UnicastFanOut::next_round() {
  known_.forget(reading_.clock.now());
  greet_all(/*leaving=*/false);
  queue_.flush(native_handle(), counters_);
  ++round_;
  const bool hurried = hurried_rounds_ > 0;
  if (hurried) --hurried_rounds_;
  timer_.expires_after(hurried ? std::chrono::duration_cast<std::chrono::nanoseconds>(kShortRound)
                               : std::chrono::duration_cast<std::chrono::nanoseconds>(kRound));
  timer_.async_wait([this, alive = std::weak_ptr(alive_)](const boost::system::error_code& ec) {
    if (!alive.expired() && !ec) next_round();
  });
}

}  // namespace peerd::net
