// Question: what does a higher tick rate buy, and what does it cost?
//
// ticks_bench [--quick] [--out DIR] [--commit NAME]: crowd, traffic and orbit at 100 ms with configs/best.toml and all
// peers at 10, 20, 30, 60, 120 and 240 ticks a second, 12 simulated seconds of each of three seeds.
//
// error: of the ghosts of what formulas and paths drive, all objects and observers together, sampled 127 times a
// second, which no tick rate divides, so that ghosts are sampled between ticks too. (The report knows the place of an
// object that physics moves at its owner's ticks alone, and the motion between them would count as error at 10 Hz.)
// Bytes: UDP payload of all datagrams of all peers; updates: of each object, a second. time: of the simulation's
// thread, all peers, over that at 60 Hz, in rounds in turns; there ghosts are sampled once a second. Nothing but that
// depends on the machine. Writes ticks-rates.csv besides. Exit code 1: peers do not agree on an
// outcome; an object is published more often than there are ticks; peers whose ghosts are sampled less often send other
// updates.
#include <algorithm>
#include <set>

#include "collision_report.hpp"
#include "peerd/lab/measure/agreement.hpp"
#include "peerd/lab/measure/lookup.hpp"
#include "peerd/lab/measure/statistics/statistics.hpp"
#include "simulated_run.hpp"

