#include "peerd/lab/measure/summary.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include <nlohmann/json.hpp>

#include "peerd/lab/measure/agreement.hpp"
#include "peerd/lab/measure/amiss.hpp"
#include "peerd/lab/measure/lookup.hpp"
#include "peerd/lab/measure/meter.hpp"
#include "peerd/lab/measure/points.hpp"
#include "peerd/lab/measure/statistics/statistics.hpp"

namespace peerd::measure {
namespace {

using Json = nlohmann::ordered_json;

Json error_json(const Statistics& s) {
  Json json = {{"mean", s.mean}, {"rms", s.rms}, {"p99", s.p99}, {"max", s.max}};
  if (!s.p99_exact) json["p99_relative_error"] = RunningStatistics::kP99Error;
  return json;
}

// The row of one observer's ghost of one object. Samples whose error is not a number (a formula's 1/0) are in
// errors.csv but cannot be part of a mean.
Json object_json(const RunRecord& run, const ObjectInfo& object, const PeerInfo& observer, const Measured& measured) {
  const ViewMeasured* const found = measured.view(observer.peer, object.object);
  const ViewMeasured view = found != nullptr ? *found : ViewMeasured{};
  const auto sent = measured.updates.find(object.object);
  const UpdateTotals updates = sent != measured.updates.end() ? sent->second : UpdateTotals{};
  return {{"path", object.path},
          {"owner", peer_name(run, object.owner)},
          {"observer", observer.name},
          {"updates_sent", updates.updates},
          {"bytes_sent", updates.bytes},
          {"samples", view.ghost_error_m.count},
          {"ghost_error_m", error_json(view.ghost_error_m)},
          {"shown_error_m", error_json(view.shown_error_m)},
          {"view_difference_m", error_json(view.view_difference_m)},
          {"inconsistency_m_s", view.inconsistency_m_s},
          {"rest", {{"samples", view.rest_samples}, {"ghost_error_max_m", view.rest_error_max_m}}}};
}

Json collisions_json(const RunRecord& run) {
  const Agreement a = agreement(run);
  std::vector<double> latency_ms;
  for (const double s : a.latency_s) {
    if (std::isfinite(s)) latency_ms.push_back(1e3 * s);
  }
  const Statistics latency = statistics(std::move(latency_ms));
  Json json = {{"decided", a.decided},
               {"agreed", a.agreed},
               {"disagreed", a.disagreed},
               {"spurious", a.spurious},
               {"missed", a.missed},
               {"revised", a.revised},
               {"shared",
                {{"decided", a.shared.decided},
                 {"agreed", a.shared.agreed},
                 {"disagreed", a.shared.disagreed},
                 {"missed", a.shared.missed},
                 {"spurious", a.shared.spurious}}},
               {"decision_latency_ms", {{"mean", latency.mean}, {"p99", latency.p99}, {"max", latency.max}}}};
  if (run.wrong) {
    json["wrong"] = {{"truth", run.wrong->truth}, {"missing", run.wrong->missing}, {"spurious", run.wrong->spurious}};
  }
  return json;
}

Json pair_json(const WorstPair& worst) {
  Json between = Json::array();
  if (worst.depth_m > 0.0) between = {worst.a, worst.b};
  return {{"depth_m", worst.depth_m}, {"between", std::move(between)}, {"at_s", worst.at_s}};
}

Json overlap_json(std::uint64_t samples, const WorstPair& deepest, const WorstPair& meshes) {
  return {{"samples", samples}, {"deepest", pair_json(deepest)}, {"deepest_mesh_at_least", pair_json(meshes)}};
}

std::uint64_t counter(const RunRecord& run, const char* name) {
  const auto found = run.counters.find(name);
  return found == run.counters.end() ? 0 : found->second;
}

Json contacts_json(const RunRecord& run) {
  std::set<std::tuple<double, ObjectId, ObjectId>> outcomes;  // each once, whichever peers state it
  for (const ContactRow& row : run.contacts) {
    if (is_outcome(row)) {
      outcomes.emplace(row.t_s, std::min(row.collider, row.collidee), std::max(row.collider, row.collidee));
    }
  }
  std::map<std::int64_t, std::uint64_t> by_second;
  std::uint64_t last = 0;
  for (const auto& [t_s, a, b] : outcomes) {
    ++by_second[static_cast<std::int64_t>(std::floor(t_s))];
    if (t_s > run.duration_s - 1.0) ++last;
  }
  std::uint64_t most = 0;
  for (const auto& [second, count] : by_second) most = std::max(most, count);
  const auto count = static_cast<double>(outcomes.size());
  Json json = {{"count", outcomes.size()},
               {"per_s", {{"max", most}, {"mean", run.duration_s > 0.0 ? count / run.duration_s : 0.0}}},
               {"last_s", last},
               {"at_rest_per_s", run.contacts_measured ? run.contacts_measured->at_rest : 0},
               {"islands", counter(run, "islands")},
               {"island_objects_max", counter(run, "island_objects_max")}};
  if (!run.contacts_measured) return json;
  const ContactsMeasured& c = *run.contacts_measured;
  json["pairs_not_measured"] = c.pairs_not_measured;
  json["overlap"] = overlap_json(c.samples, c.truth, c.truth_meshes);
  Json& unexplained = json["overlap"]["unexplained"] = pair_json(c.unexplained);
  unexplained["beyond_m"] = c.unexplained.depth_m - c.unexplained.explained_m;
  json["ghost_overlap"] = overlap_json(c.view_samples, c.views, c.view_meshes);
  json["ghost_overlap"]["deepest"]["observer"] = c.observer;
  return json;
}

Json energy_json(const RunRecord& run) {
  const ContactsMeasured& c = *run.contacts_measured;
  const auto part = [](const EnergyMeasured& e) -> Json {
    return {{"start", e.start_j}, {"greatest", e.greatest_j}, {"end", e.end_j}};
  };
  return {{"bodies", c.bodies},          {"owners", c.owners},
          {"samples", c.energy_samples}, {"driven", c.is_driven},
          {"kinetic", part(c.kinetic)},  {"potential", part(c.potential)},
          {"sum", part(c.sum)},          {"taken_by_rest", 1e-9 * static_cast<double>(counter(run, "rest_energy_nj"))}};
}

Json traffic_json(const RunRecord& run, const Measured& measured) {
  const auto bytes = static_cast<double>(measured.datagram_bytes);
  return {{"packets", measured.datagrams},
          {"bytes", measured.datagram_bytes},
          {"bytes_per_s", run.duration_s > 0.0 ? bytes / run.duration_s : 0.0}};
}

Json interest_json(const RunRecord& run) {
  const InterestRecord& interest = *run.interest;
  Json peers = Json::array();
  std::uint64_t received = 0, wanted = 0;
  const auto ratio = [](std::uint64_t a, std::uint64_t b) {
    return b > 0 ? static_cast<double>(a) / static_cast<double>(b) : 0.0;
  };
  for (const PeerInterest& p : interest.peers) {
    received += p.received_bytes;
    wanted += p.interest_bytes;
    peers.push_back({{"peer", peer_name(run, p.peer)},
                     {"objects", p.objects},
                     {"received_bytes", p.received_bytes},
                     {"interest_bytes", p.interest_bytes},
                     {"received_over_interest", ratio(p.received_bytes, p.interest_bytes)},
                     {"groups", p.groups},
                     {"joins", p.joins},
                     {"leaves", p.leaves},
                     {"joins_in_a_second", p.joins_in_a_second}});
  }
  return {{"latency_ms", interest.latency_ms},
          {"longest_missing_ms", interest.longest_missing_ms},
          {"longest_outdated_ms", interest.longest_outdated_ms},
          {"gaps", interest.gaps},
          {"samples", interest.samples},
          {"missing_samples", interest.missing_samples},
          {"received_over_interest", ratio(received, wanted)},
          {"peers", std::move(peers)}};
}

Json oversleep_json(const std::vector<double>& ms) {
  const Statistics s = statistics(ms);
  return {{"mean", s.mean}, {"p99", s.p99}, {"max", s.max}};
}

Json network_json(const RunRecord& run) {
  Json links = Json::array();
  for (const LinkMeasured& l : run.network->links) {
    const Statistics delay = statistics(l.delay_ms);
    const double least = l.delay_ms.empty() ? 0.0 : std::ranges::min(l.delay_ms);
    const double all = static_cast<double>(l.packets + l.packets_lost);
    links.push_back(
        {{"from", peer_name(run, l.from)},
         {"to", peer_name(run, l.to)},
         {"probes", {{"sent", l.probes_sent}, {"lost", l.probes_lost}, {"duplicated", l.probes_duplicated}}},
         {"delay_ms", {{"min", least}, {"mean", delay.mean}, {"p99", delay.p99}, {"max", delay.max}}},
         {"packets", l.packets},
         {"packets_lost", l.packets_lost},
         {"loss", all > 0.0 ? static_cast<double>(l.packets_lost) / all : 0.0}});
  }
  return {{"steady", kept_time(*run.network)},
          {"links", std::move(links)},
          {"oversleep_ms",
           {{"before", oversleep_json(run.network->oversleep_before_ms)},
            {"during", oversleep_json(run.network->oversleep_during_ms)}}}};
}

Json clocks_json(const RunRecord& run) {
  Json clocks = Json::array();
  for (const PeerClock& c : run.clocks) {
    clocks.push_back({{"peer", peer_name(run, c.peer)},
                      {"samples", c.samples},
                      {"error_ms", {{"p99", c.error_p99_ms}, {"max", c.error_max_ms}}},
                      {"bound_ms", {{"median", c.bound_median_ms}, {"max", c.bound_max_ms}}},
                      {"beyond_bound", c.beyond_bound}});
  }
  return clocks;
}

Json run_json(const RunRecord& run, const Measured& measured) {
  assert(std::ranges::is_sorted(run.ghost_samples, {},
                                [](const GhostSample& s) { return std::tuple(s.observer, s.object, s.t_s); }));
  Json objects = Json::array();
  for (const ObjectInfo& object : run.objects) {
    for (const PeerInfo& observer : run.peers) {
      if (observer.peer != object.owner) objects.push_back(object_json(run, object, observer, measured));
    }
  }
  std::uint64_t not_finite = 0;
  for (const ViewMeasured& view : measured.views) not_finite += view.not_finite;
  Json counters = Json::object();
  for (const auto& [name, count] : run.counters) counters[name] = count;
  if (not_finite > 0) counters["report.samples_not_finite"] = not_finite;
  Json json = {{"params", run.params.is_null() ? Json::object() : run.params},
               {"seed", run.seed},
               {"objects", std::move(objects)},
               {"collisions", collisions_json(run)},
               {"contacts", contacts_json(run)},
               {"traffic", traffic_json(run, measured)},
               {"groups_joined", run.groups_joined},
               {"state_roots_equal", run.worlds_equal},
               {"counters", std::move(counters)}};
  if (run.contacts_measured && run.contacts_measured->energy_samples > 0 && run.contacts_measured->bodies > 0) {
    json["energy_j"] = energy_json(run);
  }
  if (!run.network_settings.empty()) json["network_settings"] = run.network_settings;
  if (run.stopped) json["stopped_at_s"] = run.duration_s;
  if (!run.clocks.empty()) json["clocks"] = clocks_json(run);
  if (const auto& shown = run.shown_delay) {
    json["shown_delay_ms"] = {{"min", shown->least_ms}, {"max", shown->most_ms}};
    json["late"] = {{"updates", run.counters.at("updates_late")},
                    {"updates_missing", run.counters.at("updates_missing")},
                    {"decisions", run.counters.at("decisions_late")},
                    {"by_ms", shown->latest_by_ms}};
  }
  if (run.interest) json["interest"] = interest_json(run);
  if (run.network) json["network"] = network_json(run);
  return json;
}

}  // namespace

Json summarise_part(const RunRecord& run, const Measured& part) { return run_json(run, part); }

Json summarise(const ScenarioInfo& info, std::span<const RunRecord> runs) {
  Json summary = {{"scenario", info.name}, {"mode", info.mode}, {"seed", info.seed}};
  if (info.stopped) summary["stopped"] = true;
  Json rows = Json::array();
  for (const RunRecord& run : runs) rows.push_back(run_json(run, measured_of(run)));
  std::vector<std::string> warnings = info.warnings;
  for (std::string& sentence : amiss(rows)) warnings.push_back(std::move(sentence));
  if (!warnings.empty()) summary["warnings"] = std::move(warnings);
  if (info.repeat > 1 && !info.stopped) {  // a point needs all of its runs
    summary["repeat"] = info.repeat;
    summary["points"] = points_json(rows, info.repeat);
  }
  summary["runs"] = std::move(rows);
  return summary;
}

}  // namespace peerd::measure
