#pragma once
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <expected>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "peerd/net/greeting/address_numbers.hpp"
#include "peerd/net/greeting/greeting_seal.hpp"
#include "peerd/net/greeting/relay_choice.hpp"
#include "peerd/net/greeting/source_buckets.hpp"
#include "peerd/net/os/interfaces.hpp"
#include "peerd/net/os/udp_receiver.hpp"
#include "peerd/net/relay/forwarding_table.hpp"
#include "peerd/net/relay/neighbours.hpp"
#include "peerd/net/relay/network.hpp"

namespace peerd::relay {

struct RelayOptions {
  net::IpFamily family = net::IpFamily::kV4;
  std::uint16_t port = 0;                                 // UDP, where single peers and other relays reach it
  std::vector<boost::asio::ip::udp::endpoint> parents{};  // the relays above it, in the order of preference
  net::SipKey key = {};                                   // secret, of this process alone
  std::shared_ptr<net::GreetingSeal> seal = {};           // null: greetings are open
  double budget_bytes_per_s = 0.0;                        // of each link with a neighbour, outwards; 0: there is none
  int dscp = 0;
  int receive_buffer_bytes = 4 * 1024 * 1024;
  std::size_t neighbours_max = 4096;
};

// Passes datagrams on between networks: islands of multicast, meshes of unicast, single peers, and other relays, which
// together are a tree. A datagram goes where somebody wants its region, and nowhere else. What is in it is sealed from
// the relay, which has no key but that of greetings. Single-threaded, as its io_context.
class Relay {
 public:
  using Say = std::function<void(bool is_warning, const std::string& sentence)>;

  struct Counters {
    std::uint64_t forwarded = 0;    // copies that left, over all links
    std::uint64_t unwanted = 0;     // datagrams of regions that nobody else wants
    std::uint64_t greetings = 0;    // datagrams that would be taken for greetings elsewhere: recorded ones
    std::uint64_t out_of_hops = 0;  // they have been through too many relays: these lead in a circle
    std::uint64_t over_budget = 0;  // copies beyond a link's budget
    std::uint64_t refused = 0;      // greetings of neighbours beyond the limit
  };

  // `io` and `clock` outlive it.
  [[nodiscard]] static std::expected<std::unique_ptr<Relay>, net::NetError> open(boost::asio::io_context& io,
                                                                                 const net::HostClock& clock,
                                                                                 const RelayOptions& options, Say say);
  // Tells all neighbours that it leaves.
  ~Relay();

  // A network of many peers; before start().
  void add(std::unique_ptr<Network> network);
  // Begins; to be called once.
  void start();

  [[nodiscard]] std::uint32_t instance() const { return numbers_.instance(); }
  [[nodiscard]] std::uint16_t port() const;  // its own, also where the system has chosen it
  // The instances of the relays from this one up to the root.
  [[nodiscard]] std::vector<std::uint32_t> path() const;
  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] const net::TrafficCounters& traffic() const { return traffic_; }
  [[nodiscard]] const Neighbours& neighbours() const { return neighbours_; }
  [[nodiscard]] const std::vector<std::unique_ptr<Network>>& networks() const { return networks_; }
  [[nodiscard]] const net::RelayChoice& parents() const { return parents_; }
  [[nodiscard]] const ForwardingTable& table() const { return table_; }

 private:
  Relay(boost::asio::io_context& io, const net::HostClock& clock, const RelayOptions& options, Say say);

  void take(const net::Received& received, HostTime at);
  void take_datagram(const net::Received& received, const net::RelayHeader& header, HostTime at);
  void on_greeting(const net::Received& received, HostTime at);
  void on_neighbour(const net::Received& received, const net::Greeting& greeting, HostTime at);
  void forward(LinkId from, const net::RelayHeader& header, std::span<const std::byte> datagram, HostTime at);
  void send(Neighbour& to, const std::array<std::byte, net::kRelayHeaderBytes>& header, bool for_all,
            std::span<const std::byte> datagram, HostTime at);
  void push(const boost::asio::ip::udp::endpoint& to, std::span<const std::byte> header,
            std::span<const std::byte> datagram);
  [[nodiscard]] bool is_detached() const { return !parents_.relays().empty() && parents_.chosen() == nullptr; }
  void greet(Neighbour& neighbour, bool leaving);
  void greet(net::RelayChoice::Relay& parent, bool leaving);
  void send_greeting(const boost::asio::ip::udp::endpoint& to, net::Greeting greeting);
  void choose_parent(HostTime now);
  void remove(Neighbour& neighbour);
  void mark_changed();
  void finish_soon();
  void settle();
  void advance();

  boost::asio::io_context& io_;
  RelayOptions options_;
  Say say_;
  net::TrafficCounters traffic_;
  Counters counters_;
  net::Reading reading_;
  net::UdpReceiver receiver_;
  net::SendQueue queue_;
  net::AddressNumbers numbers_;
  net::RelayChoice parents_;
  net::SourceBuckets strangers_;
  std::vector<std::unique_ptr<Network>> networks_;
  Neighbours neighbours_;
  ForwardingTable table_;
  boost::asio::steady_timer timer_;
  bool changed_ = false, finishing_ = false, full_said_ = false;
  std::shared_ptr<const bool> alive_ = std::make_shared<const bool>(true);  // as net::UdpReceiver::alive_
};

}  // namespace peerd::relay
