#pragma once
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "core/ids.hpp"
#include "peerd/net/os/interfaces.hpp"
#include "peerd/net/os/net_error.hpp"
#include "peerd/net/os/udp_receiver.hpp"
#include "peerd/net/transport/region_groups.hpp"
#include "peerd/net/transport/transport.hpp"

namespace peerd::net {

struct MulticastOptions {
  std::string interface = "";  // "lo", "eth0"; empty: choose_interface() chooses
  GroupPlan groups;
  int ttl = 1;                             // hops, 0 to 255. 0: this computer only; 1: this LAN
  int dscp = 0;                            // 0 to 63: the priority for routers and wireless links
  int receive_buffer_bytes = 1024 * 1024;  // requested of the kernel, which may grant less (net.core.rmem_max)
  std::string if_port_is_taken = "choose another port for all peers";  // advice
  bool any_port = false;  // the system chooses the port in place of the plan's, for a probe
  // Whether own datagrams to a joined group come back. If not, they leave from a port of their own, by which a filter
  // in the kernel drops them before they wake the process.
  bool receives_own_datagrams = true;
};

// Carries all regions of a session over one interface: it sends to any region and receives those that are joined. The
// kernel limits the groups of one UDP socket, so further sockets are opened when a socket is full. Multicast loopback
// is on so that peers on one computer receive each other.
class MulticastSocket final : public Transport {
 public:
  // `io` and `clock` outlive it.
  [[nodiscard]] static std::expected<std::unique_ptr<MulticastSocket>, NetError> open(asio::io_context& io,
                                                                                      const HostClock& clock,
                                                                                      const MulticastOptions& options);

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
  [[nodiscard]] asio::ip::address own_address() const override { return own_address_; }
  [[nodiscard]] std::string why_only_here() const override;
  [[nodiscard]] std::string describe() const override;
  [[nodiscard]] const ChosenInterface& chosen_interface() const { return chosen_; }
  // The groups of regions are from now on those of another world (GroupPlan::offset). No region but that of the whole
  // scene may be joined, whose group is the same in all worlds.
  void follow_world(std::uint32_t group_offset);
  [[nodiscard]] std::size_t socket_count() const { return sockets_.size(); }
  // The descriptor of the sending socket.
  [[nodiscard]] int native_handle() {
    return (sender_ ? *sender_ : sockets_.front()->receiver.socket()).native_handle();
  }

 private:
  struct Socket {
    Socket(asio::io_context& io, Reading& reading) : receiver(io, reading) {}
    UdpReceiver receiver;
    std::size_t memberships = 0;
  };
  struct Membership {
    Socket* socket;
    asio::ip::address group;
    std::size_t regions = 0;  // joined regions of this group
  };

  MulticastSocket(asio::io_context& io, const HostClock& clock, const MulticastOptions& options,
                  ChosenInterface chosen);

  std::expected<void, NetError> add_sender();
  std::expected<void, NetError> add_socket();
  std::expected<void, NetError> filter_own_datagrams(int fd) const;
  std::expected<void, NetError> configure(int fd) const;
  std::expected<void, NetError> probe_route();
  [[nodiscard]] int find_own_address();  // 0, or an errno

  [[nodiscard]] int send_over_our_interface(int fd) const;  // 0, or an errno
  [[nodiscard]] int change_membership(Socket& socket, bool join,
                                      const asio::ip::address& group);  // 0, or an errno
  std::expected<Socket*, NetError> add_membership(RegionId region, const asio::ip::address& group);
  [[nodiscard]] bool interface_was_replaced() const;
  [[nodiscard]] int switch_to(const Interface& interface);  // 0, or an errno
  [[nodiscard]] std::optional<InterfaceChange> leave_loopback();
  [[nodiscard]] std::optional<InterfaceChange> say_unseen(int error);
  [[nodiscard]] NetError join_error(RegionId region, int error) const;
  [[nodiscard]] asio::ip::udp::endpoint on_our_interface(const asio::ip::udp::endpoint& group) const;

  void start(Socket& socket);
  void take(const Received& received, HostTime at);

  asio::io_context& io_;
  MulticastOptions options_;
  ChosenInterface chosen_;
  bool interface_gone_ = false;    // as last reported
  bool interface_unseen_ = false;  // the system does not say whether it is there; as last reported
  asio::ip::address own_address_;
  TrafficCounters counters_;
  Reading reading_;
  std::optional<asio::ip::udp::socket> sender_;  // none: the first of sockets_ sends
  std::vector<std::unique_ptr<Socket>> sockets_;
  std::size_t memberships_max_;  // for one socket
  std::set<RegionId> joined_;
  std::map<std::uint32_t, Membership> memberships_;  // by the number of the group
  ReceiveHandler handler_;
  SendQueue queue_;
  std::vector<UdpReceiver*> filtered_by_;  // for each datagram in queue_: the socket whose filter will drop it; or null
};

// The number of groups that the system lets one socket join; none where it counts otherwise, or does not say.
[[nodiscard]] std::optional<std::size_t> memberships_limit(IpFamily family);

}  // namespace peerd::net
