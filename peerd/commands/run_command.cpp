#include "peerd/commands/run_command.hpp"

#include <algorithm>
#include <cassert>
#include <chrono>
#include <iostream>
#include <iterator>
#include <random>
#include <string>
#include <utility>

#include <spdlog/fmt/fmt.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <boost/asio/io_context.hpp>
#include <nlohmann/json.hpp>

#include "peerd/commands/print.hpp"
#include "peerd/config/shared_settings.hpp"
#include "peerd/control/control_path.hpp"
#include "peerd/control/control_server.hpp"
#include "peerd/daemon/cache_warmer.hpp"
#include "peerd/daemon/daemon.hpp"
#include "peerd/daemon/join_service.hpp"
#include "peerd/daemon/viewed_peer.hpp"
#include "peerd/gateway/access.hpp"
#include "peerd/gateway/gateway.hpp"
#include "peerd/gateway/listen_address.hpp"
#include "peerd/input/json_line.hpp"
#include "peerd/input/world_file.hpp"
#include "peerd/node/describe.hpp"
#include "peerd/node/peer_node.hpp"
#include "peerd/os/host_clock.hpp"
#include "peerd/os/udp_port.hpp"
#include "peerd/picture/picture_input.hpp"
#include "peerd/record/capture.hpp"
#include "peerd/record/recorded_transport.hpp"
#include "peerd/record/recording_signer.hpp"
#include "peerd/running/peer_store.hpp"
#include "peerd/running/session_seal.hpp"
#include "peerd/seal/operation_signer.hpp"
#include "peerd/transport/transport_options.hpp"

namespace peerd {
namespace {

namespace asio = boost::asio;

// Writes one line for each fact: text with the time and the level, or one JSON object.
class Log {
 public:
  Log(std::string peer, bool json, bool verbose)
      : logger_(json ? json_line(peer) : std::move(peer), std::make_shared<spdlog::sinks::stdout_sink_st>()),
        json_(json) {
    logger_.set_level(verbose ? spdlog::level::debug : spdlog::level::info);
    logger_.flush_on(spdlog::level::trace);  // a reader may follow it
    logger_.set_pattern(json ? R"({"time":"%Y-%m-%dT%H:%M:%S.%e%z","peer":%n,"level":"%l","text":%v})"
                             : "%H:%M:%S.%e %-7l %n: %v");
  }
  void operator()(const LogLine& line) { (*this)(level_of(line.level), line.text); }
  void operator()(spdlog::level::level_enum level, const std::string& text) {
    logger_.log(level, json_ ? json_line(text) : text);
  }

 private:
  static spdlog::level::level_enum level_of(LogLevel level) {
    switch (level) {
      case LogLevel::kDebug:
        return spdlog::level::debug;
      case LogLevel::kInfo:
        return spdlog::level::info;
      case LogLevel::kWarning:
        return spdlog::level::warn;
      case LogLevel::kError:
        return spdlog::level::err;
    }
    return spdlog::level::err;
  }

