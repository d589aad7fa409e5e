#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "peerd/daemon/open/peer_options.hpp"

namespace peerd {

// The options of `peerd run` that stand for settings, in place of a configuration file or over it.
struct RunFlags {
  std::string world{}, world_name{}, name{}, interface {
  }, group{}, key{}, password{};
  std::optional<std::uint32_t> id{}, port{};
  std::vector<std::string> owns{}, enslaves{};  // two names of one option
  std::vector<std::string> relays{};            // HOST:PORT
  std::vector<std::string> nats{};              // URLs of servers
  std::string collide{}, unit{}, up{};          // WorldReading's
  bool open = false;
  bool lenient = false;
  bool ipv6 = false;  // in place of a group
};

// The settings that the network's options stand for, as KEY=VALUE.
[[nodiscard]] std::vector<std::string> network_settings(const RunFlags& flags);

// The settings that the options stand for. Without a configuration there is one peer, which the options describe.
[[nodiscard]] std::vector<std::string> as_settings(const RunFlags& flags, PeerOptions& options);

}  // namespace peerd
