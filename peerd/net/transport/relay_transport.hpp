#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <deque>
#include <expected>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "peerd/net/greeting/address_numbers.hpp"
#include "peerd/net/greeting/greeting_seal.hpp"
#include "peerd/net/greeting/relay_choice.hpp"
#include "peerd/net/greeting/source_buckets.hpp"
#include "peerd/net/os/interfaces.hpp"
#include "peerd/net/os/udp_receiver.hpp"
#include "peerd/net/transport/transport.hpp"

namespace peerd::net {

struct RelayTransportOptions {
  IpFamily family = IpFamily::kV4;
  std::vector<asio::ip::udp::endpoint> relays = {};  // in the order of preference; at least one
  SipKey key = {};                                   // AddressNumbers
  std::shared_ptr<GreetingSeal> seal = {};           // null: greetings are open
  int dscp = 0;
  int receive_buffer_bytes = 1024 * 1024;
};

// Reaches the session through one relay (peerd/net/relay) at a time: the first of a list that answers, and another one
// within two seconds of its silence. This peer opens the flow and keeps it open by its greetings, so that it may be
// behind a NAT. Only regions that somebody behind the relay wants are sent.
class RelayTransport final : public Transport {
 public:
  // `io` and `clock` outlive it.
  [[nodiscard]] static std::expected<std::unique_ptr<RelayTransport>, NetError> open(
      asio::io_context& io, const HostClock& clock, const RelayTransportOptions& options);
  // Sends a leaving greeting.
  ~RelayTransport() override;

  void on_receive(ReceiveHandler handler) override;
  bool receive_pending() override;
  std::expected<void, NetError> join(RegionId region) override;
  std::expected<void, NetError> leave(RegionId region) override;
  void send(RegionId region, std::span<const std::byte> datagram) override;
  void flush() override;
  // A change of the relay, each once.
  [[nodiscard]] std::optional<InterfaceChange> follow_interface() override;

  [[nodiscard]] const TrafficCounters& counters() const override { return counters_; }
  [[nodiscard]] std::size_t joined_count() const override { return joined_.size(); }
  [[nodiscard]] int receive_buffer_bytes() const override;
  [[nodiscard]] asio::ip::address own_address() const override;
  [[nodiscard]] std::string describe() const override;
  // The relay that is in use; null: none answers.
  [[nodiscard]] const RelayChoice::Relay* relay() const { return choice_.chosen(); }

 private:
  RelayTransport(asio::io_context& io, const HostClock& clock, const RelayTransportOptions& options);

  void take(const Received& received, HostTime at);
  void on_greeting(const Received& received, HostTime at);
  void greet(RelayChoice::Relay& relay, bool leaving);
  void choose(HostTime now);
  void changed();
  void next_round();

  RelayTransportOptions options_;
  TrafficCounters counters_;
  Reading reading_;
  UdpReceiver receiver_;
  SendQueue queue_;
  AddressNumbers numbers_;
  RelayChoice choice_;
  SourceBuckets strangers_;
  std::set<RegionId> joined_;
  ReceiveHandler handler_;
  asio::steady_timer timer_;
  int hurried_rounds_ = 0;
  bool greeting_due_ = false;
  std::deque<InterfaceChange> changes_;
  std::shared_ptr<const bool> alive_ = std::make_shared<const bool>(true);  // as UdpReceiver::alive_
};

}  // namespace peerd::net
