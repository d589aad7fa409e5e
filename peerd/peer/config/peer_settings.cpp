#include "peerd/peer/config/peer_settings.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include <spdlog/fmt/fmt.h>

#include "peerd/input/number.hpp"
#include "replication/wire/codec.hpp"

namespace peerd::config {
namespace {

constexpr double kFar_m = 1e9;
constexpr std::size_t kShownWarnings = 20;  // of a world
// A walker would cross smaller cells with every other step, and each region is a multicast group.
constexpr double kCellMin_m = 1.0;
constexpr int kRegionsMax = 65536;
// One second is the longest tick: a peer that polls for longer never sleeps.
constexpr std::uint32_t kBusyPollMax_us = 1'000'000;

ScriptedKey read_scripted_key(TomlReader reader) {
  ScriptedKey scripted;
  reader.require("at_s");
  reader.read("at_s", scripted.at_s, 0.0, kForever_s);
  scripted.key = read_key(reader);
  reader.finish();
  return scripted;
}

// Reads which models the sender may name, and what makes it send beyond the thesis's thresholds.
void read_models(TomlReader& reader, replication::PublishPolicy& policy) {
  std::size_t model = 0;
  reader.read_word("model", model, {"order", "best"});
  replication::ModelPolicy models;
  std::vector<std::string> names;
  reader.read("models", names);
  if (reader.has("models")) {
    models.allowed.fill(false);
    for (const std::string& name : names) {
      const auto kind =
          std::ranges::find(replication::kMotionKinds, name, [](auto k) { return std::string(to_string(k)); });
      if (kind == std::end(replication::kMotionKinds)) {
        reader.fail(reader.raw().get("models"), reader.dotted("models") + ": no model is called \"" + name + "\"");
        continue;
      }
      models.allowed[static_cast<std::size_t>(kind - std::begin(replication::kMotionKinds))] = true;
    }
  }
  reader.read("model_memory_s", models.memory_s, 0.01, 60.0);
  reader.read("model_horizon_s", models.horizon_max_s, 0.01, 2.0);
  models.first = policy.order == replication::ModelOrder::kFirst ? replication::MotionKind::kFirst
                                                                 : replication::MotionKind::kSecond;
  if (model == 1) policy.models = models;
  reader.read("wanted_error_m", policy.wanted_error_m, 0.0, kFar_m);
  reader.read("updates_per_s", policy.updates_per_s, 0.0, 1000.0);
  reader.read("updates_saved", policy.updates_saved, 1.0, 1000.0);
  reader.read("update_copies", policy.copies, 1, 10);
  reader.read("bytes_per_s", policy.bytes_per_s, 1000.0, 1e9);
}

void read_display_delay(TomlReader& reader, replication::DisplayDelay& delay) {
  double fixed_ms = 0.0;
  reader.read("display_delay_ms", fixed_ms, 0.0, 2000.0);
  delay.fixed = from_seconds(1e-3 * fixed_ms);
  reader.read("display_delay_measured", delay.measured);
  reader.read("delay_own", delay.own);
}

void read_bounded_latency(TomlReader& reader, replication::BoundedLatency& bounded) {
  double least_ms = 0.0;
  reader.read("bounded_latency_ms", least_ms, 0.0, to_seconds(replication::kBoundMax) * 1e3);
  bounded.least = from_seconds(1e-3 * least_ms);
  reader.read("bounded_latency_measured", bounded.measured);
}

ViewpointSettings read_viewpoint(TomlReader reader) {
  ViewpointSettings v;
  reader.read("object", v.object);
  reader.read("position", v.position, 3);
  reader.read("axis", v.axis, 3);
  reader.read("angle_deg", v.angle_deg, -360.0, 360.0);
  reader.read("field_of_view_deg", v.field_of_view_deg, 1.0, 179.0);
  reader.read("aspect", v.aspect, 0.01, 100.0);
  reader.read("far_m", v.far_m, 1e-3, kFar_m);
  if (!(Vec3(v.axis[0], v.axis[1], v.axis[2]).norm() >= kDirectionMin)) {
    reader.fail(reader.raw().get("axis"), reader.dotted("axis") + " must not be zero, or as good as zero");
  }
  reader.finish();
  return v;
}

PeerId peer_named(TomlReader& reader, const char* key, const std::string& name,
                  const std::vector<PeerSettings>& peers) {
  if (name.empty()) return kNobody;
  const auto named = std::ranges::find(peers, name, &PeerSettings::name);
  if (named != peers.end()) return PeerId{named->id};
  reader.fail(reader.raw().get(key), reader.dotted(key) + ": the scenario has no peer \"" + name + "\"");
  return kNobody;
}

FeedSettings read_feed(TomlReader reader) {
  FeedSettings s;
  reader.read("udp", s.udp);
  reader.read("stale_s", s.stale_s, 0.02, 60.0);
  reader.finish();
  return s;
}

}  // namespace

replication::RelaySettings read_relay(TomlReader reader, const std::vector<PeerSettings>& peers) {
  replication::RelaySettings s;
  std::string through;
  reader.read("through", through);
  s.through = peer_named(reader, "through", through, peers);
  reader.read("restamps", s.restamps);
  reader.finish();
  return s;
}

replication::DecisionSettings read_decisions(TomlReader& reader, const std::vector<PeerSettings>& peers) {
  replication::DecisionSettings s;
  std::size_t policy = 0;
  reader.read_word("policy", policy, {"id", "velocity", "field-of-view", "expected-error", "server"});
  s.policy = static_cast<replication::DecisionPolicy>(policy + 1);
  std::string server;
  reader.read("server", server);
  s.server = peer_named(reader, "server", server, peers);
  if (server.empty() && s.policy == replication::DecisionPolicy::kServer) reader.require("server");
  std::optional<double> lookback_ms;
  reader.read("lookback_ms", lookback_ms, 0.0, 2000.0);
  if (lookback_ms) s.lookback = from_seconds(*lookback_ms * 1e-3);
  reader.read("repeat", s.repeat);
  reader.read("fallback", s.fallback);
  return s;
}

replication::RegionSettings read_regions(TomlReader reader) {
  replication::RegionSettings s;
  reader.read("cell_m", s.cell_m, 0.0, kFar_m);
  if (s.cell_m > 0.0 && s.cell_m < kCellMin_m) {
    reader.fail(reader.raw().get("cell_m"), reader.dotted("cell_m") + " must be 0 (not cut) or at least 1 m");
  }
  std::vector<double> counts{s.regions.begin(), s.regions.end()};
  reader.read("counts", counts, 3);
  const bool whole =
      std::ranges::all_of(counts, [](double n) { return n >= 1.0 && n <= kRegionsMax && n == std::floor(n); });
  if (!whole || counts[0] * counts[1] * counts[2] > kRegionsMax) {
    reader.fail(reader.raw().get("counts"), reader.dotted("counts") +
                                                " must be whole numbers from 1, of which the product is at most " +
                                                std::to_string(kRegionsMax));
  } else {
    std::ranges::transform(counts, s.regions.begin(), [](double n) { return static_cast<std::uint32_t>(n); });
  }
  reader.read("margin_m", s.hysteresis.margin_m, 0.01, kFar_m);
  double stay_s = to_seconds(s.hysteresis.stay);
  reader.read("stay_s", stay_s, 0.0, kForever_s);
  s.hysteresis.stay = from_seconds(stay_s);
  std::optional<double> lookahead_s;
  reader.read("lookahead_s", lookahead_s, 0.0, 60.0);
  if (lookahead_s) s.lookahead = from_seconds(*lookahead_s);
  reader.read("fastest_m_s", s.fastest_m_s, 0.0, 1e6);
  reader.finish();
  return s;
}

ReplicationSettings read_replication(TomlReader reader) {
  ReplicationSettings s;
  std::size_t approach = 2;
  reader.read_word("approach", approach, {"dr", "dr+rcp", "dr+rcp+acpt"});
  s.policy.predict_collisions = approach >= 1;
  s.policy.track_proximity = approach >= 2;
  std::uint32_t order = 2;
  reader.read("order", order, 1, 2);
  s.policy.order = static_cast<replication::ModelOrder>(order);
  read_models(reader, s.policy);
  reader.read("error_threshold_m", s.policy.error_threshold_m, 0.0, kFar_m);
  reader.read("close_threshold_m", s.policy.tight_threshold_m, 0.0, kFar_m);
  reader.read("close_proximity_s", s.policy.close_proximity_s, 0.0, kForever_s);
  std::size_t proximity = 0;
  reader.read_word("proximity", proximity, {"spheres", "surfaces"});
  s.policy.refine_proximity = proximity == 1;
  std::size_t tightening = 0;
  reader.read_word("tightening", tightening, {"step", "by-time"});
  s.policy.threshold_by_time = tightening == 1;
  double angle_deg = s.policy.angle_threshold_rad * 180.0 / std::numbers::pi;
  reader.read("angle_threshold_deg", angle_deg, 0.0, 180.0);
  s.policy.angle_threshold_rad = angle_deg * std::numbers::pi / 180.0;
  reader.read("surface_error", s.policy.surface_error);
  double time_threshold_s = to_seconds(s.policy.time_threshold);
  reader.read("time_threshold_s", time_threshold_s, 0.0, kForever_s);
  s.policy.time_threshold = from_seconds(time_threshold_s);
  double resting_s = to_seconds(s.policy.resting_time_threshold);
  reader.read("resting_time_threshold_s", resting_s, 0.0, kForever_s);
  s.policy.resting_time_threshold = from_seconds(resting_s);
  reader.read("piggyback_fraction", s.policy.piggyback_fraction, 0.1, 1.0);
  reader.read("snapshots_hz", s.policy.snapshots_hz, 0, 1000);
  read_display_delay(reader, s.display_delay);
  read_bounded_latency(reader, s.bounded_latency);
  std::size_t convergence = 0;
  reader.read_word("convergence", convergence, {"jump", "linear", "cubic", "parabola", "adaptive"});
  s.convergence.method = static_cast<replication::ConvergenceMethod>(convergence);
  double convergence_s = to_seconds(s.convergence.over);
  reader.read("convergence_s", convergence_s, 0.0, kForever_s);
  s.convergence.over = from_seconds(convergence_s);
  if (reader.has("convergence")) s.remote_convergence = s.convergence;
  reader.read("tick_hz", s.tick_hz, 1, 1000);
  s.bounded_latency.tick_hz = s.tick_hz;
  reader.read("settled_hello_period_s", s.settled_hello_period_s, 0.25, 4.0);
  reader.read("large_session_above", s.large.above, 0, 1'000'000);
  reader.read("far_hellos_per_s", s.large.hellos_per_s, 1.0, 1e6);
  reader.read("clock_ahead_s", s.clock_ahead_s, 1.0, kForever_s);
  reader.read("steal", s.steal);
  reader.finish();
  return s;
}

KeyEvent read_key(TomlReader& reader) {
  std::string name;
  KeyModifiers held;
  constexpr std::uint32_t kCodeMax = std::numeric_limits<std::int32_t>::max();
  std::uint32_t value = 0, state = 0;
  reader.read("key", name);
  reader.read("shift", held.shift);
  reader.read("control", held.control);
  reader.read("alt", held.alt);
  reader.read("meta", held.meta);
  reader.read("keypad", held.keypad);
  reader.read("value", value, 0, kCodeMax);
  reader.read("state", state, 0, kCodeMax);
  bool is_release = false;
  reader.read("release", is_release);
  const auto any = [&](std::initializer_list<const char*> keys) {
    return std::ranges::any_of(keys, [&](const char* key) { return reader.has(key); });
  };
  if (reader.has("key") == reader.has("value")) {
    reader.fail(nullptr, reader.dotted("key") + ": give either a key's name or its value, a Qt::Key");
  } else if (reader.has("key") && reader.has("state")) {
    reader.fail(reader.raw().get("state"), reader.dotted("state") + " belongs to value; beside key write shift = true");
  } else if (reader.has("value") && any({"shift", "control", "alt", "meta", "keypad"})) {
    reader.fail(reader.raw().get("value"), reader.dotted("value") + ": its modifiers are numbers too, in state");
  } else if (reader.has("value")) {
    return {static_cast<std::int32_t>(value), static_cast<std::int32_t>(state), is_release};
  } else if (const auto key = find_key(name, held)) {
    return {key->value, key->state, is_release};
  } else {
    reader.fail(reader.raw().get("key"), reader.dotted("key") + ": " + key.error());
  }
  return {};
}

std::map<std::string, motion::MotionSettings> read_motions(TomlReader& reader, const std::filesystem::path& folder) {
  std::map<std::string, motion::MotionSettings> motions;
  const toml::table* tables = reader.table("motion");
  if (tables == nullptr) return motions;
  for (const auto& [object, value] : *tables) {
    const std::string pattern(object.str()), key = reader.dotted("motion." + pattern);
    if (!value.is_table()) {
      reader.fail(&value, key + " must be a table that says how it moves");
      continue;
    }
    motions.emplace(pattern, motion::read_motion(TomlReader(*value.as_table(), key, reader.error()), folder));
  }
  return motions;
}

PeerSettings read_peer(TomlReader reader, const std::string& name, const std::filesystem::path& folder) {
  PeerSettings s;
  s.name = name;
  if (!replication::is_name(name)) {
    reader.fail(nullptr, "the peer's name \"" + name + "\" must have 1 to " +
                             std::to_string(replication::kNameMax_bytes) +
                             " visible ASCII characters, no blank and no slash");
  }
  reader.require("id");
  reader.read("id", s.id, 1, std::numeric_limits<std::uint32_t>::max());
  std::vector<std::string> owns;
  reader.read("owns", owns);
  const toml::node* given = reader.raw().get("owns");
  for (std::size_t i = 0; i < owns.size(); ++i) {
    s.owns.emplace_back(owns[i], reader.place(given->as_array()->get(i)));
  }
  std::uint32_t tick_hz = 0;
  reader.read("tick_hz", tick_hz, 1, 1000);
  if (tick_hz != 0) s.tick_hz = tick_hz;
  reader.read("interest_radius_m", s.interest_radius_m, 0.0, kFar_m);
  reader.read("clock_offset_s", s.clock_offset_s, -kForever_s, kForever_s);
  s.motion = read_motions(reader, folder);
  if (const toml::table* feed = reader.table("feed")) {
    s.feed = read_feed(TomlReader(*feed, reader.dotted("feed"), reader.error()));
  }
  if (const toml::table* viewpoint = reader.table("viewpoint")) {
    s.viewpoint = read_viewpoint(TomlReader(*viewpoint, reader.dotted("viewpoint"), reader.error()));
  }
  for (const toml::table* view : reader.tables("view")) {
    s.views.push_back(read_viewpoint(TomlReader(*view, reader.dotted("view"), reader.error())));
  }
  reader.read("skip_unseen", s.skip_unseen);
  for (const toml::table* key : reader.tables("key")) {
    s.keys.push_back(read_scripted_key(TomlReader(*key, reader.dotted("key"), reader.error())));
  }
  std::ranges::stable_sort(s.keys, {}, &ScriptedKey::at_s);
  reader.finish();
  return s;
}

namespace {

// The keys of the table [transport] that begin with `nats`.
net::NatsSettings read_nats(TomlReader& transport) {
  net::NatsSettings s;
  transport.read("nats", s.servers);
  transport.read("nats_subject", s.subject);
  transport.read("nats_credentials", s.credentials);
  transport.read("nats_tls_ca", s.tls_ca);
  transport.read("nats_tls_cert", s.tls_cert);
  transport.read("nats_tls_key", s.tls_key);
  const auto fail = [&](const char* key, const std::string& why) {
    transport.fail(transport.raw().get(key), transport.dotted(key) + ": " + why);
  };
  for (std::size_t i = 0; i < s.servers.size(); ++i) {
    const auto url = net::parse_server_url(s.servers[i]);
    if (!url) fail("nats", fmt::format("server {} of the list is no nats://HOST:PORT: {}", i + 1, url.error()));
  }
  if (!net::is_subject(s.subject)) {
    fail("nats_subject", "it has to be letters, digits, - and _, in parts with dots between them");
  }
  if (s.tls_cert.empty() != s.tls_key.empty()) {
    fail(s.tls_cert.empty() ? "nats_tls_key" : "nats_tls_cert",
         "a certificate needs its key, and a key its certificate: give both or neither");
  }
  for (const char* const key : {"nats_credentials", "nats_tls_ca", "nats_tls_cert"}) {
    if (s.servers.empty() && transport.has(key)) fail(key, "it is of no use without servers in transport.nats");
  }
  return s;
}

// Datagrams go one way.
void refuse_contradictions(TomlReader& reader, const net::TransportSettings& s) {
  if (s.nats.servers.empty()) return;
  const auto contradicts = [&](const char* key) {
    reader.fail(reader.raw().get(key), reader.dotted(key) + " contradicts transport.nats, by which datagrams go");
  };
  if (s.multicast == net::kMulticastAlways) contradicts("multicast");
  if (!s.peers.empty()) contradicts("peers");
  if (!s.relays.empty()) contradicts("relays");
}

}  // namespace

net::TransportSettings read_transport(TomlReader reader) {
  net::TransportSettings s;
  reader.read("interface", s.interface);
  reader.read("group", s.group);
  reader.read("group_pool", s.group_pool, 0, 65536);
  std::uint32_t port = 0;
  reader.read("port", port, 1, 65535);
  if (port != 0) s.port = port;
  reader.read("ttl", s.ttl, 0, 255);
  reader.read("dscp", s.dscp, 0, 63);
  reader.read("receive_buffer_bytes", s.receive_buffer_bytes, 4096, 1u << 30);
  reader.read("busy_poll_us", s.busy_poll_us, 0, kBusyPollMax_us);
  reader.read_word("multicast", s.multicast, {"auto", "always", "never"});
  reader.read("peers", s.peers);
  reader.read("relays", s.relays);
  reader.read("discoverable", s.discoverable);
  std::uint32_t snapshot_port = 0;
  reader.read("snapshot_port", snapshot_port, 1, 65535);
  s.snapshot_port = static_cast<std::uint16_t>(snapshot_port);
  reader.read("sealed", s.sealed);
  reader.read("key_file", s.key_file);
  reader.read("identity_file", s.identity_file);
  reader.read("roster_file", s.roster_file);
  reader.read("password_file", s.password_file);
  s.nats = read_nats(reader);
  refuse_contradictions(reader, s);
  reader.finish();
  return s;
}

ControlSettings read_control(TomlReader reader) {
  ControlSettings s;
  std::string socket;
  reader.read("socket", socket);
  if (reader.has("socket")) s.socket = socket;
  reader.finish();
  return s;
}

LogSettings read_log(TomlReader reader) {
  LogSettings s;
  reader.read("verbose", s.verbose);
  reader.read("burst", s.burst, 1, 1'000'000);
  reader.read("per_second", s.per_second, 0.001, 1e6);
  reader.finish();
  return s;
}

GatewaySettings read_gateway(TomlReader reader) {
  GatewaySettings s;
  reader.read("listen", s.listen);
  reader.read("beyond_loopback", s.beyond_loopback);
  reader.read("origins", s.origins);
  reader.finish();
  return s;
}

namespace {

Result<LoadedWorld> loaded(const WorldFile& file, const std::filesystem::path& path, const WorldReading& reading) {
  const ReadResult& read = file.result;
  if (!read.scene) {
    std::string problems;
    for (const Diagnostic& d : read.diagnostics) problems += render(read, d);
    return std::unexpected(InputError{problems + lenient_advice(read), kFinding});
  }
  // An Inline that is read later leaves other numbers for the instances behind it, even if it holds none; so the hash
  // differs.
  std::uint64_t hash = content_hash(read) ^ (read.scene->pending_inlines.empty() ? 0 : 1);
  for (const char c : reading.name) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211u;  // FNV-1a goes on
  LoadedWorld world{path, hash, *read.scene, {}};
  if (reading.keeps_archive) world.archive = pack(archive_of(file));
  const ReadResult& reported = file.reported();
  const std::size_t count = reported.diagnostics.size(), shown = std::min(count, kShownWarnings);
  for (const Diagnostic& d : std::span(reported.diagnostics).first(shown)) {
    const std::string whole = render(reported, d);
    world.warnings.push_back(whole.substr(0, whole.find('\n')));
  }
  if (count > shown) {
    world.warnings.push_back(path.string() + ": note: " + std::to_string(count - shown) +
                             " more warnings; peerd check --json lists all");
  }
  return world;
}

}  // namespace

Result<LoadedWorld> load_world(const std::filesystem::path& path, const WorldReading& reading) {
  const auto file = read_world_file(path, reading);
  if (!file) return std::unexpected(file.error());
  return loaded(**file, path, reading);
}

Result<LoadedWorld> load_world(std::string bytes, const std::filesystem::path& name, const WorldReading& reading) {
  const auto file = read_world_bytes(std::move(bytes), name, reading);
  if (!file) return std::unexpected(file.error());
  return loaded(**file, name, reading);
}

}  // namespace peerd::config
