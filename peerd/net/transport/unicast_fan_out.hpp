#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "peerd/net/greeting/greeting_seal.hpp"
#include "peerd/net/greeting/known_peers.hpp"
#include "peerd/net/greeting/source_buckets.hpp"
#include "peerd/net/os/interfaces.hpp"
#include "peerd/net/os/udp_receiver.hpp"
#include "peerd/net/transport/transport.hpp"

namespace peerd::net {

struct UnicastOptions {
  IpFamily family = IpFamily::kV4;
  std::string interface = "";  // receives over this interface and lo; empty: over any
  std::uint16_t port = 0;      // of this peer alone; from 1
  std::vector<asio::ip::udp::endpoint> seeds = {};
  SipKey key = {};                          // KnownPeers::Options::key
  std::shared_ptr<GreetingSeal> seal = {};  // null: greetings are open
  int dscp = 0;
  int receive_buffer_bytes = 1024 * 1024;
};

// Sends one copy of each datagram to every peer that wants its region, where multicast does not work. Peers find each
// other by greetings, beginning with the configured addresses: each greeting is answered, and names peers that its
// sender knows.
class UnicastFanOut final : public Transport {
 public:
  // `io` and `clock` outlive it.
  [[nodiscard]] static std::expected<std::unique_ptr<UnicastFanOut>, NetError> open(asio::io_context& io,
                                                                                    const HostClock& clock,
                                                                                    const UnicastOptions& options);
  // Sends a leaving greeting to all known peers.
  ~UnicastFanOut() override;

  void on_receive(ReceiveHandler handler) override;
  bool receive_pending() override;
  std::expected<void, NetError> join(RegionId region) override;
  std::expected<void, NetError> leave(RegionId region) override;
  void send(RegionId region, std::span<const std::byte> datagram) override;
  void flush() override;
  [[nodiscard]] std::optional<InterfaceChange> follow_interface() override;

  [[nodiscard]] const TrafficCounters& counters() const override { return counters_; }
  [[nodiscard]] std::size_t joined_count() const override { return joined_.size(); }
  [[nodiscard]] int receive_buffer_bytes() const override;
  [[nodiscard]] asio::ip::address own_address() const override;
  [[nodiscard]] std::string describe() const override;
  [[nodiscard]] const std::vector<KnownPeers::Peer>& peers() const { return known_.peers(); }
  [[nodiscard]] int native_handle() { return receiver_.socket().native_handle(); }

 private:
  UnicastFanOut(asio::io_context& io, const HostClock& clock, const UnicastOptions& options);

  void take(const Received& received, HostTime at);
  void on_greeting(const Received& received, HostTime at);
  void take_datagram(const Received& received, HostTime at);
  void push(const asio::ip::udp::endpoint& to, std::span<const std::byte> header, std::span<const std::byte> datagram);
  void greet(const asio::ip::udp::endpoint& to, Greeting greeting);
  void greet_all(bool leaving);
  void changed();
  void next_round();

  UnicastOptions options_;
  std::optional<unsigned> only_over_, loopback_;  // indices of interfaces; 0: the interface is gone
  TrafficCounters counters_;
  Reading reading_;
  UdpReceiver receiver_;
  SendQueue queue_;
  KnownPeers known_;
  SourceBuckets strangers_;
  std::set<RegionId> joined_;
  ReceiveHandler handler_;
  asio::steady_timer timer_;
  std::size_t round_ = 0;
  int hurried_rounds_;
  bool round_due_ = false;
  std::shared_ptr<const bool> alive_ = std::make_shared<const bool>(true);  // as UdpReceiver::alive_
};

}  // namespace peerd::net