  spdlog::logger logger_;
  bool json_;
};

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
  if (const auto made = api::make_runtime_folder(); !made) {
    log(spdlog::level::warn, "runs without peerd ctl: " + made.error().text);
    return {};
  }
  return {api::default_socket(peer.name, peer.id), false};
}

Result<const config::PeerSettings*> choose_peer(const config::RunSettings& run, const std::string& name) {
  std::string all;
  std::vector<std::string> names;
  for (const config::PeerSettings& p : run.peers) {
    if (p.name == name || (name.empty() && run.peers.size() == 1)) return &p;
    all += (all.empty() ? "" : ", ") + p.name;
    names.push_back(p.name);
  }
  if (name.empty()) return std::unexpected(InputError{"error: which peer? Say --peer NAME; there are " + all});
  return std::unexpected(InputError{"error: there is no peer \"" + name + "\"; there are " + all});
}

// The result is null where no capture is asked for.
Result<std::unique_ptr<record::CaptureWriter>> open_capture(const PeerOptions& options,
                                                            const config::Scenario& scenario,
                                                            const config::PeerSettings& peer, const SharedWorld& shared,
                                                            const PeerNode::Options& node,
                                                            const net::OpenedTransport& reached, net::GroupPlan groups,
                                                            const SessionSeal& session_seal, HostTime now) {
  if (options.capture.empty()) return nullptr;
  // A unicast datagram goes to many addresses but stands in the capture once, as if all regions had one group.
  if (reached.unicast()) groups.pool = 1;
  auto setup =
      record::make_setup(scenario, scenario.runs.front(), peer, options.config, shared, node, std::move(groups));
  setup.roster = session_seal.roster();
  using Datagrams = record::Setup::Datagrams;
  setup.datagrams = node.sealed_by.empty() ? Datagrams::kOpen
                    : options.opened       ? Datagrams::kOpened
                                           : Datagrams::kSealed;
  return record::CaptureWriter::open(options.capture, setup, now, reached.transport->own_address());
}

// The result is null where the socket can't be opened and nobody has asked for it explicitly.
Result<std::unique_ptr<api::ControlServer>> open_control(asio::io_context& io, const ControlPlace& place,
                                                         Daemon& daemon, Log& log) {
  if (place.socket.empty()) return nullptr;
  auto opened =
      api::ControlServer::open(io, place.socket, [&daemon](std::string_view line) { return daemon.on_control(line); });
  if (!opened && place.requested_explicitly) return std::unexpected(opened.error());
  if (!opened) {
    log(spdlog::level::warn, "runs without peerd ctl: " + opened.error().text);
    return nullptr;
  }
  log(spdlog::level::info, fmt::format("listens for peerd ctl at {}", place.socket.string()));
  return opened;
}

// The images of a world that came from elsewhere have not come with it.
picture::ImageLoader images_for(const PeerOptions& options, const config::Scenario& scenario) {
  if (options.joined) return {};
  return picture::images_of(config::local_files(picture::kImage_bytes), scenario.world.string());
}

// The result is null where nobody has asked for a viewer.
Result<std::unique_ptr<gateway::Gateway>> open_gateway(asio::io_context& io, const PeerOptions& options,
                                                       const config::GatewaySettings& settings,
                                                       gateway::GatewaySource& source, Log& log) {
  const std::string& listen = options.view ? *options.view : settings.listen;
  if (listen.empty()) return nullptr;
  const auto at = gateway::listen_address(listen, settings.beyond_loopback);
  if (!at) return std::unexpected(at.error());
  auto opened = gateway::Gateway::open(io, source,
                                       {.at = *at,
                                        .assets = gateway::built_viewer(),
                                        .token = gateway::make_token(),
                                        .log = [&log](const LogLine& line) { log(line); }});
  if (!opened) return opened;
  log(spdlog::level::info, "the viewer is at " + (*opened)->url());
  if (gateway::built_viewer().empty()) log(spdlog::level::warn, "this program was built without the viewer's page");
  if (!at->address().is_loopback()) {
    log(spdlog::level::warn,
        "other computers can reach it, and nothing is encrypted: whoever listens in gets the token and may then change "
        "everything that this peer may");
  }
  return opened;
}

// The result is null where the peer takes no poses by UDP.
Result<std::unique_ptr<feed::UdpPort>> open_pose_port(asio::io_context& io, const config::PeerSettings& settings,
                                                      Daemon& daemon, Log& log) {
  if (settings.feed.udp.empty()) return nullptr;
  auto opened = feed::UdpPort::open(io, settings.feed.udp, "peer." + settings.name + ".feed.udp",
                                    [&daemon](std::string_view datagram) { daemon.on_poses(datagram); });
  if (!opened) return opened;
  const auto endpoint = (*opened)->endpoint();
  log(spdlog::level::info,
      fmt::format("takes poses by UDP at {} port {}", endpoint.address().to_string(), endpoint.port()));
  if (!endpoint.address().is_loopback()) {
    log(spdlog::level::warn, "whoever reaches that port, from other computers too, moves this peer's objects");
  }
  return opened;
}

// Logs requests and poses that were refused or lost.
void log_refused(const api::ControlServer* control, const feed::UdpPort* poses, Log& log) {
  if (control) {
    const api::ControlServer::Counters& c = control->counters();
    if (c.strangers > 0) {
      log(spdlog::level::warn,
          fmt::format("control: {} clients were of other users, and got no answer: who may open the socket's file?",
                      c.strangers));
    }
    if (c.refused + c.too_long + c.too_slow > 0) {
      log(spdlog::level::warn,
          fmt::format("control: {} of {} clients were one too many, {} sent no end of line, {} did "
                      "not read their reply",
                      c.refused, c.clients, c.too_long, c.too_slow));
    }
  }
  if (poses && poses->counters().lost + poses->counters().errors > 0) {
    log(spdlog::level::warn,
        fmt::format("poses: {} of {} datagrams were lost for want of room, {} reads failed", poses->counters().lost,
                    poses->counters().datagrams + poses->counters().lost, poses->counters().errors));
  }
}

InputError cut_off(const std::filesystem::path& capture) {
  return {capture.string() + ": error: can't be written to its end; is the disk full?", 3};
}

// Captures datagrams as they are on the network, unless they are open or somebody wants to have them opened: below the
// seal, and without the peer's inputs. Null: it does not.
std::unique_ptr<record::CaptureWriter> capture_sealed(std::unique_ptr<record::CaptureWriter>& capture,
                                                      const PeerOptions& options, bool is_sealed,
                                                      const net::HostClock& clock, net::OpenedTransport& reached,
                                                      Log& log) {
  if (!capture || !is_sealed || options.opened) return nullptr;
  auto writer = std::move(capture);
  reached.transport = std::make_unique<record::RecordedTransport>(std::move(reached.transport), *writer,
                                                                  [&clock] { return clock.now(); });
  log(spdlog::level::warn, "records datagrams as they are on the network, sealed; --opened records what they say");
  return writer;
}

void log_beginning(const config::PeerSettings& peer, const std::filesystem::path& world,
                   const config::TransportSettings& settings, const net::OpenedTransport& reached, Log& log) {
  log(spdlog::level::info, fmt::format("peer {} (id {}) in {}, {}", peer.name, peer.id, world.filename().string(),
                                       reached.transport->describe()));
  if (!reached.why_unicast.empty()) log(spdlog::level::warn, "no multicast: " + reached.why_unicast);
  if (!reached.why_only_here.empty()) {
    log(spdlog::level::warn, "reaches this computer only, over " + reached.why_only_here + "; peerd doctor says more");
  }
  if (const std::string less = buffer_warning(settings, reached.transport->receive_buffer_bytes()); !less.empty()) {
    log(spdlog::level::warn, less);
  }
}

void log_totals(const PeerNode& node, const PeerLog& record, const net::Transport& transport, const Daemon& daemon,
                Log& log) {
  const net::ForwardTime& forward = daemon.forward();
  const auto count = [&](const char* name) { return record.counters.contains(name) ? record.counters.at(name) : 0; };
  log(spdlog::level::info, fmt::format("sent {} datagrams with {} updates, got {} with {}; {} of {} ticks were late",
                                       count("datagrams_out"), count("updates_out"), count("datagrams_in"),
                                       count("updates_in"), count("ticks_missed"), count("ticks")));
  if (const TickLateness& late = daemon.lateness(); late.count() > 0) {
    log(spdlog::level::info, fmt::format("ticks ran late by {:.1f} ms at most but for one in a hundred, by {:.1f} at "
                                         "the worst",
                                         to_seconds(late.p99()) * 1e3, to_seconds(late.most()) * 1e3));
  }
  if (record.counters.contains("poses_taken")) {
    log(spdlog::level::info,
        fmt::format("took {} poses, refused {} and {} messages; {} silences", count("poses_taken"),
                    count("poses_refused"), count("pose_messages_refused"), count("feeds_silent")));
  }
  for (const auto& [reason, dropped] : node.peer().counters().drops) {
    log(spdlog::level::info, fmt::format("dropped {}: {}", dropped, reason));
  }
  for (const auto& [name, n] : transport.counters().named()) {
    if (n > 0 && !(name.ends_with("_in") || name.ends_with("_out")))
      log(spdlog::level::info, fmt::format("{}: {}", name, n));
  }
  if (forward.count() > 0) {
    log(spdlog::level::info,
        fmt::format("{} datagrams were read after a tick that they came before, by {:.1f} us at most", forward.count(),
                    to_seconds(forward.most()) * 1e6));
  }
}

// Makes the cache warmer that runs while the peer polls. The result is null where the peer polls for too short a time,
// or where it can't be made.
std::unique_ptr<CacheWarmer> open_cache_warmer(const config::RunSettings& run, Log& log) {
  if (std::chrono::microseconds(run.transport.busy_poll_us) <= Daemon::kCacheWarmingPeriod) return nullptr;
  auto cache_warmer = CacheWarmer::make(run.replication.policy);
  if (cache_warmer) return *std::move(cache_warmer);
  log(spdlog::level::warn, "polls without cache warming: " + cache_warmer.error().sentence);
  return nullptr;
}

PeerNode::Options node_options_of(const PeerOptions& options, const config::RunSettings& run,
                                  const config::PeerSettings& peer, const net::HostClock& clock) {
  PeerNode::Options node;
  // Two starts of one peer are never in the same nanosecond, and a later one has the higher number.
  node.incarnation = static_cast<std::uint64_t>(clock.now().time_since_epoch().count());
  // A configuration of one peer says nothing of the others: it begins with whoever is there.
  const bool by_itself = run.peers.size() == 1 || options.joined;
  for (const config::PeerSettings& p : run.peers) {
    if (!by_itself && config::starts_with(run.events, p.name)) node.wait_for.push_back({PeerId{p.id}, p.name});
  }
  node.late = by_itself || !config::starts_with(run.events, peer.name);
  node.watches = by_itself && peer.owns.empty();
  node.start_lead = std::chrono::milliseconds(1000);  // enough for a few hellos to reach all peers
  node.clock_offset = from_seconds(peer.clock_offset_s);
  node.keep_log = !options.record.empty();
  node.sample_hz = run.sample_hz;
  return node;
}

// The PeerParts are all that a peer is made of, besides its clock and its network.
struct PeerParts {
  config::Scenario scenario;
  config::PeerSettings* settings = nullptr;  // of the scenario
  std::unique_ptr<const SharedWorld> shared;
  OpenedStore opened;
  replication::Author author;  // once the store is filled, as what follows
  std::unique_ptr<const replication::LogSigner> signer;
  config::PeerObjects objects;
  std::uint64_t session = 0;  // RegionSettings::session_hash

