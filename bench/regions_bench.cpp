// Question: how large should a region be? Small ones bring a peer little but what its area of interest holds, and are
// joined, left and handed over between all the time; large ones stand still and bring what nobody asked for.
//
// regions_bench [--quick] [--out DIR] [--commit NAME]: eight peers that see 150 m of a plain of 600 m by 600 m, sixteen
// birds each (configs/scenarios/flock-regions.toml), with configs/best.toml: as two flocks, so that a peer's own lot is
// where it looks, and as eight that fly each for themselves. The cells of the grid get an edge of 18.75 to 300 m,
// as many regions as cover the plain, or none at all ("not cut": everybody hears everything).
//
// The simulator's oracle (peerd/lab/sim/interest_oracle.hpp), which knows no cells, says what came, what an area holds
// and what was missing. error: of the ghosts of what is truly in an area, all peers' samples together. Nothing here
// depends on the machine. Writes regions-cells.csv besides. Exit code 1: a peer held nothing of
// an object in its area, or not the newest, for longer than a latency and a tick; other cells changed what areas hold;
// cells of half the edge had fewer joins or hand-overs, or down to 75 m brought more bytes; or 75 m and larger ones
// brought more than none at all.
#include <algorithm>
#include <cmath>
#include <map>

#include "collision_report.hpp"
#include "peerd/lab/measure/lookup.hpp"
#include "peerd/lab/measure/statistics/statistics.hpp"
#include "simulated_run.hpp"

namespace peerd::bench {
namespace {

constexpr double kPlain_m = 600.0;
constexpr double kTick_ms = 1000.0 / 60.0;
constexpr double kNotCut = 0.0;  // as regions.cell_m has it
// Half of what peers see. Larger cells bring less where they are cut in four, smaller ones need not: they cost churn.
constexpr double kFinestJudged_m = 75.0;

struct Flight {
  std::string name;
  double latency_ms;
  std::vector<std::string> sets;
};

struct Cost {
  double cell_m = kNotCut;
  std::uint32_t along = 0;                            // regions along each of the two axes
  double received_bytes_s = 0.0, held_bytes_s = 0.0;  // of a peer: that came; of those, of what its area holds
  double received_over_held = 0.0, worst = 0.0;       // of all peers, of the worst
  double joins_s = 0.0, leaves_s = 0.0;               // of a peer
  std::uint32_t joins_in_a_second = 0;                // at most, of any
  // The rates are of all peers' updates, and of those among them that are in another region than the last one, and
  // that answer a peer who has joined.
  double updates_s = 0.0, handovers_s = 0.0, answers_s = 0.0;
  double sent_bytes_s = 0.0;      // of all peers, hellos included
  double groups = 0.0;            // that a peer listens to, on average
  std::uint32_t groups_most = 0;  // .. at most, of any
  std::size_t groups_in_use = 0;  // at most at a time, by anybody
  measure::Statistics error_m;
  double longest_missing_ms = 0.0, longest_outdated_ms = 0.0;
  std::uint64_t samples = 0;
};

// A peer flies with one of its birds; all that it runs are one flock.
std::vector<std::string> eight_flocks() {
  std::vector<std::string> sets;
  for (int i = 0; i < 8; ++i) {
    const char peer = static_cast<char>('a' + i), name = static_cast<char>('A' + i);
    const std::string flock =
        std::string("peer.") + peer + ".motion.BIRD_" + (i < 4 ? 'N' : 'S') + '_' + name + "_*.flock.";
    sets.push_back(flock + "speed_m_s=14");
    sets.push_back(flock + "within_m=[-270, 30, -270, 270, 150, 270]");
    sets.push_back(flock + "seed=" + std::to_string(i + 1));
  }
  return sets;
}

// A watch counts which peers listen to which regions, and how often objects were handed over while the motions last.
class Watch {
 public:
  explicit Watch(double duration_s) : duration_(from_seconds(duration_s)) {}
  void operator()(const PeerNode& node, const replication::Output& output) {
    if (const auto* join = std::get_if<replication::Join>(&output)) {
      ++listeners_[join->region];
      most_ = std::max(most_, listeners_.size());
    } else if (const auto* leave = std::get_if<replication::Leave>(&output)) {
      if (--listeners_[leave->region] == 0) listeners_.erase(leave->region);
    } else if (const auto* published = std::get_if<replication::Published>(&output)) {
      if (!node.start() || published->at > *node.start() + duration_) return;
      const std::uint64_t count = node.peer().counters().handovers;  // what begins to move jumps first
      (published->at < *node.start() ? before_ : until_now_)[node.peer().id()] = count;
    }
  }
  [[nodiscard]] std::size_t groups_in_use() const { return most_; }
  [[nodiscard]] std::uint64_t handovers() const {
    std::uint64_t all = 0;
    for (const auto& [peer, count] : until_now_) {
      const auto before = before_.find(peer);
      all += count - (before == before_.end() ? 0 : before->second);
    }
    return all;
  }

