#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "peerd/daemon/log/log.hpp"

namespace peerd {

// `peerd relay` passes the datagrams of a session on between islands of multicast, meshes of unicast, single peers and
// other relays, until a signal ends it. Returns the exit code: 0; 2 wrong use; 3 the environment.
struct RelayCommandOptions {
  std::uint32_t port = kDefaultPort;
  std::vector<std::string> parents{};  // HOST:PORT
  std::vector<std::string> islands{};  // interfaces
  std::vector<std::string> mesh{};     // HOST:PORT
  std::uint32_t mesh_port = 0;         // 0: none
  std::string group = "239.192.80.0";
  std::uint32_t group_pool = 0, group_port = 47474, ttl = 1, dscp = 0;
  std::string world{};                       // whose key this user has
  std::filesystem::path key{}, relay_key{};  // files
  bool open = false;
  double budget_kib_s = 0.0;  // of each link; 0: none
  double report_s = 0.0;      // a report so often; 0: none
  bool json = false;
  LogFormat log = LogFormat::kText;

  static constexpr std::uint32_t kDefaultPort = 47480;
};
[[nodiscard]] int run_relay(const RelayCommandOptions& options);

}  // namespace peerd
