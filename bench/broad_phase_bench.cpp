// Question: what does a tick of the broad phase cost, beside a copy of the boxes it is given, and does it grow with the
// objects or with their square?
//
// broad_phase_bench [--quick] [--out DIR] [--commit NAME] [WORLD..]: boxes of a metre go round on circles, at up to 10
// m/s and 60 ticks a second; a tick is timed from the first moved box to the answer. Four worlds:
//   pairs   ten interests an object, 1 in 100 with a companion at its side, all others with anyone; constant density
//   crowd   ten interests an object with anyone, in so small a place that 1 in 100 of all pairs overlap
//   group   all with all, at constant density
//   few     as pairs, but one object in a hundred moves
// Beside the methods there is `flat`: all interests tested in a row, over flat boxes. Exit code 1: an answer differs
// from the twin's (or, where that is too slow, from another method's), a tick allocates, or one in which nothing moved
// tests something.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "collision/broad_phase/broad_phase.hpp"
#include "figures.hpp"
#include "fitted_exponent.hpp"
#include "heap_meter.hpp"

namespace peerd::bench {
namespace {

using collision::BroadIndex;
using collision::BroadPair;
using collision::BroadPhase;
using collision::BroadPhaseMethod;
using collision::make_broad_phase;
using Clock = std::chrono::steady_clock;

constexpr double kTick_s = 1.0 / 60.0;
constexpr double kTooSlow_ms = 100.0;  // a method isn't asked for more objects than those for which a tick takes this
constexpr std::size_t kInterestsPerObject = 10;

enum class Kind : std::uint8_t { kPairs, kCrowd, kGroup, kFew };

class World {
 public:
  World(Kind kind, std::size_t n) : kind_(kind), boxes(n), circles_(n) {
    std::mt19937_64 random(42);
    const auto uniform = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    constexpr double kPerCubicMetre = 0.05;
    // Two boxes of 1 m at random places in a cube of L overlap by (1 - (1 - 1/L)^2)^3.
    const double side_m = kind == Kind::kCrowd ? 8.8 : std::cbrt(static_cast<double>(n) / kPerCubicMetre);
    const std::size_t companions = kind == Kind::kPairs || kind == Kind::kFew ? n / kInterestsPerObject * 2 : 0;
    for (std::size_t i = 0; i < n; ++i) {
      Circle& c = circles_[i];
      c.radius_m = uniform(0.5, 3.0);
      c.turn = uniform(0.0, 10.0) / c.radius_m * kTick_s;
      c.phase = uniform(0.0, 2.0 * std::numbers::pi);
      c.centre = Vec3(uniform(0, side_m), uniform(0, side_m), uniform(0, side_m));
      if (i < companions && i % 2 == 1) {
        c = circles_[i - 1];
        c.centre += Vec3(uniform(-0.9, 0.9), uniform(-0.9, 0.9), uniform(-0.9, 0.9));
        c.turn *= 1.0 + uniform(-0.001, 0.001);
        interests.push_back(collision::make_broad_pair(static_cast<BroadIndex>(i - 1), static_cast<BroadIndex>(i)));
      }
    }
    if (kind != Kind::kGroup) {
      std::uniform_int_distribution<BroadIndex> any(0, static_cast<BroadIndex>(n - 1));
      while (interests.size() < n * kInterestsPerObject) {
        for (std::size_t left = n * kInterestsPerObject - interests.size(); left > 0; --left) {
          const BroadIndex a = any(random), b = any(random);
          if (a != b) interests.push_back(collision::make_broad_pair(a, b));
        }
        std::ranges::sort(interests);
        interests.erase(std::ranges::unique(interests).begin(), interests.end());
      }
      std::ranges::shuffle(interests, random);
    }
    for (std::size_t i = 0; i < n; ++i) put(i, 0);
    std::uniform_int_distribution<std::size_t> any(0, n - 1);
    if (kind == Kind::kFew) {
      for (std::size_t k = 0; k < std::max<std::size_t>(n / 100, 1); ++k) moving.push_back(any(random));
    } else {
      for (std::size_t i = 0; i < n; ++i) moving.push_back(i);
    }
  }
  void go_to(int tick) {
    for (const std::size_t i : moving) put(i, tick);
  }
  void fill(BroadPhase& broad) const {
    for (std::size_t i = 0; i < boxes.size(); ++i) broad.add(static_cast<BroadIndex>(i), boxes[i]);
    for (const BroadPair p : interests) broad.register_interest(p.low, p.high);
    if (kind_ != Kind::kGroup) return;
    for (std::size_t i = 0; i < boxes.size(); ++i) broad.join(0, static_cast<BroadIndex>(i));
  }

