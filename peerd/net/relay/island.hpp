#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <expected>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <tuple>

#include "peerd/net/greeting/greeting_seal.hpp"
#include "peerd/net/greeting/source_buckets.hpp"
#include "peerd/net/greeting/unicast_frame.hpp"
#include "peerd/net/relay/network.hpp"
#include "peerd/net/transport/multicast_socket.hpp"

namespace peerd::relay {

struct IslandOptions {
  net::MulticastOptions multicast = {};          // its groups without the offset of a world, which the peers say
  std::uint32_t instance = 0;                    // of this relay
  net::SipKey key = {};                          // secret, of this process alone
  std::shared_ptr<net::GreetingSeal> seal = {};  // null: greetings are open
};

// An island: a network where peers reach each other by multicast. The relay asks there, in region 0, who wants which
// regions (net::IslandMember answers). Of several relays on one island the one that is not cut off from its parent,
// then the one closest to the root, passes datagrams on, and the next one takes its place when it is silent for a
// second, as routers do by VRRP (RFC 5798).
class Island final : public Network {
 public:
  // `io` and `clock` outlive it.
  [[nodiscard]] static std::expected<std::unique_ptr<Island>, net::NetError> open(boost::asio::io_context& io,
                                                                                  const net::HostClock& clock,
                                                                                  const IslandOptions& options);
  // Tells the other relays that it leaves.
  ~Island() override;

  void start(OnDatagram on_datagram, OnChange on_change) override;
  [[nodiscard]] std::optional<std::string> advance(HostTime now, const Place& place) override;
  [[nodiscard]] Wanted wanted() const override;
  void receive(const Wanted& wanted_elsewhere) override;
  void send(RegionId region, std::span<const std::byte> datagram) override;
  void flush() override { socket_->flush(); }
  [[nodiscard]] const net::TrafficCounters& counters() const override;
  [[nodiscard]] std::uint64_t left_to_others() const override { return left_to_others_; }
  [[nodiscard]] std::size_t peers() const override { return members_.size(); }
  [[nodiscard]] bool is_active() const override { return active_; }
  [[nodiscard]] std::string describe() const override { return socket_->describe(); }

 private:
  struct Member {
    std::int64_t note_ns = 0;  // of its last report; an older one was recorded
    HostTime last_received{};
    Wanted wanted;
  };
  // A lower one passes datagrams on.
  using Rank = std::tuple<bool, std::size_t, std::uint32_t>;
  struct OtherRelay {
    std::int64_t note_ns = 0;
    HostTime last_received{};
    Rank rank;
    boost::asio::ip::udp::endpoint at;
  };

  Island(const net::HostClock& clock, std::unique_ptr<net::MulticastSocket> socket, const IslandOptions& options);
  void take(const net::Arrival& arrival);
  void on_greeting(const net::Arrival& arrival);
  void on_report(const net::Arrival& arrival, const net::Greeting& greeting);
  void on_relay(const net::Arrival& arrival, const net::Greeting& greeting);
  void ask(HostTime now, bool leaving);
  [[nodiscard]] bool should_be_active(HostTime now) const;
  void follow();

  const net::HostClock& clock_;
  std::unique_ptr<net::MulticastSocket> socket_;
  IslandOptions options_;
  net::SourceBuckets strangers_;
  net::TrafficCounters greeting_counters_;                   // of greetings alone
  std::uint64_t greetings_passed_ = 0, greeting_bytes_ = 0;  // what the socket has counted as datagrams
  mutable net::TrafficCounters counters_;
  std::uint64_t left_to_others_ = 0;
  std::optional<boost::asio::ip::udp::endpoint> own_address_;  // of this relay's other socket on that network
  OnDatagram on_datagram_;
  OnChange on_change_;
  std::map<std::uint32_t, Member> members_;     // by instance
  std::map<std::uint32_t, OtherRelay> relays_;  // by instance
  Rank rank_{false, 1, 0};
  std::optional<std::uint32_t> group_offset_;  // of the world, when a peer has said it
  Wanted wanted_elsewhere_;
  std::set<RegionId> joined_;
  HostTime listens_since_{}, asked_{}, followed_{};
  std::int64_t last_note_ns_ = 0;
  bool active_ = false;
  bool is_other_world_said_ = false;
  std::optional<std::string> finding_;  // for the log
};

}  // namespace peerd::relay
