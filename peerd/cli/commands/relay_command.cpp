#include "peerd/cli/commands/relay_command.hpp"

#include <csignal>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include <spdlog/fmt/fmt.h>
#include <boost/asio/signal_set.hpp>

#include "peerd/cli/shell/print.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/net/keys/session_key.hpp"
#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/os/service_manager.hpp"
#include "peerd/net/relay/island.hpp"
#include "peerd/net/relay/mesh.hpp"
#include "peerd/net/relay/relay.hpp"
#include "peerd/net/relay/relay_report.hpp"
#include "peerd/net/seal/relay_key.hpp"
#include "peerd/net/seal/sealed_greetings.hpp"
#include "peerd/net/transport/open_transport.hpp"
#include "peerd/net/transport/transport_options.hpp"

namespace peerd {
namespace {

namespace asio = boost::asio;
using seal::SealedGreetings;

constexpr std::chrono::milliseconds kServiceStep{500};
constexpr int kReceiveBuffer_bytes = 4 * 1024 * 1024;

// Runs one relay until a signal ends it.
class RelayRun {
 public:
  explicit RelayRun(const RelayCommandOptions& options)
      : options_(options),
        log_("relay", {.format = options.log}, [this] { return clock_.now(); }),
        signals_(io_, SIGINT, SIGTERM),
        timer_(io_),
        manager_(net::ServiceManager::of_environment()) {}

  Result<void> open();
  int run();

 private:
  Result<void> read_seal();
  Result<void> open_relay(const net::GroupPlan& plan);
  Result<void> open_networks(const net::GroupPlan& plan);
  void say(LogLevel level, const std::string& text) { log_(level, text); }
  void follow_key_file();
  void step();
  void report();

