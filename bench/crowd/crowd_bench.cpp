// Question: what do many bodies cost that may all meet, beside physics engines?
//
// crowd_bench [--quick] [--out DIR] [--commit NAME] [gas|pile|standing|ENGINE|BODIES]..: each run is a process of its
// own, and the engines take turns. All times are of its thread.
//   gas       boxes of 1 m fly in a closed room, 3 m apart, at about 2 m/s, and lose nothing.
//   pile      boxes fall on a floor and stay where they fall: step_ms over the first 1.5 s, rest_ms from 20 s on.
//   standing  a room with 100 boxes that move and all others nailed down.
// ENGINE: peerd, bullet, jolt or box3d, and no other engine; one that CMake has not found is named as not measured.
// BODIES: a number of bodies, and no other number. In all engines bodies keep their orientation. Exit code 1: peerd
// lets one body into another, or one out of the room, or the energy of a gas change by more than a millionth; or an
// engine counts other contacts of a gas than peerd, by more than a fifth.
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

#include "bench/crowd/engine.hpp"
#include "bench/figures.hpp"
#include "bench/own_process.hpp"
#include "bench/wire_objects.hpp"

namespace peerd::bench {
namespace {

constexpr std::array<CrowdEngineKind, 4> kEngines{{
    {"peerd", peerd_engine, true},
#ifdef BENCH_CROWD_HAS_BULLET
    {"bullet", bullet_engine, false},
#else
    {"bullet", nullptr, false},
#endif
#ifdef BENCH_CROWD_HAS_JOLT
    {"jolt", jolt_engine, false},
#else
    {"jolt", nullptr, false},
#endif
#ifdef BENCH_CROWD_HAS_BOX3D
    {"box3d", box3d_engine, false},
#else
    {"box3d", nullptr, false},
#endif
}};
constexpr double kEnergyBound = 1e-6, kContactsBound = 0.2;
constexpr double kWithinRounding_m = 1e-6;

struct Cost {
  double begin_s = 0.0, step_ms = 0.0, rest_ms = 0.0, memory_mb = 0.0;
  double energy_ratio = 1.0;
  double deepest_m = 0.0, deepest_wall_m = 0.0;
  std::size_t outside = 0;
  std::uint64_t contacts = 0;
};

// Measures a scene for `seconds`, from the end of its first second on; a pile from its start.
Cost measure_here(const CrowdEngineKind& kind, const CrowdScene& scene, double seconds) {
  const auto steps_in = [](double s) { return static_cast<int>(std::lround(s / kStep_s)); };
  const bool falls = scene.kind == CrowdKind::kPile;
  Cost cost;
  std::vector<CrowdPose> bodies;
  double before = thread_s();
  const std::unique_ptr<CrowdEngine> engine = kind.begin(scene);
  cost.begin_s = thread_s() - before;
  const auto look = [&] {
    engine->poses(bodies);
    const CrowdState state = state_of(scene, bodies);
    cost.deepest_m = std::max(cost.deepest_m, state.deepest_m);
    cost.deepest_wall_m = std::max(cost.deepest_wall_m, state.deepest_wall_m);
    cost.outside = std::max(cost.outside, state.outside);
    return state.energy_j;
  };
  for (int i = 0; i < steps_in(falls ? 0.0 : 1.0); ++i) engine->step();
  const double energy_j = look();
  const std::uint64_t contacts = engine->contacts();
  const int steps = steps_in(falls ? 1.5 : seconds);
  before = thread_s();
  for (int i = 0; i < steps; ++i) engine->step();
  cost.step_ms = 1e3 * (thread_s() - before) / steps;
  cost.contacts = engine->contacts() - contacts;
  cost.energy_ratio = falls ? 1.0 : look() / energy_j;
  if (falls) {
    for (int i = steps; i < steps_in(20.0); ++i) engine->step();
    before = thread_s();
    for (int i = 0; i < steps_in(seconds); ++i) engine->step();
    cost.rest_ms = 1e3 * (thread_s() - before) / steps_in(seconds);
  } else {  // more of what it looks like, which is not timed
    for (int i = 0; i < 60; ++i) {
      engine->step();
      look();
    }
  }
  look();
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  cost.memory_mb = static_cast<double>(usage.ru_maxrss) / 1024.0;
  return cost;
}

Cost measure(const CrowdEngineKind& kind, const CrowdScene& scene, double seconds) {
  return in_own_process(kind.name.data(), [&] { return measure_here(kind, scene, seconds); });
}

class Bench : public Report {
 public:
  explicit Bench(const Options& options) : Report(options) {
    for (const std::string& argument : options.arguments) {
      const auto is_it = [&](const CrowdEngineKind& kind) { return kind.name == argument; };
      if (argument.find_first_not_of("0123456789") == std::string::npos) {
        counts_.push_back(std::stoul(argument));
      } else {
        (std::ranges::any_of(kEngines, is_it) ? engines_ : scenes_).push_back(argument);
      }
    }
  }