  [[nodiscard]] const config::RunSettings& run() const { return scenario.runs.front(); }
  [[nodiscard]] std::string world_name(const PeerOptions& options) const {
    if (options.joined) return options.joined->world.name;
    return scenario.reading.name.empty() ? scenario.world.stem().string() : scenario.reading.name;
  }
};

Result<config::Scenario> read_configuration(const PeerOptions& options) {
  config::ScenarioRequest request;
  request.file = options.config;
  request.configs = options.overlays;
  request.sets = options.sets;
  request.real = true;
  request.sweep = false;
  if (options.joined) {
    if (auto good = config::check_shared(options.joined->world.settings); !good) return std::unexpected(good.error());
    request.text = options.joined->world.settings;
  }
  return config::read_scenario(request);
}

// Reads the world of the configuration, or the one that was provided, and keeps its archive for joining peers and for
// the store. The archive lacks the content of Inlines that are read later.
Result<config::LoadedWorld> read_world_of(const PeerOptions& options, config::Scenario& scenario) {
  scenario.reading.keeps_archive = !scenario.reading.inlines_when_needed &&
                                   (options.store.is_wanted() || scenario.runs.front().transport.discoverable);
  if (!options.joined) return config::load_world(scenario.world, scenario.reading);
  const store::StoredWorld& provided = options.joined->world;
  const auto wrong = [&](const std::string& what) {
    return std::unexpected(InputError{"error: what was provided of \"" + provided.name + "\" " + what, 1});
  };
  if (!config::is_archive(provided.archive)) return wrong("is no archive");  // it would name files of this computer
  auto world = config::load_world(provided.archive, scenario.world, scenario.reading);
  if (world && world->hash != provided.genesis) return wrong("makes another world here");
  return world;
}

// Opens the store, adds what was provided, and keeps the world itself and the peer's number there.
Result<void> fill_store(const PeerOptions& options, const seal::Identity& identity, const SessionSeal& session_seal,
                        PeerParts& parts) {
  config::PeerSettings& settings = *parts.settings;
  const config::LoadedWorld& world = parts.shared->world;
  auto opened = open_store(options.store, world.hash, settings.name, identity);
  if (!opened) return std::unexpected(opened.error());
  parts.opened = *std::move(opened);
  const auto& store = parts.opened.store;
  parts.author =
      store ? replication::Author{store->author(), store->author_salt()} : seal::fresh_author(identity.public_key());
  parts.signer = std::make_unique<seal::OperationSigner>(
      world.hash, identity, parts.author.salt,
      [&session_seal](const seal::PublicKey& key) { return session_seal.may_write(key); },
      [&session_seal](const seal::PublicKey& key) { return session_seal.writer(key); });
  if (store && options.keeps_id) {
    const auto id = store::identity_in(parts.opened.folder, PeerId{settings.id}, store->author());
    if (!id) return std::unexpected(id.error());
    settings.id = id->value;
  }
  if (auto good = check_signatures(parts.opened, *parts.signer); !good) return good;
  if (options.joined && !options.joined->logs.empty()) {
    if (auto added = add_joined(options.joined->logs, *parts.signer, parts.opened); !added) return added;
  }
  if (!store || world.archive.empty()) return {};
  const store::StoredWorld stored{parts.world_name(options), world.hash, config::shared_settings(parts.run()),
                                  world.archive};
  // The operations are what counts: without its world, the store needs the world's file.
  if (const auto written = store::write_world(parts.opened.folder, stored); !written) {
    parts.opened.lines.push_back({LogLevel::kWarning, written.error().text});
  }
  return {};
}

Result<PeerParts> make_parts(const PeerOptions& options) {
  PeerParts parts;
  auto scenario = read_configuration(options);
  if (!scenario) return std::unexpected(scenario.error());
  parts.scenario = *std::move(scenario);
  print_warnings(parts.scenario.warnings);
  config::RunSettings& run = parts.scenario.runs.front();
  const auto chosen = choose_peer(run, options.peer);
  if (!chosen) return std::unexpected(chosen.error());
  const auto number = static_cast<std::size_t>(*chosen - run.peers.data());
  parts.settings = &run.peers[number];
  auto world = read_world_of(options, parts.scenario);
  if (!world) return std::unexpected(world.error());
  parts.shared = share_world(*std::move(world), parts.scenario.runs);
  parts.session = run.replication.regions.session_hash(parts.shared->world.hash);
  if (options.joined && options.joined->session != 0 && options.joined->session != parts.session) {
    return std::unexpected(InputError{"error: the settings of \"" + options.joined->world.name +
                                          "\" make another session here; is that peer of another version?",
                                      1});
  }
  const Scene& scene = parts.shared->world.scene;
  print_warnings(config::settings_without_effect(run, scene));
  auto objects = config::resolve(run, scene);
  if (!objects) return std::unexpected(objects.error());
  parts.objects = std::move((*objects)[number]);
  return parts;
}

// How the peer reaches the others; greetings are sealed where datagrams are.
Result<net::TransportOptions> reach_of(const PeerParts& parts, SessionSeal& session_seal, const SayLine& say) {
  auto reach = transport_options(parts.run().transport, random_key());
  if (!reach) return reach;
  reach->multicast.groups = net::plan_of_world(reach->multicast.groups, parts.session);
  reach->greetings = session_seal.greetings(say);
  return reach;
}

JoinService::Options join_service_options(const PeerOptions& options, const PeerParts& parts,
                                          const PeerNode::Options& node, const net::TransportOptions& reach,
                                          const net::OpenedTransport& reached, const SessionSeal& session_seal) {
  const config::TransportSettings& settings = parts.run().transport;
  config::RunSettings shared = parts.run();
  if (reached.unicast()) shared.transport.multicast = config::kMulticastNever;
  return {.multicast = reach.multicast,
          .address = reached.transport->own_address(),
          .port = settings.snapshot_port,
          .session = parts.session,
          .incarnation = node.incarnation,
          .world = parts.world_name(options),
          .settings = config::shared_settings(shared),
          .genesis = parts.shared->world.hash,
          .archive = parts.shared->world.archive,
          .key = [&session_seal] { return session_seal.key(); }};
}

// Keeps what somebody wants to have of a run that is over. `capture`: null where there is no sealed one.
Result<void> keep_records(const PeerOptions& options, PeerNode& node, const record::CaptureWriter* capture) {
  if (!options.record.empty()) {
    if (auto saved = save(node.log(), options.record); !saved) return saved;
  }
  if (capture != nullptr && !capture->good()) return std::unexpected(cut_off(options.capture));
  return {};
}

// The peer and its capture hear of each roster that is followed from now on. All outlive the session's seal.
void follow_rosters(SessionSeal& session_seal, PeerNode& node, const net::HostClock& clock,
                    record::CaptureWriter* capture) {
  session_seal.on_roster([&node, &clock, capture](const std::string& roster) {
    if (capture != nullptr) capture->on_roster(clock.now(), roster);
    node.follow_writers();
  });
}

void log_findings(const PeerParts& parts, Log& log) {
  for (const std::string& line : parts.shared->findings()) log(spdlog::level::warn, line);
  for (const LogLine& line : parts.opened.lines) log(line);
}

}  // namespace

