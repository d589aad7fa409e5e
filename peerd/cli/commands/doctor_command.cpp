#include "peerd/cli/commands/doctor_command.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <iostream>
#include <optional>

#include <spdlog/fmt/fmt.h>
#include <boost/asio/io_context.hpp>
#include <nlohmann/json.hpp>

#include "peerd/cli/client/peer_replies.hpp"
#include "peerd/cli/shell/print.hpp"
#include "peerd/cli/shell/problems.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/input/printable.hpp"
#include "peerd/net/discovery/discovery.hpp"
#include "peerd/net/doctor/host_findings.hpp"
#include "peerd/net/doctor/pair_findings.hpp"
#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/transport/multicast_probe.hpp"
#include "peerd/net/transport/transport_options.hpp"
#include "peerd/peer/config/peer_settings.hpp"
#include "peerd/peer/config/renamed_keys.hpp"
#include "peerd/peer/control/control_path.hpp"

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
  (void)config::read_transport(TomlReader(probe, "transport", unknown));
  if (!unknown || !unknown->text.contains("unknown key")) warning += "; did you mean transport." + last + "?";
  return warning;
}

// Reads the table [transport] alone: the rest of a scenario says nothing about the network.
Result<net::TransportSettings> read_settings(const DoctorOptions& options) {
  toml::table root;
  std::vector<std::string> warnings;
  if (!options.config.empty()) {
    auto file = read_toml(options.config);
    if (!file) return std::unexpected(file.error());
    root = *std::move(file);
  }
  if (auto done = config::rename_old_keys(root, warnings); !done) return std::unexpected(done.error());
  for (const std::string& text : options.sets) {
    auto given = parse_assignment(text);
    if (!given) return std::unexpected(given.error());
    if (auto done = config::rename_old_keys(*given, warnings); !done) return std::unexpected(done.error());
    if (std::string warning = why_without_effect(given->key); !warning.empty()) warnings.push_back(std::move(warning));
    if (auto done = assign(root, given->key, *given->holder.get("value")); !done) return std::unexpected(done.error());
  }
  print_warnings(warnings);
  std::optional<InputError> error;
  TomlReader reader(root, "", error);
  static const toml::table kEmpty;
  const toml::table* const transport = reader.table("transport");
  auto settings = config::read_transport(TomlReader(transport ? *transport : kEmpty, "transport", error));
  if (error) return std::unexpected(*error);
  return settings;
}

// The results of trying what a peer with these settings would do.
struct Tried {
  std::optional<std::expected<net::ProbeResult, net::NetError>> probe;  // none: nobody would use multicast
  std::string transport;  // transport that a peer would use, in words; empty: it could not run
  std::string kind;       // "multicast", "unicast", "relay", "nats" or empty
  std::string problem;    // reason why it could not run
  int problem_exit_code = 0;
  int receive_buffer_bytes = 0;

  [[nodiscard]] bool multicast_works() const { return probe && *probe; }
  void fail(const net::NetError& error) {
    problem = error.sentence;
    problem_exit_code = input_error(error).exit_code;
  }
};

// The key that says through what a peer reaches all others; empty: it multicasts, or sends to each of them.
std::string through(const net::TransportSettings& settings) {
  if (!settings.nats.servers.empty()) return "transport.nats";
  return settings.relays.empty() ? "" : "transport.relays";
}

// The addresses, as HOST:PORT, that a peer sends to first where it does not multicast.
std::vector<std::string> first_reached(const net::TransportSettings& settings) {
  if (settings.nats.servers.empty()) return settings.relays.empty() ? settings.peers : settings.relays;
  std::vector<std::string> servers;
  for (const std::string& server : settings.nats.servers) {
    const auto url = net::parse_server_url(server);
    assert(url && "read_transport() has refused any other");
    const bool is_ipv6 = url->host.find(':') != std::string::npos;
    servers.push_back(fmt::format(fmt::runtime(is_ipv6 ? "[{}]:{}" : "{}:{}"), url->host, url->port));
  }
  return servers;
}

Tried try_transport(const net::HostClock& clock, const net::TransportOptions& options,
                    const net::TransportSettings& settings) {
  Tried t;
  if (!settings.nats.servers.empty()) {
    t.kind = "nats";
    t.transport = fmt::format("NATS at {}", fmt::join(first_reached(settings), ", "));
    t.receive_buffer_bytes = static_cast<int>(settings.receive_buffer_bytes);
    return t;
  }
  boost::asio::io_context io(1);
  const bool by_relay = !settings.relays.empty();
  if (!by_relay && options.use != net::MulticastUse::kNever) t.probe = net::probe_multicast(clock, options.multicast);
  if (t.probe && !*t.probe && options.use == net::MulticastUse::kAlways) {
    t.fail(t.probe->error());
    return t;
  }
  const auto opened = net::open_transport(io, clock, options);
  if (!opened) {
    t.fail(opened.error());
    return t;
  }
  t.transport = opened->transport->describe();
  t.kind = by_relay ? "relay" : opened->unicast() ? "unicast" : "multicast";
  t.receive_buffer_bytes = opened->transport->receive_buffer_bytes();
  return t;
}

