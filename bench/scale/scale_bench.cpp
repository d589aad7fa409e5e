// Question: what does a peer among many moving bodies and interests cost, how does that grow, and would a broad phase
// be cheaper than the schedule of its pairs? What does a world cost of which nearly all stands?
//
// scale_bench [--quick] [--out DIR] [--commit NAME] [pairs|groups|peer|standing|METHOD|BODIES]..: all times are of the
// thread.
//   pairs, groups
//             a MotionWorld (`schedule`) beside three ways to find the same contacts tick by tick (world_run.hpp), for
//             the interests of moving_bodies.hpp. share: of a core, at 60 Hz, updates and ticks; checks: comparisons of
//             two bounds. A method is left out where ten times as many bodies would take ten cores.
//   peer      two whole peers (peer_run.hpp): what the measured one does with packets and ticks.
//   standing  a peer in a process of its own, in worlds of a thousand nodes and more (standing_world.hpp).
// exponent: of the share against the number of bodies, by least squares over their logarithms. Bodies have generated
// meshes of 320 triangles, or with PEERD_CORPUS those of its meshes that have at most 8,000. METHOD: only these;
// BODIES: only these numbers; of `standing`, the nodes. Exit code 1: two methods do not find the same contacts; the
// measured peer knows nothing of a body; a tick depends on the nodes that stand, or does something where nothing moves.
#include <algorithm>
#include <string>
#include <vector>

#include "bench/collision_meshes.hpp"
#include "bench/figures.hpp"
#include "bench/fitted_exponent.hpp"
#include "bench/scale/moving_bodies.hpp"
#include "bench/scale/peer_run.hpp"
#include "bench/scale/standing_world.hpp"
#include "bench/scale/world_run.hpp"

namespace peerd::bench {
namespace {

using namespace std::chrono_literals;

constexpr double kExponentMax = 1.2;
constexpr double kTooSlow = 10.0;  // of a core
constexpr std::size_t kTriangles = 320, kTrianglesMax = 8000, kMeshes = 16;

class Bench : public Report {
 public:
  explicit Bench(const Options& options) : Report(options) {
    for (const std::string& argument : options.arguments) {
      if (argument.find_first_not_of("0123456789") == std::string::npos) {
        counts_.push_back(std::stoul(argument));
      } else if (argument == "schedule" || argument == "broad_phase" || argument.starts_with("all_")) {
        methods_.push_back(argument);
      } else {
        parts_.push_back(argument);
      }
    }
  }

  int run() {
    if (wants("standing")) standing();  // first: it forks, while this process is small
    meshes_ = soups_of_files({}, kTrianglesMax);
    for (std::uint64_t seed = 0; meshes_.size() < kMeshes && std::getenv("PEERD_CORPUS") == nullptr; ++seed) {
      meshes_.push_back({"sphere", bumpy_sphere(kTriangles, seed)});
    }
    if (wants("pairs")) world(Interests::kPairs, "pairs");
    if (wants("groups")) world(Interests::kGroups, "groups");
    if (wants("peer")) peer();
    return finish() ? 0 : 1;
  }

 private:
  [[nodiscard]] bool wants(const std::string& part) const {
    return parts_.empty() || std::ranges::find(parts_, part) != parts_.end();
  }
  [[nodiscard]] bool wants_method(const std::string& method) const {
    return methods_.empty() || std::ranges::find(methods_, method) != methods_.end();
  }
  [[nodiscard]] std::vector<std::size_t> counts(std::vector<std::size_t> usual, std::vector<std::size_t> quick) const {
    return !counts_.empty() ? counts_ : options_.quick ? quick : usual;
  }
  void add(const std::string& name, double value, const char* unit) {
    add_and_print({name, value, unit, "", {}, value, value});
  }
  void add(const std::string& name, const std::vector<double>& samples, const char* unit) {
    const Quartiles q = quartiles(samples);
    add_and_print({name, q.median, unit, "", {}, q.low, q.high});
  }

  using Points = std::vector<std::pair<double, double>>;  // bodies, and their share of a core
  void exponent(const std::string& name, const Points& points) {
    if (points.size() < 2) return;
    const double value = fitted_exponent(points);
    add_and_print({name + ".exponent", value, "", "<= 1.2", value / kExponentMax, value, value});
  }