  int run() {
    for (const CrowdEngineKind& kind : kEngines) {
      if (kind.begin == nullptr && wants(engines_, kind.name)) std::printf("%s: not measured\n", kind.name.data());
    }
    if (wants(scenes_, "gas")) scene("gas", gas_of, {100, 300, 1000, 3000, 10000}, {27, 64});
    if (wants(scenes_, "pile")) scene("pile", pile_of, {50, 200, 1000}, {12});
    if (wants(scenes_, "standing")) scene("standing", standing_of, {1000, 3000, 10000}, {150});
    return finish() ? 0 : 1;
  }

 private:
  [[nodiscard]] static bool wants(const std::vector<std::string>& all, std::string_view one) {
    return all.empty() || std::ranges::find(all, one) != all.end();
  }
  [[nodiscard]] bool measures(const CrowdEngineKind& kind) const {
    return kind.begin != nullptr && wants(engines_, kind.name);
  }

  void scene(const std::string& name, CrowdScene (*make)(std::size_t), const std::vector<std::size_t>& usual,
             const std::vector<std::size_t>& quick) {
    for (const std::size_t count : !counts_.empty() ? counts_ : options_.quick ? quick : usual) {
      const CrowdScene scene = make(count);
      std::map<std::string_view, std::vector<Cost>> costs;
      const int turns = options_.quick ? 1 : 7;
      const double seconds = options_.quick ? 0.5 : count < 3000 ? 10.0 : 4.0;
      for (int turn = 0; turn < turns; ++turn) {
        for (const CrowdEngineKind& kind : kEngines) {
          if (measures(kind)) costs[kind.name].push_back(measure(kind, scene, seconds));
        }
      }
      for (const CrowdEngineKind& kind : kEngines) {
        if (costs.contains(kind.name)) show(name + "." + std::to_string(count), kind, scene, costs);
      }
    }
  }

  void show(const std::string& input, const CrowdEngineKind& kind, const CrowdScene& scene,
            const std::map<std::string_view, std::vector<Cost>>& costs) {
    const std::vector<Cost>& runs = costs.at(kind.name);
    const std::string prefix = input + "." + std::string(kind.name) + ".";
    const auto add = [&](const char* what, const char* unit, double Cost::*member) {
      std::vector<double> values;
      for (const Cost& cost : runs) values.push_back(cost.*member);
      const Quartiles q = quartiles(values);
      add_and_print({prefix + what, q.median, unit, "", {}, q.low, q.high});
    };
    add("step", "ms", &Cost::step_ms);
    if (scene.kind == CrowdKind::kPile) add("rest", "ms", &Cost::rest_ms);
    add("begin", "s", &Cost::begin_s);
    add("memory", "MB", &Cost::memory_mb);
    const Cost& last = runs.back();
    std::printf("  %llu contacts, energy %.9f, deepest %.3g m, in a wall %.3g m, outside %zu\n",
                static_cast<unsigned long long>(last.contacts), last.energy_ratio, last.deepest_m, last.deepest_wall_m,
                last.outside);
    if (kind.is_exact) {
      if (last.outside > 0) wrong(prefix + "outside: bodies have left the room");
      if (std::max(last.deepest_m, last.deepest_wall_m) > kWithinRounding_m)
        wrong(prefix + "deepest: one is in another");
      if (std::abs(last.energy_ratio - 1.0) > kEnergyBound) wrong(prefix + "energy: it has changed");
    }
    const auto ours = costs.find("peerd");
    if (ours == costs.end() || scene.kind != CrowdKind::kGas || options_.quick) return;
    const auto counted = static_cast<double>(last.contacts), exact = static_cast<double>(ours->second.back().contacts);
    if (std::abs(counted - exact) > kContactsBound * exact) wrong(prefix + "contacts: other than peerd's");
  }

  std::vector<std::string> scenes_, engines_;
  std::vector<std::size_t> counts_;
};

int run(const Options& options) { return Bench(options).run(); }

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) { return peerd::bench::run_main(argc, argv, peerd::bench::run); }
