#pragma once
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <vector>

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
};

// The interfaces of this network namespace, by index.
[[nodiscard]] std::expected<std::vector<Interface>, NetError> list_interfaces();

struct ChosenInterface {
  Interface interface;
  std::string why;  // for the log: "eth0, as configured"
};

// Returns the interface named `wanted`; for an empty name, the only one that reaches other computers and is running,
// else lo (IPv4). A pure function of the list.
[[nodiscard]] std::expected<ChosenInterface, NetError> choose_interface(const std::vector<Interface>& interfaces,
                                                                        std::string_view wanted, IpFamily family);

}  // namespace peerd::net