  void world(Interests interests, const std::string& name) {
    Points grown[4];
    bool too_slow[4] = {};
    for (const std::size_t bodies : counts({100, 1000, 10'000, 100'000}, {60})) {
      const Duration warm = 1s, until = bodies > 20'000 || options_.quick ? Duration{3s} : Duration{6s};
      const MovingBodies moving(bodies, meshes_, interests, until);
      std::optional<WorldCost> first;
      double share = 0.0;
      for (const Method method : {Method::kMotionWorld, Method::kBroadPhase, Method::kBoxes, Method::kSearches}) {
        const auto number = static_cast<std::size_t>(method);
        if (too_slow[number] || !wants_method(name_of(method))) continue;
        const WorldCost cost = run_world(moving, method, warm, until);
        const std::string prefix = name + '.' + std::to_string(bodies) + '.' + name_of(method);
        const Quartiles q = quartiles(cost.shares);
        if (!first) share = q.median;
        add_and_print(
            {prefix + ".share", q.median, "of a core", first ? "the schedule" : "", q.median / share, q.low, q.high});
        add(prefix + ".updates", cost.updates_s / cost.simulated_s, "of a core");
        add(prefix + ".checks", static_cast<double>(cost.checks) / cost.simulated_s / 60.0, "a tick");
        add(prefix + ".searches", static_cast<double>(cost.searches) / cost.simulated_s / 60.0, "a tick");
        add(prefix + ".contacts", static_cast<double>(cost.contacts.size()), "");
        grown[number].push_back({static_cast<double>(bodies), q.median});
        too_slow[number] = 10.0 * q.median > kTooSlow;
        if (!first) {
          first = cost;
          if (cost.contacts.empty()) wrong(prefix + ": nothing has met");
          continue;
        }
        for (const std::string& what : differences(moving, first->contacts, cost.contacts)) wrong(prefix + ": " + what);
      }
    }
    for (const Method method : {Method::kMotionWorld, Method::kBroadPhase, Method::kBoxes, Method::kSearches}) {
      exponent(name + '.' + name_of(method), grown[static_cast<std::size_t>(method)]);
    }
  }

  void peer() {
    Points grown;
    for (const std::size_t bodies : counts({100, 1000, 10'000, 100'000}, {60})) {
      const Duration warm = 4s, until = bodies > 20'000 || options_.quick ? Duration{6s} : Duration{9s};
      const MovingBodies moving(bodies, meshes_, Interests::kPairs, until + 1s);
      const PeerCost cost = run_peer(moving, warm, until);
      const std::string prefix = "peer." + std::to_string(bodies);
      const auto a_tick = [&](std::uint64_t count) {
        return static_cast<double>(count) / static_cast<double>(std::max<std::uint64_t>(cost.ticks, 1));
      };
      add(prefix + ".share", cost.shares, "of a core");
      add(prefix + ".packets", cost.packets_s / cost.simulated_s, "of a core");
      add(prefix + ".ticks", cost.ticks_s / cost.simulated_s, "of a core");
      add(prefix + ".updates_in", a_tick(cost.updates_in), "a tick");
      add(prefix + ".updates_out", a_tick(cost.updates_out), "a tick");
      add(prefix + ".checks", a_tick(cost.motion.searches_far + cost.motion.contact_searches), "a tick");
      add(prefix + ".searches", a_tick(cost.motion.contact_searches), "a tick");
      add(prefix + ".contacts", static_cast<double>(cost.motion.contacts), "");
      grown.push_back({static_cast<double>(bodies), quartiles(cost.shares).median});
      if (cost.unknown > 0) wrong(prefix + ": bodies without an update: " + std::to_string(cost.unknown));
      if (cost.contacts == 0) wrong(prefix + ": nothing has met");
    }
    exponent("peer", grown);
  }

  void standing() {
    const std::size_t ticks = options_.quick ? 60 : 600;
    for (const Named named : {Named::kFew, Named::kAll}) {
      std::optional<StandingCost> least;
      for (const std::size_t nodes : counts({2000, 10'000, 100'000}, {1500, 3000})) {
        const std::string prefix =
            std::string("standing.") + (named == Named::kFew ? "few." : "all.") + std::to_string(nodes);
        const StandingCost cost = measure_standing(nodes, named, true, ticks);
        add(prefix + ".read", 1e3 * cost.read_s, "ms");
        add(prefix + ".model", 1e3 * cost.model_s, "ms");
        add(prefix + ".enter", 1e3 * cost.enter_s, "ms");
        add(prefix + ".memory", cost.memory_mb, "MB");
        add(prefix + ".tick", 1e6 * cost.tick_s, "us");
        add(prefix + ".checks", static_cast<double>(cost.checks) / static_cast<double>(ticks), "a tick");
        if (!least) least = cost;
        const bool same = cost.objects_checked == least->objects_checked && cost.searches == least->searches &&
                          (named == Named::kAll || cost.checks == least->checks);
        if (!same) wrong(prefix + ": a tick depends on what stands");
        if (cost.searches == 0) wrong(prefix + ": nothing is near anything");
        const StandingCost still = measure_standing(nodes, named, false, ticks);
        add(prefix + ".still.tick", 1e6 * still.tick_s, "us");
        if (still.checks + still.searches + still.objects_checked > 0) wrong(prefix + ": nothing moves, and it checks");
      }
    }
  }

  std::vector<std::size_t> counts_;
  std::vector<std::string> parts_, methods_;
  std::vector<NamedSoup> meshes_;
};

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) {
  using namespace peerd::bench;
  return run_main(argc, argv, [](const Options& options) { return Bench(options).run(); });
}
