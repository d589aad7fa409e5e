#include "peerd/daemon/open/peer_ports.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "peerd/input/printable.hpp"
#include "peerd/peer/control/control_path.hpp"
#include "peerd/view/frames/picture_input.hpp"
#include "peerd/view/gateway/access.hpp"
#include "peerd/view/gateway/listen_address.hpp"

namespace peerd {
namespace {

namespace asio = boost::asio;

struct ControlPlace {
  std::filesystem::path socket;       // empty: none
  bool requested_explicitly = false;  // the user asked for it, so a peer without it must not run
};

// The socket is that of the option, else that of the configuration, else one in the user's own folder.
ControlPlace control_place(const PeerOptions& options, const config::ControlSettings& settings,
                           const config::PeerSettings& peer, Log& log) {
  if (const auto& given = options.control ? options.control : settings.socket) {
    std::string path = *given;
    if (const auto at = path.find("{peer}"); at != std::string::npos) path.replace(at, 6, peer.name);
    return {path, true};
  }
  if (const auto made = control::make_runtime_folder(); !made) {
    log(LogLevel::kWarning, "runs without peerd ctl: " + made.error().text);
    return {};
  }
  return {control::default_socket(peer.name, peer.id), false};
}

// The result is null where the socket can't be opened and nobody has asked for it explicitly.
Result<std::unique_ptr<control::ControlServer>> open_control(asio::io_context& io, const ControlPlace& place,
                                                             Daemon& daemon, Log& log) {
  if (place.socket.empty()) return nullptr;
  auto opened = control::ControlServer::open(io, place.socket,
                                             [&daemon](std::string_view line) { return daemon.on_control(line); });
  if (!opened && place.requested_explicitly) return std::unexpected(opened.error());
  if (!opened) {
    log(LogLevel::kWarning, "runs without peerd ctl: " + opened.error().text);
    return nullptr;
  }
  log(LogLevel::kInfo, fmt::format("listens for peerd ctl at {}", place.socket.string()));
  return opened;
}

// Returns what loads the images of the world. A world that another peer has sent comes without the images that its
// files name, but with those that stand in its files.
view::ImageLoader images_for(const PeerOptions& options, const config::Scenario& scenario) {
  if (options.joined) return view::images_of({}, {});
  return view::images_of(local_files(view::kImage_bytes), scenario.world.string());
}

// The result is null where nobody has asked for a viewer.
Result<std::unique_ptr<gateway::Gateway>> open_gateway(asio::io_context& io, const PeerOptions& options,
                                                       const config::GatewaySettings& settings,
                                                       gateway::GatewaySource& source, Log& log) {
  const std::string& listen = options.view ? *options.view : settings.listen;
  if (listen.empty()) return nullptr;
  const auto at = gateway::listen_address(listen, settings.beyond_loopback);
  if (!at) return std::unexpected(at.error());
  for (const std::string& origin : settings.origins) {
    if (gateway::is_origin(origin)) continue;
    return std::unexpected(InputError{"error: gateway.origins has \"" + printable(origin, 80) +
                                      "\", which is no origin such as \"http://localhost:5173\""});
  }
  auto opened = gateway::Gateway::open(io, source,
                                       {.at = *at,
                                        .assets = gateway::built_viewer(),
                                        .token = gateway::make_token(),
                                        .origins = settings.origins,
                                        .log = [&log](const LogLine& line) { log(line); }});
  if (!opened) return opened;
  log(LogLevel::kInfo, "the viewer is at " + (*opened)->url());
  if (gateway::built_viewer().empty()) log(LogLevel::kWarning, "this program was built without the viewer's page");
  if (!at->address().is_loopback()) {
    log(LogLevel::kWarning,
        "other computers can reach it, and nothing is encrypted: whoever listens in gets the token and may then change "
        "everything that this peer may");
  }
  return opened;
}

// Events and counters of the peer reach the gateway's clients, and its control protocol says where the page is.
void connect(Daemon& daemon, gateway::Gateway& gateway) {
  daemon.publish_to(gateway);
  daemon.serves_viewer_at(gateway.url());
  daemon.add_to_status([&gateway] { return control::More{gateway.counters().named()}; });
}

// The result is null where the peer takes no poses by UDP.
Result<std::unique_ptr<net::UdpPort>> open_pose_port(asio::io_context& io, const config::PeerSettings& settings,
                                                     Daemon& daemon, Log& log) {
  if (settings.feed.udp.empty()) return nullptr;
  auto opened = net::UdpPort::open(io, settings.feed.udp, "peer." + settings.name + ".feed.udp",
                                   [&daemon](std::string_view datagram) { daemon.on_poses(datagram); });
  if (!opened) return opened;
  const auto endpoint = (*opened)->endpoint();
  log(LogLevel::kInfo,
      fmt::format("takes poses by UDP at {} port {}", endpoint.address().to_string(), endpoint.port()));
  if (!endpoint.address().is_loopback()) {
    log(LogLevel::kWarning, "whoever reaches that port, from other computers too, moves this peer's objects");
  }
  return opened;
}

// Logs requests and poses that were refused or lost.
void log_refused(const control::ControlServer* control, const net::UdpPort* poses, Log& log) {
  if (control) {
    const control::ControlServer::Counters& c = control->counters();
    if (c.strangers > 0) {
      log(LogLevel::kWarning,
          fmt::format("control: {} clients were of other users, and got no answer: who may open the socket's file?",
                      c.strangers));
    }
    if (c.refused + c.too_long + c.too_slow > 0) {
      log(LogLevel::kWarning, fmt::format("control: {} of {} clients were one too many, {} sent no end of line, {} did "
                                          "not read their reply",
                                          c.refused, c.clients, c.too_long, c.too_slow));
    }
  }
  if (poses && poses->counters().lost + poses->counters().errors > 0) {
    log(LogLevel::kWarning,
        fmt::format("poses: {} of {} datagrams were lost for want of room, {} reads failed", poses->counters().lost,
                    poses->counters().datagrams + poses->counters().lost, poses->counters().errors));
  }
}

}  // namespace

PeerPorts::PeerPorts(asio::io_context& io, const PeerOptions& options, const PeerParts& parts, Daemon& daemon,
                     PeerNode& node, Log& log)
    : log_(log), viewed_(io, daemon, node, parts.world_name(options), images_for(options, parts.scenario)) {}

PeerPorts::~PeerPorts() = default;

Result<std::unique_ptr<PeerPorts>> PeerPorts::open(asio::io_context& io, const PeerOptions& options,
                                                   const PeerParts& parts, Daemon& daemon, PeerNode& node, Log& log) {
  std::unique_ptr<PeerPorts> ports(new PeerPorts(io, options, parts, daemon, node, log));
  const config::RunSettings& run = parts.run();
  const config::PeerSettings& settings = *parts.settings;
  auto control = open_control(io, control_place(options, run.control, settings, log), daemon, log);
  if (!control) return std::unexpected(control.error());
  ports->control_ = *std::move(control);
  if (ports->control_) daemon.publish_to(*ports->control_);
  auto gateway = open_gateway(io, options, run.gateway, ports->viewed_, log);
  if (!gateway) return std::unexpected(gateway.error());
  ports->gateway_ = *std::move(gateway);
  if (ports->gateway_) connect(daemon, *ports->gateway_);
  auto poses = open_pose_port(io, settings, daemon, log);
  if (!poses) return std::unexpected(poses.error());
  ports->poses_ = *std::move(poses);
  return ports;
}

void PeerPorts::close() {
  log_refused(control_.get(), poses_.get(), log_);
  control_.reset();
  gateway_.reset();
}

}  // namespace peerd
