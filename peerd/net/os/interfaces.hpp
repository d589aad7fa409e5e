#pragma once
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/ip/address.hpp>

#include "peerd/net/os/net_error.hpp"

namespace peerd::net {

enum class IpFamily : std::uint8_t { kV4, kV6 };

struct Interface {
  std::string name;
  unsigned index = 0;  // the kernel's number, from 1
  bool up = false;
  bool running = false;  // has a carrier: a cable, a wireless link, a container on the bridge
  bool loopback = false;
  bool multicast = false;  // IFF_MULTICAST; lo lacks the flag, and yet carries IPv4 multicast
  bool has_ipv4 = false;
  bool has_ipv6 = false;
  bool has_wide_ipv6 = false;  // one that is valid beyond its link
};

// The interfaces of this network namespace, by index.
[[nodiscard]] std::expected<std::vector<Interface>, NetError> list_interfaces();

// The index of the interface of that name; 0: there is none. The error is an errno: the system does not say, as where
// this process has no descriptors left.
[[nodiscard]] std::expected<unsigned, int> index_of(const std::string& name);

// Whether both are addresses of one interface of this computer, at present; two that are the same are.
[[nodiscard]] bool are_of_one_interface(const boost::asio::ip::address& a, const boost::asio::ip::address& b);

struct ChosenInterface {
  Interface interface;
  std::string why;  // for the log: "eth0, as configured"
};

// Whether IPv6 alone is to be had over the interface named `wanted`, or, for an empty name, over all that reach other
// computers. An IPv6 address of the link alone is no sign of that: an interface has one before it has any other.
[[nodiscard]] bool has_ipv6_alone(const std::vector<Interface>& interfaces, std::string_view wanted);

// Returns the interface named `wanted`; for an empty name, the only one that reaches other computers and is running,
// else lo (IPv4). A pure function of the list.
[[nodiscard]] std::expected<ChosenInterface, NetError> choose_interface(const std::vector<Interface>& interfaces,
                                                                        std::string_view wanted, IpFamily family);

}  // namespace peerd::net
