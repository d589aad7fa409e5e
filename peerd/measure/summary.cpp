#include "peerd/measure/summary.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <nlohmann/json.hpp>

#include "peerd/measure/agreement.hpp"
#include "peerd/measure/lookup.hpp"
#include "peerd/measure/points.hpp"
#include "peerd/measure/statistics.hpp"

namespace peerd::report {
namespace {

using Json = nlohmann::ordered_json;

Json error_json(const Statistics& s) { return {{"mean", s.mean}, {"rms", s.rms}, {"p99", s.p99}, {"max", s.max}}; }

// Squares of errors up to this one add up without overflow, and no scene is as large: a larger error comes from a
// division by zero.
constexpr double kGreatestError_m = 1e100;

struct UpdateTotals {
  std::uint64_t updates = 0;
  std::uint64_t bytes = 0;
};

std::map<ObjectId, UpdateTotals> update_totals(const RunRecord& run) {
  std::map<ObjectId, UpdateTotals> totals;
  for (const UpdateSent& u : run.updates) {
    UpdateTotals& t = totals[u.object];
    ++t.updates;
    t.bytes += u.bytes;
  }
  return totals;
}

// The row of one observer's ghost of one object. Samples whose error is not a number (a formula's 1/0) are added to
// not_finite: they are in errors.csv but cannot be part of a mean.
Json object_json(const RunRecord& run, const ObjectInfo& object, const PeerInfo& observer, const UpdateTotals& sent,
                 std::uint64_t& not_finite) {
  std::vector<TimedValue> ghost;
  std::vector<double> ghost_m;
  std::vector<double> shown_m;
  std::vector<double> difference_m;
  for (const GhostSample& s : ghost_samples_of(run, observer.peer, object.object)) {
    const double g = ghost_error_m(s);
    const double d = shown_error_m(s);
    if (!(g < kGreatestError_m) || !(d < kGreatestError_m)) {
      ++not_finite;
      continue;
    }
    ghost.push_back({s.t_s, g});
    ghost_m.push_back(g);
    shown_m.push_back(d);
    difference_m.push_back(view_difference_m(s));
  }
  const std::size_t samples = ghost.size();
  return {{"path", object.path},
          {"owner", peer_name(run, object.owner)},
          {"observer", observer.name},
          {"updates_sent", sent.updates},
          {"bytes_sent", sent.bytes},
          {"samples", samples},
          {"ghost_error_m", error_json(statistics(std::move(ghost_m)))},
          {"shown_error_m", error_json(statistics(std::move(shown_m)))},
          {"view_difference_m", error_json(statistics(std::move(difference_m)))},
          {"inconsistency_m_s", integral(ghost)}};
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

Json traffic_json(const RunRecord& run) {
  std::uint64_t bytes = 0;
  for (const DatagramSent& d : run.datagrams) bytes += d.bytes;
  const double per_s = run.duration_s > 0.0 ? static_cast<double>(bytes) / run.duration_s : 0.0;
  return {{"packets", run.datagrams.size()}, {"bytes", bytes}, {"bytes_per_s", per_s}};
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

Json run_json(const RunRecord& run) {
  assert(std::ranges::is_sorted(run.ghost_samples, {},
                                [](const GhostSample& s) { return std::tuple(s.observer, s.object, s.t_s); }));
  std::map<ObjectId, UpdateTotals> sent = update_totals(run);
  std::uint64_t not_finite = 0;
  Json objects = Json::array();
  for (const ObjectInfo& object : run.objects) {
    for (const PeerInfo& observer : run.peers) {
      if (observer.peer != object.owner)
        objects.push_back(object_json(run, object, observer, sent[object.object], not_finite));
    }
  }
  Json counters = Json::object();
  for (const auto& [name, count] : run.counters) counters[name] = count;
  if (not_finite > 0) counters["report.samples_not_finite"] = not_finite;
  Json json = {{"params", run.params.is_null() ? Json::object() : run.params},
               {"seed", run.seed},
               {"objects", std::move(objects)},
               {"collisions", collisions_json(run)},
               {"traffic", traffic_json(run)},
               {"groups_joined", run.groups_joined},
               {"state_roots_equal", run.worlds_equal},
               {"counters", std::move(counters)}};
  if (!run.clocks.empty()) json["clocks"] = clocks_json(run);
  if (run.interest) json["interest"] = interest_json(run);
  if (run.network) json["network"] = network_json(run);
  return json;
}

}  // namespace

Json summarise(const ScenarioInfo& info, std::span<const RunRecord> runs) {
  Json summary = {{"scenario", info.name}, {"mode", info.mode}, {"seed", info.seed}};
  if (!info.warnings.empty()) summary["warnings"] = info.warnings;
  Json rows = Json::array();
  for (const RunRecord& run : runs) rows.push_back(run_json(run));
  if (info.repeat > 1) {
    summary["repeat"] = info.repeat;
    summary["points"] = points_json(rows, info.repeat);
  }
  summary["runs"] = std::move(rows);
  return summary;
}

}  // namespace peerd::report
