#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "peerd/net/settings/nats_settings.hpp"

namespace peerd::net {

inline constexpr std::uint32_t kDefaultPort = 47474;  // UDP

// The table [transport]: how a real peer reaches the others.
struct TransportSettings {
  std::string interface;               // empty: the only one that can multicast, else lo
  std::string group = "239.192.80.0";  // multicast group of region 0
  std::uint32_t group_pool = 0;        // groups that all regions share; 0: each has its own
  std::optional<std::uint32_t> port;   // none: kDefaultPort, and for `peerd scenario` one of its own
  std::uint32_t ttl = 1;
  std::uint32_t dscp = 0;
  std::uint32_t receive_buffer_bytes = 1024 * 1024;
  std::uint32_t busy_poll_us = 0;   // polling time before the peer sleeps; 0: none
  std::size_t multicast = 0;        // kMulticastAuto, kMulticastAlways or kMulticastNever
  std::vector<std::string> peers;   // "HOST:PORT": whom unicast greets first
  std::vector<std::string> relays;  // "HOST:PORT": through which of them all others are reached, the first that answers
  bool discoverable = true;         // says that it is here to who asks in this LAN, and gives its world to who joins
  std::uint16_t snapshot_port = 0;  // TCP, for who joins; 0: the system chooses one
  bool sealed = true;               // datagrams are encrypted; one that was sealed by another key is dropped
  std::string key_file;             // of the key; empty: this user's own of the world
  std::string identity_file;        // of who this user is; empty: this user's own
  std::string roster_file;          // of the members; empty: this user's own of the world, if there is one
  std::string password_file;        // of a password that makes the key; "-": asked for; empty: none
  NatsSettings nats;                // datagrams go through NATS servers, if there are some
};
inline constexpr std::size_t kMulticastAuto = 0, kMulticastAlways = 1,
                             kMulticastNever = 2;  // TransportSettings::multicast

}  // namespace peerd::net
