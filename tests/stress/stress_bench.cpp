// Question: what remains of the truth after a day, after a million bounces, and how dear is what rests?
//
// stress_bench [--quick] [--out DIR] [--commit NAME]:
//
//   day      two peers share a world for 24 h at 1 Hz, and for 1 h at 60 Hz (long_life.hpp)
//   bounces  a million of a box and of a ball on a floor (many_bounces.hpp)
//   resting  a mesh that lies on a plane, which is all coplanar triangles: the part of signs that exact arithmetic has
//   to
//            find, and how long a query takes, beside one that is lifted by a hundredth of its size
//
// --quick: minutes in place of hours, thousands in place of millions. Exit code 1: a bound is not kept.
#include <algorithm>
#include <chrono>
#include <cstdio>

#include "bench/figures.hpp"
#include "collision/query/wide_query.hpp"
#include "tests/collision/soups.hpp"
#include "tests/stress/long_life.hpp"
#include "tests/stress/many_bounces.hpp"

namespace peerd::stress {
namespace {

using bench::Figure;

class Report {
 public:
  // The bounds are those of README.md; without one a value is reported and not judged.
  void add(const std::string& name, double value, const char* unit, std::optional<double> bound = {}) {
    const bool kept = !bound || value <= *bound;
    std::printf("%-34s %14.6g %-6s", name.c_str(), value, unit);
    if (bound) std::printf(" bound %g%s", *bound, kept ? "" : "  NOT KEPT");
    std::printf("\n");
    const std::optional<double> ratio = bound && *bound > 0.0 ? std::optional(value / *bound) : std::nullopt;
    figures.push_back({name, value, unit, bound ? "its bound" : "", ratio, value, value});
    good = good && kept;
  }
  std::vector<Figure> figures;
  bool good = true;
};

void add_life(Report& report, const std::string& name, const LongLife& life) {
  const auto add = [&](const char* what, double value, const char* unit, std::optional<double> bound = {}) {
    report.add(name + '.' + what, value, unit, bound);
  };
  std::uint64_t drops = 0;
  for (const auto& [reason, n] : life.drops) {
    std::printf("  dropped: %s %llu\n", reason.c_str(), static_cast<unsigned long long>(n));
    drops += n;
  }
  add("session", life.session_s, "s");
  add("ticks", static_cast<double>(life.ticks), "1");
  add("contacts", static_cast<double>(life.contacts), "1");
  add("updates", static_cast<double>(life.updates), "1");
  add("lost_or_stepped", static_cast<double>(life.lost), "1", 0.0);
  add("drops", static_cast<double>(drops), "1", 0.0);
  add("old_copies", static_cast<double>(life.old_copies), "1", 0.2 * static_cast<double>(life.updates));
  add("norm_error", life.norm_error, "1", kNormBound);
  add("spinner_error", life.spinner_error_rad, "rad", kSpinnerBound_rad);
  add("ball_error", life.ball_error_m, "m", kBallBound_m);
  add("ball_speed_error", life.ball_speed_error, "1", kBallSpeedBound);
  add("machine_error", life.machine_error_m, "m", kMachineBound_m);
  add("machine_differs", static_cast<double>(life.machine_differs), "1", 0.0);
  add("mover_error", life.mover_error_m, "m", kMoverBound_m);
  add("clocks_apart", 1e-9 * static_cast<double>(life.clocks_apart_ns), "s", 1e-9 * kClocksBound_ns);
}

void add_bounces(Report& report, const std::string& name, const ManyBounces& b) {
  report.add(name + ".bounces", static_cast<double>(b.bounces), "1");
  report.add(name + ".energy_error", b.energy_error, "1", kEnergyBound);
  report.add(name + ".below_floor", b.lowest_m, "m", 0.0);
  report.add(name + ".rest_jam_overlap", static_cast<double>(b.came_to_rest + b.jammed + b.overlapped), "1", 0.0);
}

// A flat grid of triangles: what lies on another such has nothing but coplanar neighbours.
collision::TriangleSoup sheet(std::uint32_t n) {
  collision::TriangleSoup soup;
  for (std::uint32_t y = 0; y <= n; ++y) {
    for (std::uint32_t x = 0; x <= n; ++x) soup.vertices.emplace_back(x, y, 0.0);
  }
  for (std::uint32_t y = 0; y < n; ++y) {
    for (std::uint32_t x = 0; x < n; ++x) {
      const std::uint32_t i = y * (n + 1) + x, polygon = y * n + x;
      soup.faces.push_back({{i, i + 1, i + n + 2}, polygon});
      soup.faces.push_back({{i, i + n + 2, i + n + 1}, polygon});
    }
  }
  soup.box = {Vec3::Zero(), Vec3(n, n, 0)};
  return soup;
}

void add_resting(Report& report, int rounds) {
  const collision::TriangleSoup floor = sheet(64), crate = sheet(8);
  for (const bool lifted : {false, true}) {
    collision::WideTree a(floor), b(crate);
    a.build_all();
    b.build_all();
    collision::WideQuery query;
    collision::Numbers numbers(1);
    std::vector<double> times_us;
    std::uint64_t touching = 0;
    for (int i = 0; i < rounds; ++i) {
      const Vec3 at(numbers.between(0, 50), numbers.between(0, 50), lifted ? 0.08 : 0.0);
      const Pose pose{at, quat_exp(Vec3(0, 0, numbers.between(-3, 3)))};
      const collision::RelativeMotion motion(Pose{}, pose);
      collision::PolygonPair pair{};
      const auto begin = std::chrono::steady_clock::now();
      touching += query.find_pair(a, b, motion, pair);
      times_us.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count());
    }
    std::ranges::sort(times_us);
    const auto at = [&](double part) {
      return times_us[static_cast<std::size_t>(part * static_cast<double>(times_us.size() - 1))];
    };
    const std::string name = lifted ? "lifted" : "resting";
    const auto& counters = query.counters();
    report.add(name + ".touching", static_cast<double>(touching), "1");
    report.add(name + ".not_as_placed", static_cast<double>(lifted ? touching : rounds - touching), "1", 0.0);
    report.add(name + ".triangle_tests", static_cast<double>(counters.triangle_tests) / rounds, "1/query");
    report.add(name + ".exact_signs", static_cast<double>(counters.orientation.exact) / rounds, "1/query");
    report.add(name + ".wide_signs", static_cast<double>(counters.orientation.wide) / rounds, "1/query", 0.0);
    report.add(name + ".median", at(0.5), "us");
    report.add(name + ".p99", at(0.99), "us");
  }
}

int run(const bench::Options& options) {
  using namespace std::chrono_literals;
  Report report;
  add_life(report, "day_1hz", live_for(options.quick ? Duration(10min) : Duration(24h), 1, 7s));
  add_life(report, "hour_60hz", live_for(options.quick ? Duration(2min) : Duration(1h), 60, 7s));
  const std::uint64_t bounces = options.quick ? 2'000 : 1'000'000;
  add_bounces(report, "box",
              bounce("Box { size 0.2 0.2 0.2 }", 0.5 * static_cast<double>(0.2F), "responseType 0", bounces));
  add_bounces(report, "ball_impulse",
              bounce("Sphere { radius 0.125 }", 0.125, "responseType 2 restitution 1", bounces / 100));
  add_resting(report, options.quick ? 100 : 20'000);
  // The faults that a Lan itself found.
  const bool sound = !testing::UnitTest::GetInstance()->ad_hoc_test_result().Failed();
  if (!bench::write_figures(options, report.figures)) return 3;
  if (!report.good || !sound) std::fprintf(stderr, "error: a bound is not kept; see above\n");
  return report.good && sound ? 0 : 1;
}

}  // namespace
}  // namespace peerd::stress

int main(int argc, char** argv) { return peerd::stress::run(peerd::bench::parse_options(argc, argv)); }
