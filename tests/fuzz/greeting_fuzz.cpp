// Sends any datagram to the port of a unicast peer: decode_greeting() accepts only whole greetings, in their one
// encoding, and the table of peers stays within its bounds. Nothing is a sealed greeting that the session's key opens.
//
// The first byte selects the family (its lowest bit) and the sender's port; the rest is the datagram.
#include <algorithm>
#include <cstdint>
#include <span>

#include "peerd/net/greeting/known_peers.hpp"
#include "peerd/net/greeting/relay_choice.hpp"
#include "peerd/net/seal/sealed_greetings.hpp"
#include "tests/fuzz/fuzz.hpp"

using namespace peerd;
using namespace peerd::net;
using fuzz::require;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const bool v4 = (data[0] & 1) != 0;
  const auto datagram = std::as_bytes(std::span(data, size)).subspan(1);
  (void)read_region_header(datagram);
  if (const auto header = read_relay_header(datagram)) {
    require(std::ranges::equal(relay_header(*header), datagram.first(kRelayHeaderBytes)));
  }
  static seal::SealedGreetings sealed(keys::SymmetricKey::random(), [](const std::string&) {});
  require(!sealed.open(datagram, HostTime{}, {}));
  auto greeting = decode_greeting(datagram, v4);
  if (!greeting) return 0;
  const auto again = encode(*greeting, v4);
  require(std::vector(datagram.begin(), datagram.end()) == again);

  const asio::ip::udp::endpoint from(
      v4 ? asio::ip::address(asio::ip::address_v4::loopback()) : asio::ip::address(asio::ip::address_v6::loopback()),
      data[0]);
  RelayChoice choice({.relays = {from}, .self = 7});
  for (const int second : {1'000, 1'001}) {
    const HostTime now{std::chrono::seconds(second)};
    (void)choice.relays().front().meter.note(now);
    choice.on_greeting(now, choice.relays().front(), *greeting);
    (void)choice.update(now);
    const LinkMeter& meter = choice.relays().front().meter;
    require(!meter.round_trip() || *meter.round_trip() >= Duration{0});
    require(meter.loss_in() >= 0.0 && meter.loss_in() <= 1.0 && meter.loss_out() >= 0.0 && meter.loss_out() <= 1.0);
    require(!meter.clock() || meter.clock()->error >= Duration{0});
  }
  KnownPeers known({.key = {1, 2}, .most = 4});
  greeting->echo = known.number_for(from);  // so that the sender is verified
  HostTime now{std::chrono::seconds(1)};
  for (int i = 0; i < 2; ++i) (void)known.on_greeting(now, from, *greeting);
  require(known.peers().size() <= 1);
  require(known.candidates().size() <= 4);
  for (const auto& peer : known.peers()) {
    require(known.introductions(peer, greeting->instance).empty());
    for (const RegionId region : peer.regions) require(KnownPeers::wants(peer, region));
  }
  known.forget(now + std::chrono::seconds(100));  // silent peers become candidates
  require(known.peers().empty() && known.candidates().size() <= 1);
  now += std::chrono::seconds(100) + std::chrono::minutes(11);
  known.forget(now);  // one that was known is greeted for 3 s in each minute
  require(known.candidates().size() <= 1);
  known.forget(now + std::chrono::seconds(4));
  require(known.candidates().empty());
  return 0;
}