namespace peerd::bench {
namespace {

constexpr double kLatency_ms = 100.0;
constexpr std::uint32_t kUsual_hz = 60;  // replication.tick_hz

struct SentUpdate {
  SimTime at;
  ObjectId object;
  std::uint32_t bytes;
  friend bool operator==(const SentUpdate&, const SentUpdate&) = default;
};

struct AtRate {
  std::uint32_t tick_hz = 0;
  measure::Statistics error_m;
  double bytes_s = 0.0, updates_s = 0.0, datagrams_s = 0.0;  // updates: of an object
  std::vector<SentUpdate> updates;
  std::uint64_t disagreed = 0;
  bool same_when_timed = true;  // the updates
  double time = 0.0;            // over that at kUsual_hz
};

SimulatedRun at_rate(const std::string& scenario, double duration_s, std::uint32_t tick_hz, std::uint32_t sample_hz,
                     std::uint32_t seed = 1) {
  std::vector<std::string> sets{"replication.tick_hz=" + std::to_string(tick_hz),
                                "sample_hz=" + std::to_string(sample_hz), "seed=" + std::to_string(seed)};
  if (scenario == "traffic") sets.push_back("decisions.policy=expected-error");
  return {scenario, "best", kLatency_ms, duration_s, std::move(sets)};
}

std::set<ObjectId> driven_objects(const ReadyRun& run) {
  std::set<ObjectId> driven;
  const auto objects = config::resolve(run.settings(), run.shared->world.scene);
  if (!objects) throw std::runtime_error(objects.error().text);
  for (const config::PeerObjects& of_peer : *objects) {
    for (const auto& [object, motion] : of_peer.motions) driven.insert(object);
  }
  return driven;
}

// The updates with their times, until the motions end: a run continues until some peer is called after that. (A peer
// sends hellos when it is called, and the run calls it to read its state.)
std::vector<SentUpdate> updates_of(const Played& played, double duration_s) {
  std::vector<SentUpdate> all;
  for (const PeerLog& log : played.logs) {
    for (const PeerLog::Update& u : log.updates) {
      if (to_seconds(u.at - *log.start) <= duration_s) all.push_back({u.at, u.object, u.bytes});
    }
  }
  return all;
}

AtRate measure(const std::string& scenario, double duration_s, std::uint32_t tick_hz, std::uint32_t seeds) {
  AtRate out;
  out.tick_hz = tick_hz;
  const double all_s = duration_s * seeds;
  std::vector<double> errors_m;
  for (std::uint32_t seed = 1; seed <= seeds; ++seed) {
    const ReadyRun run = ready(at_rate(scenario, duration_s, tick_hz, 127, seed));
    const std::set<ObjectId> driven = driven_objects(run);
    const Played played = play(run);
    const measure::RunRecord record = record_of(run, played);
    if (seed == 1) out.updates = updates_of(played, duration_s);
    out.disagreed += measure::agreement(record).shared.disagreed;
    for (const measure::GhostSample& s : record.ghost_samples) {
      if (driven.contains(s.object)) errors_m.push_back(measure::ghost_error_m(s));
    }
    for (const measure::DatagramSent& d : record.datagrams) out.bytes_s += d.bytes / all_s;
    out.datagrams_s += static_cast<double>(record.datagrams.size()) / all_s;
    out.updates_s += static_cast<double>(record.updates.size()) / all_s / static_cast<double>(record.objects.size());
  }
  out.error_m = measure::statistics(std::move(errors_m));
  return out;
}

// Each rate's figure is the median of the thread's CPU time over that at kUsual_hz in the same round.
void time_rates(const std::string& scenario, double duration_s, std::size_t rounds, std::vector<AtRate>& rates) {
  std::vector<ReadyRun> runs;
  for (const AtRate& r : rates) runs.push_back(ready(at_rate(scenario, duration_s, r.tick_hz, 1)));
  std::vector<std::vector<double>> ratios(rates.size());
  const auto usual = static_cast<std::size_t>(std::ranges::find(rates, kUsual_hz, &AtRate::tick_hz) - rates.begin());
  for (std::size_t round = 0; round < rounds; ++round) {
    std::vector<double> seconds;
    for (std::size_t i = 0; i < rates.size(); ++i) {
      Played played;
      seconds.push_back(seconds_of([&] { played = play(runs[i]); }));
      rates[i].same_when_timed = rates[i].same_when_timed && updates_of(played, duration_s) == rates[i].updates;
    }
    for (std::size_t i = 0; i < rates.size(); ++i) ratios[i].push_back(seconds[i] / seconds[usual]);
  }
  for (std::size_t i = 0; i < rates.size(); ++i) rates[i].time = quartiles(ratios[i]).median;
}

void judge(const std::string& scenario, const std::vector<AtRate>& rates, Report& report) {
  for (const AtRate& r : rates) {
    const std::string of = scenario + " at " + std::to_string(r.tick_hz) + " Hz: ";
    report.check(r.disagreed == 0, of + "peers disagree on an outcome");
    report.check(r.error_m.count > 0, of + "nobody saw anything");
    report.check(r.updates_s <= r.tick_hz, of + "more updates than ticks");
    report.check(r.same_when_timed, of + "other updates where ghosts were looked at less often");
  }
}

void add_rows(const std::string& scenario, const std::vector<AtRate>& rates, Table& table, Report& report) {
  const AtRate& usual = *std::ranges::find(rates, kUsual_hz, &AtRate::tick_hz);
  for (const AtRate& r : rates) {
    table.rows.push_back({scenario, std::to_string(r.tick_hz), text(1e3 * r.error_m.mean, 3),
                          text(1e3 * r.error_m.p99, 2), text(r.bytes_s, 0), text(r.datagrams_s, 1),
                          text(r.updates_s, 3), text(r.time, 2)});
    const std::string name = scenario + '.' + std::to_string(r.tick_hz) + "hz.";
    report.figure(name + "ghost_error_mean", r.error_m.mean, "m", "60 Hz", r.error_m.mean / usual.error_m.mean);
    report.figure(name + "ghost_error_p99", r.error_m.p99, "m", "60 Hz", r.error_m.p99 / usual.error_m.p99);
    report.figure(name + "bytes", r.bytes_s, "B/s", "60 Hz", r.bytes_s / usual.bytes_s);
    report.figure(name + "updates", r.updates_s, "1/s of an object", "60 Hz", r.updates_s / usual.updates_s);
    report.figure(name + "time", r.time, "x", "60 Hz", r.time);
  }
}

int run(const Options& options) {
  Report report(options);
  const std::vector<std::string> scenarios =
      options.quick ? std::vector<std::string>{"orbit"} : std::vector<std::string>{"crowd", "traffic", "orbit"};
  const std::vector<std::uint32_t> rates_hz =
      options.quick ? std::vector<std::uint32_t>{10, 60, 240} : std::vector<std::uint32_t>{10, 20, 30, 60, 120, 240};
  const double duration_s = options.quick ? 3.0 : 12.0;
  Table table{
      "rates",
      "By ticks a second: error [mm], bytes, datagrams of all and updates of an object a second, time over 60 Hz's",
      {"scenario", "tick_hz", "error_mm", "p99_mm", "bytes_s", "datagrams_s", "updates_s", "time"}};
  for (const std::string& scenario : scenarios) {
    std::vector<AtRate> rates;
    for (const std::uint32_t hz : rates_hz) rates.push_back(measure(scenario, duration_s, hz, options.quick ? 1 : 3));
    time_rates(scenario, duration_s, options.quick ? 1 : 5, rates);
    judge(scenario, rates, report);
    add_rows(scenario, rates, table, report);
  }
  report.print(table);
  return report.finish();
}

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) { return peerd::bench::run_main(argc, argv, peerd::bench::run); }