doctor::Examined examined(const Tried& tried, const net::TransportOptions& options,
                          const net::TransportSettings& settings) {
  using Transport = doctor::Examined::Transport;
  const net::GroupPlan& groups = options.multicast.groups;
  doctor::Examined e{.ipv6 = groups.base.is_v6(),
                     .ttl = options.multicast.ttl,
                     .port = groups.port,
                     .snapshot_port = settings.snapshot_port};
  if (settings.discoverable) e.discovery_port = discovery::group_for(groups.base).port;
  e.problem = tried.problem;
  if (!tried.kind.empty()) e.transport = tried.kind == "multicast" ? Transport::kMulticast : Transport::kUnicast;
  if (tried.multicast_works()) {
    e.interface = (*tried.probe)->over.interface.name;
    e.why_interface = (*tried.probe)->over.why;
  }
  return e;
}

// The facts of this computer; routes where a peer would not use multicast.
std::expected<doctor::HostFacts, net::NetError> facts_of(const net::HostClock& clock, const Tried& tried,
                                                         const net::TransportOptions& options,
                                                         const net::TransportSettings& settings,
                                                         const doctor::OtherPorts& ports) {
  std::vector<doctor::NamedPeer> peers;
  if (!tried.kind.empty() && tried.kind != "multicast") {
    const auto family = options.multicast.groups.base.is_v4() ? net::IpFamily::kV4 : net::IpFamily::kV6;
    const std::vector<std::string> named = first_reached(settings);
    const std::string key = through(settings);
    const auto addresses = net::resolve_peers(named, family, key.empty() ? "transport.peers" : key);
    if (!addresses) return std::unexpected(addresses.error());
    for (std::size_t i = 0; i < addresses->size(); ++i) peers.push_back({named[i], (*addresses)[i]});
  }
  return doctor::read_host_facts(clock, peers, ports);
}

// All that is printed.
struct Report {
  Tried tried;
  std::vector<doctor::Finding> findings;
  std::optional<doctor::PairOutcome> with;

  // Whether a peer would run, and reach this computer only.
  [[nodiscard]] bool only_here() const {
    if (with) return !doctor::any_path_works(*with);
    return !tried.kind.empty() && std::ranges::any_of(findings, [](const doctor::Finding& f) {
      return f.name == "reach" && f.level == doctor::Level::kWarning;
    });
  }
  [[nodiscard]] bool unicast_needed() const {
    if (tried.kind == "relay" || tried.kind == "nats") return false;
    return !tried.multicast_works() || only_here() || (with && !doctor::multicast_works(*with));
  }
};

ordered_json as_json(const Report& report, const net::TransportSettings& settings) {
  const Tried& t = report.tried;
  ordered_json multicast = {{"tried", t.probe.has_value()}, {"works", t.multicast_works()}};
  ordered_json interface = nullptr, memberships = nullptr;
  if (t.multicast_works()) {
    const net::ProbeResult& p = **t.probe;
    interface = {{"name", p.over.interface.name}, {"why", p.over.why}};
    multicast["took_us"] = to_seconds(p.took) * 1e6;
    multicast["kernel_stamps"] = p.stamped;
    if (p.memberships_max) memberships = *p.memberships_max;
  } else if (t.probe) {
    multicast["problem"] = t.probe->error().sentence;
  }
  ordered_json all = {
      {"interface", interface},
      {"multicast", multicast},
      {"memberships_of_a_socket", memberships},
      {"receive_buffer_bytes", {{"asked", settings.receive_buffer_bytes}, {"granted", t.receive_buffer_bytes}}},
      {"unicast_needed", report.unicast_needed()},
      {"only_this_computer", report.only_here()},
      {"unicast_peers", settings.peers},
      {"transport", t.kind.empty() ? ordered_json(nullptr) : ordered_json(t.kind)},
      {"findings", doctor::as_json(report.findings)}};
  if (!t.problem.empty()) all["problem"] = t.problem;
  if (report.with) all["with"] = doctor::as_json(*report.with);
  return all;
}

