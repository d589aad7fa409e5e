#include "peerd/peer/config/without_effect.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>
#include <ranges>

namespace peerd::config {
namespace {

using replication::PublishPolicy;

struct Rule {
  std::string_view key;
  bool (*has_effect)(const RunSettings&);
  std::string_view why_not;
  std::array<std::string_view, 2> switches;  // keys that decide; "" where there are fewer
};

bool tracks_proximity(const RunSettings& run) { return run.replication.policy.track_proximity; }
bool chooses_models(const RunSettings& run) { return run.replication.policy.models.has_value(); }
bool has_budget(const RunSettings& run) { return run.replication.policy.wanted_error_m > 0.0; }
bool cuts_regions(const RunSettings& run) { return run.replication.regions.cell_m > 0.0; }
bool has_game_server(const RunSettings& run) { return run.baseline.system == BaselineSystem::kServer; }
bool has_relay(const RunSettings& run) { return run.replication.relay.through != kNobody; }

bool has_no_relays(const RunSettings& run) { return run.transport.relays.empty(); }

bool delays_display(const RunSettings& run) {
  const replication::DisplayDelay& delay = run.replication.display_delay;
  return delay.fixed > Duration{0} || delay.measured;
}

bool shows_by_bound(const RunSettings& run) { return run.replication.bounded_latency.is_on(); }
bool shows_without_bound(const RunSettings& run) { return !shows_by_bound(run); }

// Some link has a value over 0 of one of these, at some time.
bool some_link_has(const RunSettings& run, std::initializer_list<double LinkSettings::*> values) {
  const auto has = [&](const LinkSettings& link) {
    return std::ranges::any_of(values, [&](auto value) { return link.*value > 0.0; });
  };
  return std::ranges::any_of(links_of(run), has) || std::ranges::any_of(run.events, [&](const ScenarioEvent& event) {
           return std::ranges::any_of(event.change, [&](const auto& change) {
             return change.second > 0.0 && std::ranges::find(values, change.first) != values.end();
           });
         });
}

constexpr std::string_view kNoProximity = "replication.approach is not dr+rcp+acpt";
constexpr std::string_view kNoModels = "replication.model is not best";
constexpr std::string_view kNoBudget = "replication.wanted_error_m is 0";
constexpr std::string_view kNoServer = "baseline.system is not server";
constexpr std::string_view kNoRegions = "regions.cell_m is 0";
constexpr std::string_view kBounded = "the bounded latency delays all objects alike";
constexpr std::array<std::string_view, 2> kBoundKeys{"replication.bounded_latency_ms",
                                                     "replication.bounded_latency_measured"};

constexpr std::array kRules{
    // A snapshot's numbers are rounded by close_threshold_m, too.
    Rule{"replication.close_threshold_m",
         [](const RunSettings& run) { return tracks_proximity(run) || run.replication.policy.snapshots_hz > 0; },
         kNoProximity,
         {"replication.approach", "replication.snapshots_hz"}},
    Rule{"replication.close_proximity_s", tracks_proximity, kNoProximity, {"replication.approach"}},
    Rule{"replication.proximity", tracks_proximity, kNoProximity, {"replication.approach"}},
    Rule{"replication.tightening", tracks_proximity, kNoProximity, {"replication.approach"}},
    Rule{"replication.models", chooses_models, kNoModels, {"replication.model"}},
    Rule{"replication.model_memory_s", chooses_models, kNoModels, {"replication.model"}},
    Rule{"replication.model_horizon_s", chooses_models, kNoModels, {"replication.model"}},
    Rule{"replication.updates_per_s", has_budget, kNoBudget, {"replication.wanted_error_m"}},
    Rule{"replication.updates_saved", has_budget, kNoBudget, {"replication.wanted_error_m"}},
    Rule{"replication.resting_time_threshold_s",
         [](const RunSettings& run) { return !cuts_regions(run) && !has_relay(run); },
         "it does not count with regions, nor with a relay",
         {"regions.cell_m", "relay.through"}},
    Rule{"replication.convergence_s",
         [](const RunSettings& run) {
           return run.replication.convergence.method != replication::ConvergenceMethod::kJump || shows_by_bound(run);
         },
         "replication.convergence is jump",
         {"replication.convergence"}},
    Rule{"replication.convergence_s", shows_without_bound, "the bounded latency shows updates as they are", kBoundKeys},
    Rule{"replication.convergence", shows_without_bound, "the bounded latency shows updates as they are", kBoundKeys},
    Rule{"replication.display_delay_ms", shows_without_bound, kBounded, kBoundKeys},
    Rule{"replication.display_delay_measured", shows_without_bound, kBounded, kBoundKeys},
    Rule{"replication.delay_own", shows_without_bound, kBounded, kBoundKeys},
    Rule{"replication.delay_own",
         [](const RunSettings& run) { return delays_display(run) || shows_by_bound(run); },
         "nothing delays what is displayed",
         {"replication.display_delay_ms", "replication.display_delay_measured"}},
    Rule{
        "decisions.server",
        [](const RunSettings& run) { return run.replication.decisions.policy == replication::DecisionPolicy::kServer; },
        "decisions.policy is not server",
        {"decisions.policy"}},
    Rule{"baseline.snapshots_hz", has_game_server, kNoServer, {"baseline.system"}},
    Rule{"baseline.interpolation_ms", has_game_server, kNoServer, {"baseline.system"}},
    Rule{"relay.restamps", has_relay, "there is no relay.through", {"relay.through"}},
    Rule{"regions.counts", cuts_regions, kNoRegions, {"regions.cell_m"}},
    Rule{"regions.margin_m", cuts_regions, kNoRegions, {"regions.cell_m"}},
    Rule{"regions.stay_s", cuts_regions, kNoRegions, {"regions.cell_m"}},
    Rule{"regions.lookahead_s", cuts_regions, kNoRegions, {"regions.cell_m"}},
    Rule{"regions.fastest_m_s", cuts_regions, kNoRegions, {"regions.cell_m"}},
    Rule{"network.loss_burst",
         [](const RunSettings& run) { return some_link_has(run, {&LinkSettings::loss}); },
         "no link has a loss",
         {"network.loss"}},
    Rule{"network.reordering",
         [](const RunSettings& run) {
           return some_link_has(run, {&LinkSettings::latency_ms, &LinkSettings::jitter_ms});
         },
         "no link delays anything",
         {"network.latency_ms", "network.jitter_ms"}},
    Rule{"transport.peers",
         [](const RunSettings& run) { return run.transport.multicast != net::kMulticastAlways; },
         "transport.multicast is always",
         {"transport.multicast"}},
    Rule{"transport.peers", has_no_relays, "transport.relays reach all others", {"transport.relays"}},
    Rule{"transport.multicast", has_no_relays, "transport.relays reach all others", {"transport.relays"}},
    Rule{"transport.ttl",
         [](const RunSettings& run) { return run.transport.multicast != net::kMulticastNever; },
         "transport.multicast is never",
         {"transport.multicast"}},
};

// The value of a dotted key, or the list that sweeps it.
const toml::node* value_in(const toml::table& source, std::string_view key) {
  if (const toml::node* const value = find(source, key)) return value;
  const toml::table* const sweep = source.get_as<toml::table>("sweep");
  return sweep != nullptr ? sweep->get(key) : nullptr;
}

bool is_swept(const toml::table& source, std::string_view key) {
  const toml::table* const sweep = source.get_as<toml::table>("sweep");
  return sweep != nullptr && sweep->contains(key);
}

// A setting that is off anyway: nobody wonders why it has no effect.
bool is_off(const toml::node& value) {
  const auto yes = value.value_exact<bool>();
  const auto number = value.value<double>();
  const auto text = value.value_exact<std::string>();
  return (yes && !*yes) || (!yes && number && *number == 0.0) || (text && text->empty());
}

// The warning that the key has no effect; none where it is not given, or a later source than that of the key has one of
// the switches.
std::optional<std::string> warning(const GivenSettings& given, std::string_view key, std::string_view why_not,
                                   std::span<const std::string_view> switches) {
  std::vector<const toml::table*> sources{&given.file};
  for (const toml::table& overlay : given.overlays) sources.push_back(&overlay);
  sources.push_back(&given.set);
  const auto some_switch = [&](auto holds) {
    return std::ranges::any_of(switches, [&](std::string_view s) { return !s.empty() && holds(s); });
  };
  const bool swept = some_switch([&](std::string_view s) {
    return std::ranges::any_of(sources, [&](const toml::table* source) { return is_swept(*source, s); });
  });
  if (swept && !given.whole_sweep) return std::nullopt;
  for (const toml::table* const source : std::views::reverse(sources)) {
    if (const toml::node* const value = value_in(*source, key)) {
      if (is_off(*value) || (given.file_is_provided && source == &given.file)) return std::nullopt;
      return (source == &given.set ? "warning: --set " : place_of(value->source()) + "warning: ") + std::string(key) +
             " has no effect: " + std::string(why_not);
    }
    if (some_switch([&](std::string_view s) { return value_in(*source, s) != nullptr; })) return std::nullopt;
  }
  return std::nullopt;
}

bool is_server(const RunSettings& run, const PeerSettings& peer) {
  const auto& decisions = run.replication.decisions;
  return decisions.policy == replication::DecisionPolicy::kServer && decisions.server.value == peer.id;
}

// Poses of programs outside have no effect where no motion is theirs.
bool is_fed(const RunSettings& run, const PeerSettings& peer) {
  const auto outside = [](const auto& motion) {
    return std::holds_alternative<motion::ExternalProgram>(motion.second.kind);
  };
  return std::ranges::any_of(peer.motion, outside) || std::ranges::any_of(run.motion, outside);
}

}  // namespace

std::vector<std::string> keys_without_effect(const GivenSettings& given, std::span<const RunSettings> runs) {
  std::vector<std::string> warnings;
  const auto add = [&](std::optional<std::string> found) {
    if (found) warnings.push_back(*std::move(found));
  };
  for (const Rule& rule : kRules) {
    if (std::ranges::none_of(runs, rule.has_effect)) add(warning(given, rule.key, rule.why_not, rule.switches));
  }
  if (runs.empty()) return warnings;
  for (const PeerSettings& peer : runs.front().peers) {
    const auto in_some_run = [&](auto holds) {
      return std::ranges::any_of(runs, [&](const RunSettings& run) {
        const auto same = std::ranges::find(run.peers, peer.name, &PeerSettings::name);
        return same != run.peers.end() && holds(run, *same);
      });
    };
    const std::string path = "peer." + peer.name + ".";
    const bool fed = in_some_run(is_fed);
    const auto skips = [](const RunSettings&, const PeerSettings& p) { return p.skip_unseen; };
    const auto may_skip = [](const RunSettings& run, const PeerSettings& p) {
      return !delays_display(run) && !shows_by_bound(run) && !is_server(run, p);
    };
    const std::string skip_unseen = path + "skip_unseen";
    const std::array<std::string_view, 1> by{skip_unseen};
    for (const char* key : {"view", "viewpoint.far_m"}) {
      if (!in_some_run(skips)) add(warning(given, path + key, "the peer does not skip_unseen", by));
    }
    if (!in_some_run(may_skip)) {
      add(warning(
          given, skip_unseen, "the server of decisions, and who shows the past, computes all of it",
          std::array<std::string_view, 6>{"decisions.policy", "decisions.server", "replication.display_delay_ms",
                                          "replication.display_delay_measured", kBoundKeys[0], kBoundKeys[1]}));
    }
    for (const char* key : {"udp", "stale_s"}) {
      if (!fed) add(warning(given, path + "feed." + key, "no motion of the peer has outside = true", {}));
    }
  }
  return warnings;
}

}  // namespace peerd::config