 private:
  Duration duration_;
  std::map<RegionId, std::uint32_t> listeners_;
  std::size_t most_ = 0;
  std::map<PeerId, std::uint64_t> before_, until_now_;  // hand-overs
};

// An area path is where a peer's area is over time: at the object that its viewpoint flies with, as that object's owner
// knows it at its ticks.
class AreaPath {
 public:
  AreaPath(const PeerLog& log, ObjectId carrier) {
    for (const PeerLog::ObjectSample& b : log.object_samples) {
      if (b.object == carrier && b.owner == log.peer)
        ticks_.emplace_back(to_seconds(b.at - *log.start), b.state.position);
    }
  }
  [[nodiscard]] Vec3 at(double t_s) const {
    const auto next = std::ranges::lower_bound(ticks_, t_s, {}, [](const auto& tick) { return tick.first; });
    if (next == ticks_.begin()) return ticks_.front().second;
    if (next == ticks_.end()) return ticks_.back().second;
    const auto& [t0, p0] = *(next - 1);
    return p0 + (t_s - t0) / (next->first - t0) * (next->second - p0);
  }

 private:
  std::vector<std::pair<double, Vec3>> ticks_;
};

// On the ground: its axes are those that are cut.
measure::Statistics error_in_areas(const ReadyRun& run, const Played& played, const measure::RunRecord& record) {
  std::vector<double> errors_m;
  for (const PeerLog& log : played.logs) {
    const auto peer = std::ranges::find(run.settings().peers, log.peer.value, &config::PeerSettings::id);
    const AreaPath area(log, run.shared->world.scene.find(peer->viewpoint->object).value());
    for (const measure::GhostSample& s : record.ghost_samples) {
      if (s.observer != log.peer) continue;
      Vec3 apart = s.truth.position - area.at(s.t_s);
      apart.y() = 0.0;
      if (apart.norm() <= *peer->interest_radius_m) errors_m.push_back(measure::ghost_error_m(s));
    }
  }
  return measure::statistics(std::move(errors_m));
}

Cost measure(const Flight& flight, double cell_m, double duration_s) {
  Cost cost;
  cost.cell_m = cell_m;
  SimulatedRun wanted{"flock-regions", "best", flight.latency_ms, duration_s, flight.sets};
  wanted.sets.push_back("regions.cell_m=" + std::to_string(cell_m));
  if (cell_m != kNotCut) {
    cost.along = static_cast<std::uint32_t>(kPlain_m / cell_m);
    const std::string n = std::to_string(cost.along);
    wanted.sets.push_back("regions.counts=[" + n + ", 1, " + n + "]");
  }
  const ReadyRun run = ready(wanted);
  Watch watch(duration_s);
  const Played played =
      play(run, [&](HostTime, const PeerNode& node, const replication::Output& output) { watch(node, output); });
  const measure::RunRecord record = record_of(run, played);
  const measure::InterestRecord& interest = played.interest.value();
  double received = 0.0, held = 0.0, peers = 0.0;
  for (const measure::PeerInterest& p : interest.peers) {
    const auto came = static_cast<double>(p.received_bytes), of_area = static_cast<double>(p.interest_bytes);
    received += came, held += of_area, ++peers;
    cost.worst = std::max(cost.worst, came / of_area);
    cost.joins_s += p.joins / duration_s, cost.leaves_s += p.leaves / duration_s;
    cost.joins_in_a_second = std::max(cost.joins_in_a_second, p.joins_in_a_second);
    cost.groups += p.groups;
  }
  cost.received_bytes_s = received / peers / duration_s, cost.held_bytes_s = held / peers / duration_s;
  cost.received_over_held = received / held;
  cost.joins_s /= peers, cost.leaves_s /= peers, cost.groups /= peers;
  for (const PeerLog& log : played.logs) cost.groups_most = std::max(cost.groups_most, log.groups_joined);
  cost.groups_in_use = watch.groups_in_use();
  cost.handovers_s = static_cast<double>(watch.handovers()) / duration_s;
  cost.updates_s = static_cast<double>(record.updates.size()) / duration_s;
  for (const measure::UpdateSent& u : record.updates) cost.answers_s += u.reason == "joiner" ? 1.0 / duration_s : 0.0;
  for (const measure::DatagramSent& d : record.datagrams) cost.sent_bytes_s += d.bytes / duration_s;
  cost.error_m = error_in_areas(run, played, record);
  cost.longest_missing_ms = interest.longest_missing_ms;
  cost.longest_outdated_ms = interest.longest_outdated_ms;
  cost.samples = interest.samples;
  return cost;
}

std::string name_of(double cell_m) {
  return cell_m == kNotCut ? "not cut" : text(cell_m, cell_m == std::floor(cell_m) ? 0 : cell_m == 37.5 ? 1 : 2);
}

void judge(const std::string& flight, double latency_ms, const std::vector<Cost>& costs, Report& report) {
  const Cost& whole = costs.back();
  for (const Cost& c : costs) {
    const std::string of = flight + ", cells of " + name_of(c.cell_m) + ": ";
    report.check(c.longest_missing_ms <= latency_ms + kTick_ms, of + "an object was missing for too long");
    report.check(c.longest_outdated_ms <= latency_ms + kTick_ms, of + "news of an object took too long");
    report.check(c.samples == whole.samples && c.error_m.count > 0, of + "the areas hold something else");
    report.check(c.cell_m < kFinestJudged_m || c.received_bytes_s <= whole.received_bytes_s,
                 of + "more comes than where nothing is cut");
    const auto twice = std::ranges::find(costs, 2.0 * c.cell_m, &Cost::cell_m);
    if (c.cell_m == kNotCut || twice == costs.end()) continue;
    report.check(c.joins_s >= twice->joins_s && c.handovers_s >= twice->handovers_s, of + "less churn than of twice");
    report.check(c.cell_m < kFinestJudged_m || c.received_bytes_s <= twice->received_bytes_s,
                 of + "more than of twice");
  }
}

void add_rows(const std::string& flight, const std::vector<Cost>& costs, Table& table, Report& report) {
  const Cost& whole = costs.back();
  for (const Cost& c : costs) {
    table.rows.push_back({flight,
                          name_of(c.cell_m),
                          std::to_string(c.along * c.along),
                          text(c.received_bytes_s, 0),
                          text(c.held_bytes_s, 0),
                          text(c.received_over_held, 3),
                          text(c.worst, 3),
                          text(c.joins_s, 2),
                          text(c.leaves_s, 2),
                          std::to_string(c.joins_in_a_second),
                          text(c.updates_s, 1),
                          text(c.handovers_s, 2),
                          text(c.answers_s, 2),
                          text(c.sent_bytes_s, 0),
                          text(c.groups, 1),
                          std::to_string(c.groups_most),
                          std::to_string(c.groups_in_use),
                          text(c.error_m.mean, 5),
                          text(c.error_m.p99, 4),
                          text(c.longest_missing_ms, 1)});
    std::string name = flight + '.' + name_of(c.cell_m) + '.';
    std::ranges::replace(name, ' ', '_');
    report.figure(name + "received_over_aoi", c.received_over_held, "x", "not cut",
                  c.received_over_held / whole.received_over_held);
    report.figure(name + "joins", c.joins_s, "1/s of a peer");
    report.figure(name + "handovers", c.handovers_s, "1/s");
    report.figure(name + "sent", c.sent_bytes_s, "B/s", "not cut", c.sent_bytes_s / whole.sent_bytes_s);
    report.figure(name + "groups", c.groups, "of a peer");
    report.figure(name + "ghost_error_mean", c.error_m.mean, "m", "not cut", c.error_m.mean / whole.error_m.mean);
    report.figure(name + "ghost_error_p99", c.error_m.p99, "m", "not cut", c.error_m.p99 / whole.error_m.p99);
  }
}

int run(const Options& options) {
  Report report(options);
  const std::vector<double> cells_m = options.quick
                                          ? std::vector<double>{75, kNotCut}
                                          : std::vector<double>{18.75, 25, 37.5, 50, 75, 100, 150, 200, 300, kNotCut};
  std::vector<Flight> flights{{"two flocks", 100, {}}};
  if (!options.quick) {
    flights.push_back({"two flocks", 500, {}});
    flights.push_back({"eight flocks", 100, eight_flocks()});
  }
  Table table{
      "cells",
      "By the edge of a cell: bytes and joins of a peer; updates, hand-overs, answers and bytes sent of all; a second",
      {"flight", "cell_m",      "regions",    "received", "of_area",   "ratio",     "worst",
       "joins",  "leaves",      "joins_most", "updates",  "handovers", "answers",   "sent",
       "groups", "groups_most", "in_use",     "error_m",  "p99_m",     "missing_ms"}};
  for (const Flight& flight : flights) {
    const std::string name = flight.name + " " + text(flight.latency_ms, 0) + " ms";
    std::vector<Cost> costs;
    for (const double cell_m : cells_m) {
      costs.push_back(measure(flight, cell_m, options.quick ? 5.0 : 60.0));
      const Cost& c = costs.back();
      report.note(name + ", cells of " + name_of(cell_m) + ": ratio " + text(c.received_over_held, 3) + ", joins " +
                  text(c.joins_s, 2) + ", hand-overs " + text(c.handovers_s, 2));
    }
    judge(name, flight.latency_ms, costs, report);
    add_rows(name, costs, table, report);
  }
  report.print(table);
  return report.finish();
}

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) { return peerd::bench::run_main(argc, argv, peerd::bench::run); }
