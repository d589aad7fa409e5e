#include "peerd/commands/doctor_command.hpp"

#include <iostream>
#include <optional>

#include <spdlog/fmt/fmt.h>
#include <boost/asio/io_context.hpp>
#include <nlohmann/json.hpp>

#include "peerd/commands/print.hpp"
#include "peerd/commands/problems.hpp"
#include "peerd/config/renamed_keys.hpp"
#include "peerd/input/printable.hpp"
#include "peerd/os/host_clock.hpp"
#include "peerd/transport/multicast_probe.hpp"
#include "peerd/transport/transport_options.hpp"

namespace peerd {
namespace {

using nlohmann::ordered_json;

// A warning where an assignment is to no key of [transport], which alone counts here; empty where it is.
std::string why_without_effect(const std::string& key) {
  const std::string table = key.substr(0, key.find('.')), last = key.substr(key.rfind('.') + 1);
  if (table == "transport") return "";
  std::string warning = "warning: --set " + key + " has no effect: the table [transport] alone counts here";
  // The reader of [transport] knows which keys it has.
  std::optional<InputError> unknown;
  const toml::table probe{{last, "\n"}};
  (void)config::read_transport(config::TomlReader(probe, "transport", unknown));
  if (!unknown || !unknown->text.contains("unknown key")) warning += "; did you mean transport." + last + "?";
  return warning;
}

// Reads the table [transport] alone: the rest of a scenario says nothing about the network.
Result<config::TransportSettings> read_settings(const DoctorOptions& options) {
  toml::table root;
  std::vector<std::string> warnings;
  if (!options.config.empty()) {
    auto file = config::read_toml(options.config);
    if (!file) return std::unexpected(file.error());
    root = *std::move(file);
  }
  if (auto done = config::rename_old_keys(root, warnings); !done) return std::unexpected(done.error());
  for (const std::string& text : options.sets) {
    auto given = config::parse_assignment(text);
    if (!given) return std::unexpected(given.error());
    if (auto done = config::rename_old_keys(*given, warnings); !done) return std::unexpected(done.error());
    if (std::string warning = why_without_effect(given->key); !warning.empty()) warnings.push_back(std::move(warning));
    if (auto done = config::assign(root, given->key, *given->holder.get("value")); !done)
      return std::unexpected(done.error());
  }
  print_warnings(warnings);
  std::optional<InputError> error;
  config::TomlReader reader(root, "", error);
  static const toml::table kEmpty;
  const toml::table* const transport = reader.table("transport");
  auto settings = config::read_transport(config::TomlReader(transport ? *transport : kEmpty, "transport", error));
  if (error) return std::unexpected(*error);
  return settings;
}

constexpr int kFinding = 1;

// How peers of several computers meet without multicast. Each lists the others.
constexpr std::string_view kUnicastRecipe =
    "name the interface (--interface NAME), or list the other computers' peers by HOST:PORT: "
    "--set 'transport.peers=[\"192.0.2.7:47474\"]'";

// The results of trying what a peer with these settings would do.
struct Findings {
  std::optional<std::expected<net::ProbeResult, net::NetError>> probe;  // none: multicast is switched off
  std::string transport;  // transport that a peer would use, in words; empty: it could not run
  std::string kind;       // "multicast", "unicast" or empty
  std::string problem;    // reason why it could not run
  std::string only_here;  // reason why it would reach no other computer; empty: it may
  int receive_buffer_bytes = 0;
  int exit_code = 0;
};

Findings examine(const net::TransportOptions& options) {
  Findings f;
  const net::HostClock clock;
  boost::asio::io_context io(1);
  if (options.use != net::MulticastUse::kNever) f.probe = net::probe_multicast(clock, options.multicast);
  if (f.probe && !*f.probe && options.use == net::MulticastUse::kAlways) {
    f.problem = f.probe->error().sentence;
    f.exit_code = input_error(f.probe->error()).exit_code;
    return f;
  }
  const auto opened = net::open_transport(io, clock, options);
  if (!opened) {
    f.problem = opened.error().sentence;
    f.exit_code = input_error(opened.error()).exit_code;
    return f;
  }
  f.transport = opened->transport->describe();
  f.kind = opened->why_unicast.empty() ? "multicast" : "unicast";
  f.receive_buffer_bytes = opened->transport->receive_buffer_bytes();
  f.only_here = opened->why_only_here;
  if (!f.only_here.empty()) f.exit_code = kFinding;
  return f;
}

ordered_json as_json(const Findings& f, const config::TransportSettings& settings) {
  ordered_json multicast = {{"tried", f.probe.has_value()}, {"works", f.probe && *f.probe}};
  ordered_json interface = nullptr, memberships = nullptr;
  if (f.probe && *f.probe) {
    const net::ProbeResult& p = **f.probe;
    interface = {{"name", p.over.interface.name}, {"why", p.over.why}};
    multicast["took_us"] = to_seconds(p.took) * 1e6;
    multicast["kernel_stamps"] = p.stamped;
    if (p.memberships_max) memberships = *p.memberships_max;
  } else if (f.probe) {
    multicast["problem"] = f.probe->error().sentence;
  }
  ordered_json all = {
      {"interface", interface},
      {"multicast", multicast},
      {"memberships_of_a_socket", memberships},
      {"receive_buffer_bytes", {{"asked", settings.receive_buffer_bytes}, {"granted", f.receive_buffer_bytes}}},
      {"unicast_needed", !(f.probe && *f.probe) || !f.only_here.empty()},
      {"only_this_computer", !f.only_here.empty()},
      {"unicast_peers", settings.peers},
      {"transport", f.kind.empty() ? ordered_json(nullptr) : ordered_json(f.kind)}};
  if (!f.problem.empty()) all["problem"] = f.problem;
  return all;
}

std::string as_text(const Findings& f, const config::TransportSettings& settings) {
  std::string text;
  const auto line = [&](std::string_view what, const std::string& found) {
    text += fmt::format("{:<16}{}\n", what, found);
  };
  const bool works = f.probe && *f.probe;
  if (works) {
    const net::ProbeResult& p = **f.probe;
    line("interface", p.over.why);
    line("multicast", fmt::format("works on this computer: heard after {:.0f} us, {}stamped by the kernel",
                                  to_seconds(p.took) * 1e6, p.stamped ? "" : "not "));
    line("groups", p.memberships_max
                       ? fmt::format("{} for each socket; more sockets are opened for more groups", *p.memberships_max)
                       : "as many for each socket as its memory holds; more sockets are opened for more");
  } else {
    line("multicast",
         f.probe ? "doesn't work: " + f.probe->error().sentence : "not tried: transport.multicast says so");
  }
  if (!f.kind.empty()) {
    const std::string less = buffer_warning(settings, f.receive_buffer_bytes);
    line("receive buffer", less.empty() ? fmt::format("{} bytes, as asked", f.receive_buffer_bytes) : less);
  }
  const std::string configured = counted(settings.peers.size(), "peer");
  if (!f.only_here.empty()) {
    line("warning", "peers on other computers will not be heard: " + f.only_here);
    line("unicast", fmt::format("needed for other computers: {}", kUnicastRecipe));
  } else {
    line("unicast", works ? "not needed" : fmt::format("needed; {} configured (transport.peers)", configured));
  }
  line("a peer", f.problem.empty() ? "would run: " + f.transport : "could not run: " + f.problem);
  return text;
}

}  // namespace

int run_doctor(const DoctorOptions& options) {
  const auto settings = read_settings(options);
  if (!settings) return failed(settings.error());
  const auto reach = transport_options(*settings, random_key());
  if (!reach) return failed(reach.error());
  const Findings found = examine(*reach);
  if (options.json) {
    std::cout << as_json(found, *settings).dump(2, ' ', false, ordered_json::error_handler_t::replace) << '\n';
  } else {
    std::cout << as_text(found, *settings);
  }
  return found.exit_code;
}

}  // namespace peerd
