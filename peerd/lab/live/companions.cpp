#include "peerd/lab/live/companions.hpp"

#include <spdlog/fmt/fmt.h>

#include "peerd/input/json_text.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/lab/live/lab.hpp"

namespace peerd {
namespace {

// Counted from the session's port, which is followed by those of unicast peers.
constexpr std::size_t kServerPorts = 100, kJoiningPorts = 200;

int server_port(const Islands& islands, std::size_t peer) {
  return islands.port + static_cast<int>(kServerPorts + (islands.apart ? 0 : peer));
}
int joining_port(const Islands& islands, std::size_t peer) {
  return islands.port + static_cast<int>(kJoiningPorts + (islands.apart ? 0 : peer));
}
std::string island_address(const Islands& islands, std::size_t peer) {
  return islands.apart ? live::Lab::address(peer) : "127.0.0.1";
}

// How a server finds the others. By leaf nodes all join the first one. In a cluster each joins those before it: where
// two join each other over a slow link, nats-server 2.9 closes both connections as duplicates, again and again.
std::string joining_of(const config::RunSettings& run, const Islands& islands, std::size_t peer) {
  if (run.via == config::Via::kNats) {
    if (peer == 0) return fmt::format("leafnodes {{ listen: \"0.0.0.0:{}\" }}\n", joining_port(islands, 0));
    return fmt::format("leafnodes {{ reconnect: 1, remotes: [{{ url: \"nats-leaf://{}:{}\" }}] }}\n",
                       island_address(islands, 0), joining_port(islands, 0));
  }
  std::string routes;
  for (std::size_t other = 0; other < peer; ++other) {
    routes += fmt::format("{}\"nats-route://{}:{}\"", routes.empty() ? "" : ", ", island_address(islands, other),
                          joining_port(islands, other));
  }
  return fmt::format("cluster {{ name: islands, listen: \"0.0.0.0:{}\", routes: [{}] }}\n", joining_port(islands, peer),
                     routes);
}

Result<Companion> nats_server(const config::RunSettings& run, const Islands& islands, std::size_t peer) {
  const std::string name = run.peers[peer].name + ".nats";
  const auto file = std::filesystem::absolute(islands.stem.string() + "." + name + ".conf");
  const std::string text =
      fmt::format("server_name: {}\nlisten: \"127.0.0.1:{}\"\nping_interval: \"1s\"\nping_max: 2\n",
                  json_line(run.peers[peer].name), server_port(islands, peer));
  if (auto written = write_text_file(file, text + joining_of(run, islands, peer)); !written) {
    return std::unexpected(written.error());
  }
  return Companion{peer, name, {"nats-server", "--config", file.string()}, "Server is ready"};
}

// A relay whose island is lo: its port there is the island's own, as all may be on one computer.
Companion peer_relay(const config::RunSettings& run, const Islands& islands, std::size_t peer) {
  std::vector<std::string> command{islands.program.string(),
                                   "relay",
                                   "--key",
                                   islands.key_file.string(),
                                   "--port",
                                   std::to_string(server_port(islands, peer)),
                                   "--island",
                                   "lo",
                                   "--group",
                                   run.transport.group,
                                   "--group-port",
                                   std::to_string(joining_port(islands, peer)),
                                   "--group-pool",
                                   std::to_string(run.transport.group_pool),
                                   "--report",
                                   "1",
                                   "--json"};
  if (peer > 0) {
    const std::string root = fmt::format("{}:{}", island_address(islands, 0), server_port(islands, 0));
    command.insert(command.end(), {"--parent", root});
  }
  return {peer, run.peers[peer].name + ".relay", std::move(command), "passes on what peers there send"};
}

}  // namespace

Result<std::vector<Companion>> companions_of(const config::RunSettings& run, const Islands& islands) {
  std::vector<Companion> companions;
  if (run.via == config::Via::kNothing) return companions;
  for (std::size_t peer = 0; peer < run.peers.size(); ++peer) {
    if (run.via == config::Via::kRelay) {
      companions.push_back(peer_relay(run, islands, peer));
      continue;
    }
    auto server = nats_server(run, islands, peer);
    if (!server) return std::unexpected(server.error());
    companions.push_back(*std::move(server));
  }
  return companions;
}

std::vector<std::string> settings_by_companions(const config::RunSettings& run, const Islands& islands,
                                                std::size_t peer) {
  if (run.via == config::Via::kNothing) return {};
  if (run.via == config::Via::kRelay) {
    return {"transport.port=" + std::to_string(joining_port(islands, peer))};
  }
  const auto server = fmt::format("nats://127.0.0.1:{}", server_port(islands, peer));
  return {"transport.nats=" + json_line(std::vector{server})};
}

}  // namespace peerd