 private:
  struct Circle {
    Vec3 centre;
    double radius_m, turn, phase;  // turn: radians a tick
  };
  void put(std::size_t i, int tick) {
    const Circle& c = circles_[i];
    const double angle = c.phase + c.turn * tick;
    const Vec3 p = c.centre + c.radius_m * Vec3(std::cos(angle), 0.3 * std::sin(2.0 * angle), std::sin(angle));
    boxes[i] = {p - Vec3::Constant(0.5), p + Vec3::Constant(0.5)};
  }
  Kind kind_;

 public:
  std::vector<WorldBox> boxes;
  std::vector<BroadPair> interests;
  std::vector<std::size_t> moving;

 private:
  std::vector<Circle> circles_;
};

// All interests in a row.
class Flat {
 public:
  explicit Flat(const World& world) : boxes_(world.boxes), pairs_(world.interests) {
    std::ranges::sort(pairs_);
    answer_.reserve(pairs_.size());
  }
  void move(std::size_t i, const WorldBox& box) { boxes_[i] = box; }
  std::span<const BroadPair> tick() {
    answer_.clear();
    for (const BroadPair p : pairs_) {
      const WorldBox &a = boxes_[p.low], &b = boxes_[p.high];
      if ((a.lo[0] <= b.hi[0]) & (b.lo[0] <= a.hi[0]) & (a.lo[1] <= b.hi[1]) & (b.lo[1] <= a.hi[1]) &
          (a.lo[2] <= b.hi[2]) & (b.lo[2] <= a.hi[2])) {
        answer_.push_back(p);
      }
    }
    return answer_;
  }

 private:
  std::vector<WorldBox> boxes_;
  std::vector<BroadPair> pairs_, answer_;
};

struct Method {
  const char* name;
  BroadPhaseMethod method;
};
constexpr std::array kMethods = {Method{"lists", BroadPhaseMethod::kInterestLists},
                                 Method{"tree", BroadPhaseMethod::kDynamicTree},
                                 Method{"sweep", BroadPhaseMethod::kSweepAndPrune}};

struct Run {
  Quartiles ms;
  double overlapping = 0;  // share of the interests; of a group, pairs an object
  double tests = 0, refits = 0;
  std::size_t allocations = 0;
  std::uint64_t hash = 0;
};

std::uint64_t mixed(std::uint64_t hash, std::span<const BroadPair> pairs) {
  for (const BroadPair p : pairs) hash = (hash ^ p.key()) * 0x9e3779b97f4a7c15u;
  return (hash ^ pairs.size()) * 0x9e3779b97f4a7c15u;
}

template <class Target>
Run timed(World& world, Target& target, int warm_up, int ticks) {
  Run run;
  std::vector<double> samples;
  samples.reserve(static_cast<std::size_t>(ticks));
  int tick = 0;
  for (int end = warm_up; tick < end; ++tick) {
    world.go_to(tick);
    for (const std::size_t i : world.moving) target.move(static_cast<BroadIndex>(i), world.boxes[i]);
    target.tick();
  }
  std::size_t found = 0;
  {
    const HeapMeter meter;
    for (int end = warm_up + ticks; tick < end; ++tick) {
      world.go_to(tick);
      const auto start = Clock::now();
      for (const std::size_t i : world.moving) target.move(static_cast<BroadIndex>(i), world.boxes[i]);
      const auto answer = target.tick();
      samples.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
      found += answer.size();
      run.hash = mixed(run.hash, answer);
    }
    run.allocations = meter.allocations();
  }
  const double per = static_cast<double>(world.interests.empty() ? world.boxes.size() : world.interests.size());
  run.overlapping = static_cast<double>(found) / ticks / per;
  run.ms = quartiles(std::move(samples));
  return run;
}

class Bench : public Report {
 public:
  explicit Bench(const Options& options) : Report(options) {}