  const RelayCommandOptions& options_;
  asio::io_context io_{1};
  net::HostClock clock_;
  Log log_;
  std::shared_ptr<SealedGreetings> seal_;
  std::filesystem::file_time_type key_seen_{};
  std::unique_ptr<relay::Relay> relay_;
  asio::signal_set signals_;
  asio::steady_timer timer_;
  net::ServiceManager manager_;
  HostTime reported_{};
};

Result<void> RelayRun::read_seal() {
  const int said = int{!options_.world.empty()} + int{!options_.relay_key.empty()} + int{options_.open} +
                   int{!options_.key.empty() && options_.world.empty()};
  if (said != 1) {
    return std::unexpected(InputError{
        "error: say whose greetings it takes: --relay-key FILE (peerd invite WORLD --relay makes the line in it), "
        "--world NAME or --key FILE where this user has the session's key, or --open for a session that is not sealed",
        kWrongUse});
  }
  if (options_.open) return {};
  std::optional<keys::SymmetricKey> key;
  if (!options_.relay_key.empty()) {
    auto read = seal::read_relay_key(options_.relay_key);
    if (!read) return std::unexpected(read.error());
    key = *read;
    std::error_code failed;
    key_seen_ = std::filesystem::last_write_time(options_.relay_key, failed);
  } else {
    const auto session =
        keys::session_key({.key_file = options_.key, .password_file = {}}, options_.world, keys::IfMissing::kFail);
    if (!session) return std::unexpected(session.error());
    key = SealedGreetings::key_of(session->key);
  }
  seal_ = std::make_shared<SealedGreetings>(*key, [this](const std::string& line) { say(LogLevel::kWarning, line); });
  return {};
}

Result<void> RelayRun::open() {
  if (auto read = read_seal(); !read) return read;
  const auto plan =
      net::parse_group_plan(options_.group, static_cast<std::uint16_t>(options_.group_port), options_.group_pool);
  if (!plan) return std::unexpected(input_error(plan.error()));
  if (auto opened = open_relay(*plan); !opened) return opened;
  return open_networks(*plan);
}

Result<void> RelayRun::open_relay(const net::GroupPlan& plan) {
  const net::IpFamily family = plan.base.is_v4() ? net::IpFamily::kV4 : net::IpFamily::kV6;
  auto parents = net::resolve_peers(options_.parents, family, "--parent");
  if (!parents) return std::unexpected(input_error(parents.error()));
  relay::RelayOptions options{.family = family,
                              .port = static_cast<std::uint16_t>(options_.port),
                              .parents = *std::move(parents),
                              .key = net::random_key(),
                              .seal = seal_,
                              .budget_bytes_per_s = options_.budget_kib_s * 1024.0,
                              .dscp = static_cast<int>(options_.dscp),
                              .receive_buffer_bytes = kReceiveBuffer_bytes};
  auto opened = relay::Relay::open(io_, clock_, options, [this](bool is_warning, const std::string& sentence) {
    say(is_warning ? LogLevel::kWarning : LogLevel::kInfo, sentence);
  });
  if (!opened) return std::unexpected(input_error(opened.error()));
  relay_ = *std::move(opened);
  return {};
}

Result<void> RelayRun::open_networks(const net::GroupPlan& plan) {
  for (const std::string& interface : options_.islands) {
    relay::IslandOptions options{
        .multicast = {}, .instance = relay_->instance(), .key = net::random_key(), .seal = seal_};
    options.multicast.interface = interface;
    options.multicast.groups = plan;
    options.multicast.ttl = static_cast<int>(options_.ttl);
    options.multicast.dscp = static_cast<int>(options_.dscp);
    options.multicast.receives_own_datagrams = false;
    options.multicast.receive_buffer_bytes = kReceiveBuffer_bytes;
    auto island = relay::Island::open(io_, clock_, options);
    if (!island) return std::unexpected(input_error(island.error()));
    relay_->add(*std::move(island));
  }
  if (options_.mesh_port == 0) {
    if (options_.mesh.empty()) return {};
    return std::unexpected(InputError{"error: --mesh wants --mesh-port, the relay's own port in the mesh", kWrongUse});
  }
  const net::IpFamily family = plan.base.is_v4() ? net::IpFamily::kV4 : net::IpFamily::kV6;
  auto seeds = net::resolve_peers(options_.mesh, family, "--mesh");
  if (!seeds) return std::unexpected(input_error(seeds.error()));
  auto mesh = relay::Mesh::open(io_, clock_,
                                {.family = family,
                                 .port = static_cast<std::uint16_t>(options_.mesh_port),
                                 .seeds = *std::move(seeds),
                                 .key = net::random_key(),
                                 .seal = seal_,
                                 .dscp = static_cast<int>(options_.dscp),
                                 .receive_buffer_bytes = kReceiveBuffer_bytes});
  if (!mesh) return std::unexpected(input_error(mesh.error()));
  relay_->add(*std::move(mesh));
  return {};
}

int RelayRun::run() {
  say(LogLevel::kInfo, fmt::format("port {}, instance {:08x}{}", relay_->port(), relay_->instance(),
                                   seal_ ? ", greetings are sealed" : ""));
  if (!seal_) say(LogLevel::kWarning, "open: whoever reaches that port can listen, and speak as any peer");
  for (const auto& network : relay_->networks()) say(LogLevel::kInfo, "joins " + network->describe());
  relay_->start();
  signals_.async_wait([this](const boost::system::error_code& ec, int signal) {
    if (ec) return;
    say(LogLevel::kInfo, fmt::format("leaving: got {}", signal == SIGINT ? "SIGINT" : "SIGTERM"));
    io_.stop();
  });
  if (const auto told = manager_.ready(); !told) say(LogLevel::kWarning, told.error().text);
  reported_ = clock_.now();
  step();
  io_.run();
  if (const auto told = manager_.stopping(); !told) say(LogLevel::kWarning, told.error().text);
  report();
  relay_.reset();
  return 0;
}

// An administrator's new epoch has another relay key: who renews the file need not start the relay anew.
void RelayRun::follow_key_file() {
  if (options_.relay_key.empty()) return;
  std::error_code failed;
  const auto changed = std::filesystem::last_write_time(options_.relay_key, failed);
  if (failed || std::exchange(key_seen_, changed) == changed) return;
  const auto key = seal::read_relay_key(options_.relay_key);
  if (!key) return say(LogLevel::kWarning, key.error().text);
  seal_->rekey(*key);
  say(LogLevel::kInfo, "takes greetings by the new key in " + options_.relay_key.string());
}

void RelayRun::step() {
  follow_key_file();
  log_.report_left_out();
  if (const auto told = manager_.alive(); !told) say(LogLevel::kWarning, told.error().text);
  const HostTime now = clock_.now();
  if (options_.report_s > 0.0 && now - reported_ >= from_seconds(options_.report_s)) {
    reported_ = now;
    report();
  }
  timer_.expires_after(kServiceStep);
  timer_.async_wait([this](const boost::system::error_code& ec) {
    if (!ec) step();
  });
}

void RelayRun::report() {
  if (options_.json) {
    std::cout << json_line(relay::report_of(*relay_)) << '\n' << std::flush;
  } else {
    say(LogLevel::kInfo, relay::line_of(*relay_));
  }
}

}  // namespace

int run_relay(const RelayCommandOptions& options) {
  RelayRun run(options);
  if (const auto opened = run.open(); !opened) return failed(opened.error());
  return run.run();
}

}  // namespace peerd