int run_peer(const PeerOptions& options) {
  auto parts = make_parts(options);
  if (!parts) return failed(parts.error());
  const config::RunSettings& run = parts->run();
  const config::PeerSettings& settings = *parts->settings;

  const net::HostClock clock(from_seconds(settings.clock_offset_s));
  Log log(settings.name, options.json, options.verbose);
  const auto log_line = [&log](const LogLine& line) { log(line); };
  const auto identity = peer_identity(run.transport, log_line);
  if (!identity) return failed(identity.error());
  asio::io_context io(1);
  const auto chosen = SessionSeal::choose(run.transport, parts->world_name(options), *identity, options.key);
  if (!chosen) return failed(chosen.error());
  SessionSeal& session_seal = **chosen;
  if (auto good = session_seal.check_owner(!settings.owns.empty()); !good) return failed(good.error());
  PeerNode::Options node_options = node_options_of(options, run, settings, clock);
  node_options.sealed_by = session_seal.by();
  const auto reach = reach_of(*parts, session_seal, log_line);
  if (!reach) return failed(reach.error());
  auto reached = net::open_transport(io, clock, *reach);
  if (!reached) return failed(input_error(reached.error()));
  const auto& transport = reached->transport;

  // Only where all else is right a store is made.
  if (auto filled = fill_store(options, *identity, session_seal, *parts); !filled) return failed(filled.error());
  node_options.author = parts->author.id;
  node_options.stores = parts->opened.store != nullptr;
  record::RecordingSigner signer(*parts->signer);
  node_options.signer = &signer;
  node_options.log = std::move(parts->opened.log);
  const auto node = PeerNode::make(settings, run.replication, *parts->shared, std::move(parts->objects), node_options);
  node_options.log = {};  // the peer has it

  if (!options.record.empty()) {  // an error shows before the run and not after it
    if (const auto saved = save(node->log(), options.record); !saved) return failed(saved.error());
  }
  auto capture = open_capture(options, parts->scenario, settings, *parts->shared, node_options, *reached,
                              reach->multicast.groups, session_seal, clock.now());
  if (!capture) return failed(capture.error());
  const auto sealed_capture = capture_sealed(*capture, options, session_seal.key().has_value(), clock, *reached, log);
  signer.record_to(capture->get());
  follow_rosters(session_seal, *node, clock, capture->get());
  log_line(session_seal.line());
  session_seal.seal(io, clock, PeerId{settings.id}, *reached, log_line);
  log_beginning(settings, parts->scenario.world, run.transport, *reached, log);
  log_findings(*parts, log);

  const auto cache_warmer = open_cache_warmer(run, log);
  Daemon daemon(io, *node, *transport, clock, log_line,
                options.once ? std::optional(from_seconds(run.duration_s + 0.2)) : std::nullopt, capture->get());
  if (options.verbose) daemon.log_updates();
  if (!options.take_over) daemon.ask_first({PeerId{settings.id}, node_options.incarnation, parts->session});
  if (parts->opened.store) daemon.keep(*parts->opened.store);
  daemon.busy_poll(std::chrono::microseconds(run.transport.busy_poll_us), cache_warmer.get());
  auto control = open_control(io, control_place(options, run.control, settings, log), daemon, log);
  if (!control) return failed(control.error());
  if (*control) daemon.publish_to(**control);
  ViewedPeer viewed(io, daemon, *node, parts->world_name(options), images_for(options, parts->scenario));
  auto gateway = open_gateway(io, options, run.gateway, viewed, log);
  if (!gateway) return failed(gateway.error());
  if (*gateway) {
    daemon.publish_to(**gateway);
    daemon.serves_viewer_at((*gateway)->url());
    daemon.count_in_status([&gateway = **gateway] { return gateway.counters().named(); });
  }
  const auto poses = open_pose_port(io, settings, daemon, log);
  if (!poses) return failed(poses.error());
  std::optional<JoinService> join_service;
  if (run.transport.discoverable) {
    join_service.emplace(io, clock, *node,
                         join_service_options(options, *parts, node_options, *reach, *reached, session_seal), log_line);
  }
  const int code = daemon.run();
  log_refused(control->get(), poses->get(), log);
  control->reset();
  gateway->reset();
  log_totals(*node, node->log(), *transport, daemon, log);
  const auto kept = keep_records(options, *node, sealed_capture.get());
  return kept ? code : failed(kept.error());
}

}  // namespace peerd