  void measure(const char* kind_name, Kind kind) {
    std::vector<std::size_t> sizes = {100, 316, 1000, 3162, 10000, 31623, 100000};
    if (options_.quick) sizes = {100, 316};
    std::map<std::string, std::map<std::size_t, double>> ms_of;
    for (const std::size_t n : sizes) {
      const int ticks = options_.quick ? 40 : n < 10000 ? 400 : n < 100000 ? 120 : 40;
      const int warm_up = options_.quick ? 60 : 150;
      const std::string input = std::string(kind_name) + '.' + std::to_string(n);
      const Quartiles copy = copying(kind, n, ticks);
      figures_.push_back({input + ".memcpy", copy.median, "ms", "", std::nullopt, copy.low, copy.high});
      std::printf("%-14s %-7s %9.4f ms\n", input.c_str(), "memcpy", copy.median);
      std::map<std::string, std::uint64_t> hashes;
      const auto report = [&](const std::string& name, const Run& run) {
        std::printf("%-14s %-7s %9.4f ms  [%.4f %.4f] %8.1f x memcpy  %11.0f tests %8.0f refits  %.4f overlap\n",
                    input.c_str(), name.c_str(), run.ms.median, run.ms.low, run.ms.high, run.ms.median / copy.median,
                    run.tests, run.refits, run.overlapping);
        std::fflush(stdout);
        const std::string figure = input + '.' + name;
        figures_.push_back(
            {figure, run.ms.median, "ms", input + ".memcpy", run.ms.median / copy.median, run.ms.low, run.ms.high});
        if (n == 10000 && kind == Kind::kPairs) {
          figures_.push_back(
              {figure + ".limit", run.ms.median, "ms", "target 2 ms", run.ms.median / 2.0, run.ms.low, run.ms.high});
        }
        if (run.allocations > 0) wrong(figure + ": " + std::to_string(run.allocations) + " allocations");
        ms_of[name][n] = run.ms.median;
        hashes[name] = run.hash;
      };
      const auto is_slow = [&](const std::string& name) {  // as the last size foretells
        const auto& series = ms_of[name];
        return n != sizes.front() && (series.empty() || series.rbegin()->second * 3 > kTooSlow_ms ||
                                      series.rbegin()->first != *std::prev(std::ranges::find(sizes, n)));
      };
      if (kind != Kind::kGroup) {
        World world(kind, n);
        Flat flat(world);
        report("flat", timed(world, flat, warm_up, ticks));
      }
      for (const Method& method : kMethods) {
        // A group's lists are a tree.
        if ((kind == Kind::kGroup && method.method == BroadPhaseMethod::kInterestLists) || is_slow(method.name))
          continue;
        World world(kind, n);
        const auto broad = make_broad_phase(method.method);
        world.fill(*broad);
        broad->tick();
        const auto first = broad->counters();
        Run run = timed(world, *broad, warm_up, ticks);
        const auto last = broad->counters();
        run.tests = static_cast<double>(last.box_tests - first.box_tests) / (warm_up + ticks);
        run.refits = static_cast<double>(last.refits - first.refits) / (warm_up + ticks);
        report(method.name, run);
        check(input + '.' + method.name, world, *broad, kind != Kind::kGroup || n <= 3162);
      }
      for (const auto& [name, hash] : hashes) {
        if (hash != hashes.begin()->second) wrong(input + '.' + name + " differs from " + hashes.begin()->first);
      }
    }
    for (const auto& [name, series] : ms_of) {
      if (series.size() < 2) continue;
      const double e = fitted_exponent({series.begin(), series.end()});
      const std::size_t from = series.begin()->first, to = series.rbegin()->first;
      std::printf("%s.%s: n^%.3f from %zu to %zu\n", kind_name, name.c_str(), e, from, to);
      figures_.push_back(
          {std::string(kind_name) + '.' + name + ".exponent_to_" + std::to_string(to), e, "", "linear: 1", e, e, e});
    }
  }

 private:
  // The last answer must be the twin's, and a tick in which nothing moves must repeat it without a test of boxes.
  void check(const std::string& what, const World& world, BroadPhase& broad, bool against_twin) {
    const auto before = broad.counters();
    for (std::size_t i = 0; i < world.boxes.size(); ++i) broad.move(static_cast<BroadIndex>(i), world.boxes[i]);
    const auto answer = broad.tick();
    if (broad.counters().box_tests != before.box_tests) wrong(what + " tests though nothing moved");
    if (!against_twin) return;
    const auto twin = make_broad_phase(BroadPhaseMethod::kBruteForce);
    world.fill(*twin);
    if (!std::ranges::equal(twin->tick(), answer)) wrong(what + " differs from brute force");
  }
  static Quartiles copying(Kind kind, std::size_t n, int ticks) {
    World world(kind, n);
    std::vector<WorldBox> copy(n);
    std::vector<double> samples;
    for (int tick = 0; tick < ticks; ++tick) {
      world.go_to(tick);
      const auto start = Clock::now();
      std::memcpy(static_cast<void*>(copy.data()), world.boxes.data(), n * sizeof(WorldBox));
      asm volatile("" : : "r"(copy.data()) : "memory");
      samples.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    }
    return quartiles(std::move(samples));
  }
};

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) {
  using namespace peerd::bench;
  const Options options = parse_options(argc, argv);
  Bench bench(options);
  const std::array worlds = {std::pair{"pairs", Kind::kPairs}, std::pair{"crowd", Kind::kCrowd},
                             std::pair{"group", Kind::kGroup}, std::pair{"few", Kind::kFew}};
  for (const auto& [name, kind] : worlds) {
    const auto& asked = options.arguments;
    if (asked.empty() || std::ranges::find(asked, name) != asked.end()) bench.measure(name, kind);
  }
  return bench.finish() ? 0 : 1;
}
