#include "peerd/daemon/open/opened_peer.hpp"

#include <chrono>
#include <string>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "peerd/daemon/open/run_lines.hpp"
#include "peerd/net/nats/nats_transport.hpp"
#include "peerd/net/transport/transport_options.hpp"
#include "peerd/peer/config/shared_settings.hpp"
#include "peerd/peer/node/describe.hpp"
#include "peerd/peer/record/recorded_transport.hpp"

namespace peerd {
namespace {

namespace asio = boost::asio;

// An IPv4 address comes so long after the IPv6 ones at most, where a network has both.
constexpr Duration kLeaseWithin = std::chrono::seconds(3);

// Makes the cache warmer that runs while the peer polls. The result is null where the peer polls for too short a time,
// or where it can't be made.
std::unique_ptr<CacheWarmer> open_cache_warmer(const config::RunSettings& run, Log& log) {
  if (std::chrono::microseconds(run.transport.busy_poll_us) <= Daemon::kCacheWarmingPeriod) return nullptr;
  auto cache_warmer = CacheWarmer::make(run.replication.policy);
  if (cache_warmer) return *std::move(cache_warmer);
  log(LogLevel::kWarning, "polls without cache warming: " + cache_warmer.error().sentence);
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

// How the peer reaches the others; greetings are sealed where datagrams are.
Result<net::TransportOptions> reach_of(const PeerParts& parts, SessionSeal& session_seal, const SayLine& say) {
  auto reach = net::transport_options(parts.run().transport, net::random_key());
  if (!reach) return reach;
  reach->multicast.groups = net::plan_of_world(reach->multicast.groups, parts.session);
  reach->greetings = session_seal.greetings(say);
  return reach;
}

// Through NATS servers where the settings name some, else by multicast or unicast.
Result<net::OpenedTransport> open_reach(asio::io_context& io, const net::HostClock& clock, const PeerParts& parts,
                                        const std::string& world, const net::TransportOptions& reach) {
  const net::TransportSettings& settings = parts.run().transport;
  if (settings.nats.servers.empty()) {
    auto reached = net::open_transport(io, clock, reach);
    if (!reached) return std::unexpected(input_error(reached.error()));
    return *std::move(reached);
  }
  const auto family = reach.multicast.groups.base.is_v4() ? asio::ip::udp::v4() : asio::ip::udp::v6();
  auto opened = nats::NatsTransport::open(io, clock,
                                          {.settings = settings.nats,
                                           .world = world,
                                           .session = parts.session,
                                           .name = "peerd " + parts.settings->name,
                                           .receive_bytes = settings.receive_buffer_bytes,
                                           .nobody = {family, 0}});
  if (!opened) return std::unexpected(input_error(opened.error()));
  return net::OpenedTransport{*std::move(opened), {}};
}

JoinService::Options join_service_options(const PeerOptions& options, const PeerParts& parts,
                                          const PeerNode::Options& node, const net::TransportOptions& reach,
                                          const net::OpenedTransport& reached, const SessionSeal& session_seal) {
  const net::TransportSettings& settings = parts.run().transport;
  config::RunSettings shared = parts.run();
  if (reached.unicast()) shared.transport.multicast = net::kMulticastNever;
  return {.multicast = reach.multicast,
          .own_address = [&reached] { return reached.transport->own_address(); },
          .port = settings.snapshot_port,
          .session = parts.session,
          .incarnation = node.incarnation,
          .world = parts.world_name(options),
          .settings = config::shared_settings(shared),
          .genesis = parts.shared->world.hash,
          .archive = parts.shared->world.archive,
          .key = [&session_seal] { return session_seal.key(); }};
}

Log::Options log_options(const PeerOptions& options, const config::LogSettings& settings) {
  return {.format = options.log,
          .verbose = options.verbose || settings.verbose,
          .limits = PeerService::limits_of(settings),
          .sink = options.log_to};
}

}  // namespace

OpenedPeer::OpenedPeer(PeerOptions options, PeerParts parts)
    : options_(std::move(options)),
      parts_(std::move(parts)),
      clock_(from_seconds(parts_.settings->clock_offset_s)),
      log_(parts_.settings->name, log_options(options_, parts_.run().log), [this] { return clock_.now(); }),
      say_([this](const LogLine& line) { log_(line); }) {}

OpenedPeer::~OpenedPeer() = default;

Result<std::unique_ptr<OpenedPeer>> OpenedPeer::open(const PeerOptions& options, const WarnPerson& warn) {
  auto parts = make_parts(options, warn);
  if (!parts) return std::unexpected(parts.error());
  std::unique_ptr<OpenedPeer> peer(new OpenedPeer(options, *std::move(parts)));
  if (auto opened = peer->open_network(); !opened) return std::unexpected(opened.error());
  if (auto opened = peer->open_node(); !opened) return std::unexpected(opened.error());
  return peer;
}

Result<void> OpenedPeer::open_network() {
  // The group of a session that is here already is that of its settings.
  if (!options_.joined && net::takes_ipv6(parts_.scenario.runs.front().transport, kLeaseWithin)) {
    log_(LogLevel::kInfo, fmt::format("only IPv6 is to be had here: the group is {}", net::kIpv6Group));
  }
  const config::RunSettings& run = parts_.run();
  auto identity = peer_identity(run.transport, say_);
  if (!identity) return std::unexpected(identity.error());
  identity_ = *std::move(identity);
  auto chosen = SessionSeal::choose(run.transport, parts_.world_name(options_), *identity_, options_.key);
  if (!chosen) return std::unexpected(chosen.error());
  session_seal_ = *std::move(chosen);
  if (auto good = session_seal_->check_owner(!parts_.settings->owns.empty()); !good) return good;
  auto reach = reach_of(parts_, *session_seal_, say_);
  if (!reach) return std::unexpected(reach.error());
  reach_ = *std::move(reach);
  auto reached = open_reach(io_, clock_, parts_, parts_.world_name(options_), *reach_);
  if (!reached) return std::unexpected(reached.error());
  reached_ = *std::move(reached);
  return {};
}

Result<void> OpenedPeer::open_node() {
  const config::RunSettings& run = parts_.run();
  PeerNode::Options node = node_options_of(options_, run, *parts_.settings, clock_);
  node.sealed_by = session_seal_->by();
  options_.store.now = SimTime{clock_.now().time_since_epoch()};
  if (options_.store.fresh && options_.store.fresh_line == 0) options_.store.fresh_line = fresh_line();
  if (options_.joined && options_.joined->session != 0) {
    options_.store.session = {options_.joined->line, !options_.joined->logs.empty(), true};
    node.joins = true;
  }
  // Only where all else is right a store is made.
  if (auto filled = fill_store(options_, *identity_, *session_seal_, parts_); !filled) return filled;
  node.author = parts_.author.id;
  node.stores = parts_.opened.store != nullptr;
  signer_.emplace(*parts_.signer);
  node.signer = &*signer_;
  node.log = std::move(parts_.opened.log);
  node.line = parts_.opened.line;
  node_ = PeerNode::make(*parts_.settings, run.replication, *parts_.shared, std::move(parts_.objects), node);
  node.log = {};                   // the peer has it
  if (!options_.record.empty()) {  // an error shows before the run and not after it
    if (auto saved = save(node_->log(), options_.record); !saved) return saved;
  }
  if (auto opened = open_capture(node); !opened) return opened;
  session_seal_->on_roster([this](const std::string& roster) {
    if (capture_) capture_->on_roster(clock_.now(), roster);
    node_->follow_writers();
  });
  log_(session_seal_->line());
  session_seal_->seal(io_, clock_, PeerId{parts_.settings->id}, *reached_, say_);
  log_beginning(*parts_.settings, parts_.scenario.world, run.transport, *reached_, log_);
  log_findings(parts_, log_);
  return open_daemon(node);
}

// Captures datagrams as they are on the network, unless they are open or somebody wants to have them opened: below the
// seal, and without the peer's inputs.
Result<void> OpenedPeer::open_capture(PeerNode::Options& node) {
  if (options_.capture.empty()) return {};
  // A unicast datagram goes to many addresses but stands in the capture once, as if all regions had one group.
  net::GroupPlan groups = reach_->multicast.groups;
  if (reached_->unicast()) groups.pool = 1;
  auto setup = record::make_setup(parts_.scenario, parts_.run(), *parts_.settings, options_.config, *parts_.shared,
                                  node, std::move(groups));
  setup.roster = session_seal_->roster();
  using Datagrams = record::Setup::Datagrams;
  setup.datagrams = node.sealed_by.empty() ? Datagrams::kOpen
                    : options_.opened      ? Datagrams::kOpened
                                           : Datagrams::kSealed;
  auto writer = record::CaptureWriter::open(options_.capture, setup, clock_.now(), reached_->transport->own_address());
  if (!writer) return std::unexpected(writer.error());
  if (setup.datagrams != Datagrams::kSealed) {
    capture_ = *std::move(writer);
    signer_->record_to(capture_.get());
    return {};
  }
  sealed_capture_ = *std::move(writer);
  reached_->transport = std::make_unique<record::RecordedTransport>(std::move(reached_->transport), *sealed_capture_,
                                                                    [this] { return clock_.now(); });
  log_(LogLevel::kWarning, "records datagrams as they are on the network, sealed; --opened records what they say");
  return {};
}

Result<void> OpenedPeer::open_daemon(const PeerNode::Options& node) {
  const config::RunSettings& run = parts_.run();
  cache_warmer_ = open_cache_warmer(run, log_);
  daemon_ = std::make_unique<Daemon>(io_, *node_, *reached_->transport, clock_, say_,
                                     options_.once ? std::optional(from_seconds(run.duration_s + 0.2)) : std::nullopt,
                                     capture_.get());
  if (!options_.embedded) daemon_->take_signals();
  if (options_.verbose) daemon_->log_updates();
  if (!options_.take_over) daemon_->ask_first({PeerId{parts_.settings->id}, node.incarnation, parts_.session});
  if (parts_.opened.store) daemon_->keep(*parts_.opened.store);
  daemon_->busy_poll(std::chrono::microseconds(run.transport.busy_poll_us), cache_warmer_.get());
  auto ports = PeerPorts::open(io_, options_, parts_, *daemon_, *node_, log_);
  if (!ports) return std::unexpected(ports.error());
  ports_ = *std::move(ports);
  if (run.transport.discoverable) {
    join_service_.emplace(io_, clock_, *node_,
                          join_service_options(options_, parts_, node, *reach_, *reached_, *session_seal_), say_);
  }
  network_watch_.emplace(io_, NetworkWatch::Parts{.clock = clock_,
                                                  .node = *node_,
                                                  .transport = *reached_->transport,
                                                  .join_service = join_service_ ? &*join_service_ : nullptr,
                                                  .provider = options_.joined ? options_.joined->provided_by : "",
                                                  .author = parts_.author.id,
                                                  .deaf_peers = [this] { return session_seal_->deaf_peers(); },
                                                  .begin_log = [this] { begin_log(); },
                                                  .log = say_});
  daemon_->add_to_status([this] { return control::More{{}, network_watch_->troubles()}; });
  return {};
}

// The next life of this peer writes it.
void OpenedPeer::begin_log() {
  if (parts_.opened.store) parts_.opened.store->begin_log(seal::fresh_author(identity_->public_key()));
}

Result<config::RunSettings> OpenedPeer::read_again() const {
  auto scenario = read_configuration(options_);
  if (!scenario) return std::unexpected(scenario.error());
  return std::move(scenario->runs.front());
}

Result<int> OpenedPeer::run(const net::ServiceManager& manager) {
  const bool has_file = !options_.joined && !options_.config.empty();
  service_ = std::make_unique<PeerService>(PeerService::Parts{
      .io = io_,
      .daemon = *daemon_,
      .node = *node_,
      .log = log_,
      .manager = manager,
      .verbose = options_.verbose,
      .peer = parts_.settings->name,
      .world = parts_.scenario.world.filename().string(),
      .settings = parts_.run(),
      .read = has_file ? [this] { return read_again(); } : std::function<Result<config::RunSettings>()>()});
  const int code = daemon_->run();
  if (auto closed = close(); !closed) return std::unexpected(closed.error());
  return code;
}

Result<void> OpenedPeer::close() {
  ports_->close();
  log_totals(*node_, node_->log(), *reached_->transport, *daemon_, log_);
  if (!options_.record.empty()) {
    if (auto saved = save(node_->log(), options_.record); !saved) return saved;
  }
  if (sealed_capture_ && !sealed_capture_->good()) {
    return std::unexpected(InputError{
        options_.capture.string() + ": error: can't be written to its end; is the disk full?", kSystemFailed});
  }
  return {};
}

}  // namespace peerd