std::string as_text(const Report& report, const net::TransportSettings& settings) {
  const Tried& t = report.tried;
  std::string text;
  const auto line = [&](std::string_view what, const std::string& found) {
    text += fmt::format("{:<16}{}\n", what, found);
  };
  const bool works = t.multicast_works();
  if (works) {
    const net::ProbeResult& p = **t.probe;
    line("interface", p.over.why);
    line("multicast", fmt::format("works on this computer: heard after {:.0f} us, {}stamped by the kernel",
                                  to_seconds(p.took) * 1e6, p.stamped ? "" : "not "));
    line("groups", p.memberships_max
                       ? fmt::format("{} for each socket; more sockets are opened for more groups", *p.memberships_max)
                       : "as many for each socket as its memory holds; more sockets are opened for more");
  } else {
    line("multicast", t.probe ? "doesn't work: " + t.probe->error().sentence
                              : fmt::format("not tried: {} says so",
                                            through(settings).empty() ? "transport.multicast" : through(settings)));
  }
  if (!t.kind.empty()) {
    const std::string less = net::buffer_warning(settings, t.receive_buffer_bytes);
    line("receive buffer", less.empty() ? fmt::format("{} bytes, as asked", t.receive_buffer_bytes) : less);
  }
  const std::string needed = works ? "needed for other computers" : "needed";
  line("unicast", report.unicast_needed() ? fmt::format("{}; {} configured (transport.peers)", needed,
                                                        counted(settings.peers.size(), "peer"))
                                          : "not needed");
  text += doctor::as_text(report.findings);
  if (t.problem.empty()) line("a peer", "would run: " + t.transport);
  return text;
}

std::uint64_t random_session() {
  std::uint64_t session = 0;
  while (session == 0) {
    const net::SipKey key = net::random_key();
    std::memcpy(&session, &key, sizeof session);
  }
  return session;
}

std::expected<doctor::PairOutcome, net::NetError> try_with(const net::HostClock& clock, const DoctorOptions& options,
                                                           const net::TransportOptions& transport,
                                                           const net::TransportSettings& settings) {
  return doctor::run_pair(clock, {.transport = transport,
                                  .snapshot_port = settings.snapshot_port,
                                  .host = options.with,
                                  .wait = from_seconds(options.wait_s),
                                  .session = random_session(),
                                  .say = [](const std::string& text) { std::cerr << text << '\n'
                                                                                 << std::flush; }});
}

// The troubles of this user's peers that run here, as they say them.
std::vector<doctor::Finding> findings_of_peers() {
  std::vector<doctor::Finding> all;
  for (const auto& socket : control::all_sockets()) {
    const auto status = ask_peer(socket, R"({"do":"status"})");
    if (!status || !status->contains("troubles")) continue;  // it has just ended, or is of another version
    for (const auto& trouble : status->at("troubles")) {
      all.push_back(
          {"peer", doctor::Level::kWarning,
           fmt::format("peer {} {}", status->at("peer").at("name").get<std::string>(), trouble.get<std::string>())});
    }
  }
  return all;
}

}  // namespace

int run_doctor(const DoctorOptions& options) {
  auto settings = read_settings(options);
  if (!settings) return failed(settings.error());
  (void)net::takes_ipv6(*settings, Duration{0});  // as a peer would; the report has the interface and the group
  const auto reach = net::transport_options(*settings, net::random_key());
  if (!reach) return failed(reach.error());
  const net::HostClock clock;
  Report report{try_transport(clock, *reach, *settings), {}, {}};
  doctor::Examined seen = examined(report.tried, *reach, *settings);
  const auto facts = facts_of(clock, report.tried, *reach, *settings, {seen.discovery_port, seen.snapshot_port});
  if (!facts) return failed(input_error(facts.error()));
  seen.with_another = !options.with.empty();
  report.findings = doctor::host_findings(*facts, seen);
  std::ranges::move(findings_of_peers(), std::back_inserter(report.findings));
  int exit_code = report.tried.problem.empty() ? doctor::exit_code_of(report.findings) : report.tried.problem_exit_code;
  if (seen.with_another) {
    auto outcome = try_with(clock, options, *reach, *settings);
    if (!outcome) return failed(input_error(outcome.error()));
    report.with = *std::move(outcome);
    // The pair decides by what was seen between the two, and not by what this computer alone could guess.
    std::erase_if(report.findings, [](const doctor::Finding& f) { return f.name == "reach"; });
    std::ranges::move(doctor::pair_findings(*report.with), std::back_inserter(report.findings));
    exit_code = doctor::exit_code_of(report.findings);
  }
  if (options.json) {
    std::cout << json_text(as_json(report, *settings)) << '\n';
  } else {
    std::cout << as_text(report, *settings);
  }
  return exit_code;
}

}  // namespace peerd
