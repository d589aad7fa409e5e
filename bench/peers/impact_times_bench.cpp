// Question: how long does the time of impact of two meshes take, beside a test of whether they touch, and beside
// fcl::continuousCollide()?
//
// impact_times_bench [--alone] [--quick] [--out DIR] [--commit NAME] [FILE..]: ten bodies of one mesh in motion, as
// bench_peers has it (knot, sphere, tree in three sizes, or FILEs): each pair whose spheres and boxes overlap, moving
// and turning evenly from one frame's place to the next's in a step, and on for steps 4 and 16 times as long, or a
// quarter.
//
//   first_contact       WideQuery::find_pair() at the step's start
//   impact              MeshImpactQuery::first_impact() over the step
//   impact.hit, .separated
//   impact.touching     " of pairs that touch at the start, which are in none of the others
//   fcl_advancement     unless --alone: FCL's conservative advancement, of as many of those pairs as its share of time
//   is for, beside fcl_naive           and 10 tests at even instants, which is what FCL does unless told otherwise
//                       impact.of_fcls: ours, of the same pairs
//
// A pair's time is the least of three, in an order in which each pair comes after others. Exit code 1: one of our hits
// is later than an instant of 64 that touches, or one that touches was not found, or work ran out.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "bench/figures.hpp"
#include "bench/peers/fcl_impact.hpp"
#include "bench/peers/motion.hpp"
#include "bench/peers/soup.hpp"
#include "collision/query/time_of_impact.hpp"

namespace peerd::bench::peers {
namespace {

using collision::MeshImpact;
using collision::MeshImpactQuery;
using collision::MeshImpactState;
using collision::PolygonPair;
using collision::RelativeMotion;
using collision::WideQuery;
using collision::WideTree;

constexpr int kTimings = 3, kInstants = 64, kNaiveInstants = 10;
constexpr double kFclShare_s = 4.0;  // for one mesh and length of the step

struct MovingPair {
  KinematicState a, b;
};

Quat orientation_of(const Placement& placement) {
  Mat3 rotation;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) rotation(row, column) = placement.rotation[row][column];
  }
  return Quat(rotation).normalized();
}

// The motion goes from one place to the other in 1 s.
KinematicState between(const Placement& from, const Placement& to) {
  KinematicState state;
  state.position = {from.position.x, from.position.y, from.position.z};
  state.velocity = Vec3(to.position.x, to.position.y, to.position.z) - state.position;
  state.orientation = orientation_of(from);
  const Eigen::AngleAxisd turn(state.orientation.conjugate() * orientation_of(to));
  state.angular_velocity_body = turn.angle() * turn.axis();
  return state;
}

Placement placement_of(const KinematicState& state) {
  Placement out{};
  const Mat3 rotation = state.orientation.toRotationMatrix();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out.rotation[row][column] = rotation(row, column);
  }
  out.position = {state.position[0], state.position[1], state.position[2]};
  return out;
}

std::vector<MovingPair> pairs_of(const std::vector<Frame>& frames) {
  std::vector<MovingPair> pairs;
  for (std::size_t f = 0; f + 1 < frames.size(); ++f) {
    const auto state = [&](std::size_t body) { return between(frames[f].bodies[body], frames[f + 1].bodies[body]); };
    for (const Query& query : frames[f].queries) pairs.push_back({state(query.a), state(query.b)});
  }
  return pairs;
}

template <class Ask>
double time_us(Ask ask) {
  const auto begin = std::chrono::steady_clock::now();
  ask();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count();
}

double mean(const std::vector<double>& x) {
  return x.empty() ? 0.0 : std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}
double median(const std::vector<double>& x) { return x.empty() ? 0.0 : quartiles(x).median; }

// The number of wrong answers of a peer, against an instant that touches and the time before which nothing does.
struct Errors {
  int missed = 0, late = 0, too_early = 0;
  void add(const std::optional<double>& answer, const std::optional<double>& touches, double not_before, double end) {
    missed += touches && !answer;
    late += touches && answer && *answer * end > *touches;
    // An answer is too early by more than a thousandth of the step, or where there is no contact.
    too_early += answer && (*answer * end < not_before - 1e-3 * end);
  }
};

class Bench {
 public:
  Bench(std::string name, const TriangleMesh& mesh, bool quick, bool alone)
      : name_(std::move(name)), quick_(quick), alone_(alone), soup_(soup_of(mesh)), tree_(soup_), fcl_(mesh) {
    tree_.build_all();
    pairs_ = pairs_of(make_motion(mesh, quick ? 6 : 61, 1));
    std::ranges::shuffle(pairs_, std::mt19937(5));
  }

  void run(double step_s) {
    const std::size_t n = pairs_.size();
    std::vector<double> contact(n, kLongest), impact(n, kLongest);
    std::vector<MeshImpact> found(n);
    std::vector<char> touching(n);
    for (int timing = 0; timing < kTimings; ++timing) {
      for (std::size_t i = 0; i < n; ++i) {
        const auto& [a, b] = pairs_[i];
        PolygonPair pair{};
        contact[i] = std::min(contact[i], time_us([&] {
                                touching[i] =
                                    contacts_.find_pair(tree_, tree_, RelativeMotion(a.pose(), b.pose()), pair);
                              }));
      }
      for (std::size_t i = 0; i < n; ++i) {
        const auto& [a, b] = pairs_[i];
        impact[i] = std::min(impact[i], time_us([&] { found[i] = impacts_.first_impact(tree_, a, tree_, b, step_s); }));
      }
    }
    std::vector<double> contact_us, impact_us, hit_us, separated_us, touching_us, iterations;
    std::size_t hits = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (touching[i]) {
        touching_us.push_back(impact[i]);
        wrong += found[i].state != MeshImpactState::kOverlapped;
        continue;
      }
      contact_us.push_back(contact[i]);
      impact_us.push_back(impact[i]);
      iterations.push_back(found[i].iterations);
      hits += found[i].state == MeshImpactState::kHit;
      (found[i].state == MeshImpactState::kHit ? hit_us : separated_us).push_back(impact[i]);
      wrong += is_wrong(pairs_[i], found[i], step_s);
    }
    std::printf("%-8s %6zu %5g %6zu %6zu %9.2f %9.2f %9.2f %9.2f %7.2f %9.2f %9.2f %9.2f %8.1f\n", name_.c_str(),
                soup_.faces.size(), step_s, impact_us.size(), hits, mean(contact_us), median(contact_us),
                mean(impact_us), median(impact_us), mean(impact_us) / mean(contact_us), mean(hit_us),
                mean(separated_us), mean(touching_us), mean(iterations));
    std::fflush(stdout);
    add(step_s, "first_contact", contact_us);
    add(step_s, "impact", impact_us, "first_contact", contact_us);
    add(step_s, "impact.hit", hit_us);
    add(step_s, "impact.separated", separated_us);
    add(step_s, "impact.touching", touching_us);
    figures.push_back({label(step_s, "hits"), static_cast<double>(hits), "1", "", std::nullopt, 0, 0});
    figures.push_back({label(step_s, "iterations"), mean(iterations), "1/pair", "", std::nullopt, 0, 0});
    if (!alone_) run_fcl(step_s, touching, impact, found);
  }

  std::vector<Figure> figures;
  std::size_t wrong = 0;

 private:
  static constexpr double kLongest = std::numeric_limits<double>::infinity();

  [[nodiscard]] std::string label(double step_s, const char* what) const {
    char text[96];
    std::snprintf(text, sizeof text, "%s.%zu.step_%g.%s", name_.c_str(), soup_.faces.size(), step_s, what);
    return text;
  }
  void add(double step_s, const char* what, const std::vector<double>& us, const char* against = nullptr,
           const std::vector<double>& against_us = {}) {
    if (us.empty()) return;
    const Quartiles q = quartiles(us);
    std::optional<double> ratio;
    if (against != nullptr && !against_us.empty()) ratio = mean(us) / mean(against_us);
    figures.push_back({label(step_s, what) + ".mean", mean(us), "us",
                       against != nullptr ? label(step_s, against) + ".mean" : std::string(), ratio, q.low, q.high});
    figures.push_back({label(step_s, what) + ".median", q.median, "us", "", std::nullopt, q.low, q.high});
  }

  bool touch(const MovingPair& pair, double t) {
    PolygonPair of{};
    return contacts_.find_pair(tree_, tree_, {advance(pair.a, t).pose(), advance(pair.b, t).pose()}, of);
  }

  // An instant that touches: even ones, and for hits ones that follow them ever farther.
  std::optional<double> touches_at(const MovingPair& pair, const MeshImpact& impact, double step_s) {
    std::optional<double> first;
    for (int i = 1; i <= kInstants && !first; ++i) {
      if (touch(pair, step_s * i / kInstants)) first = step_s * i / kInstants;
    }
    if (impact.state != MeshImpactState::kHit) return first;
    for (double ahead = 1e-8 * step_s; impact.time_s + ahead < first.value_or(step_s); ahead *= 1.5) {
      if (touch(pair, impact.time_s + ahead)) return impact.time_s + ahead;
    }
    return first;
  }

  bool is_wrong(const MovingPair& pair, const MeshImpact& impact, double step_s) {
    const auto touches = touches_at(pair, impact, step_s);
    const bool good = impact.state == MeshImpactState::kHit ? !touches || impact.time_s <= *touches
                                                            : impact.state == MeshImpactState::kSeparated && !touches;
    if (!good) {
      std::printf("WRONG: %s, state %d at %.17g s, touches at %.17g\n", name_.c_str(), static_cast<int>(impact.state),
                  impact.time_s, touches.value_or(-1.0));
    }
    return !good;
  }

  void run_fcl(double step_s, const std::vector<char>& touching, const std::vector<double>& impact,
               const std::vector<MeshImpact>& found) {
    std::vector<double> ours_us, advancement_us, naive_us;
    Errors of_advancement, of_naive;
    double spent_us = 0.0;
    for (std::size_t i = 0; i < pairs_.size() && spent_us < (quick_ ? 0.1 : 1.0) * kFclShare_s * 1e6; ++i) {
      if (touching[i]) continue;
      const auto& [a, b] = pairs_[i];
      const FclImpact::Way way_a{placement_of(a), placement_of(advance(a, step_s))},
          way_b{placement_of(b), placement_of(advance(b, step_s))};
      std::optional<double> advanced, sampled;
      advancement_us.push_back(time_us([&] { advanced = fcl_.advance(way_a, way_b); }));
      naive_us.push_back(time_us([&] { sampled = fcl_.sample(way_a, way_b, kNaiveInstants); }));
      ours_us.push_back(impact[i]);
      spent_us += advancement_us.back() + naive_us.back();
      const auto touches = touches_at(pairs_[i], found[i], step_s);
      of_advancement.add(advanced, touches, found[i].time_s, step_s);
      of_naive.add(sampled, touches, found[i].time_s, step_s);
    }
    const auto print = [&](const char* what, const std::vector<double>& us, const Errors& errors) {
      std::printf(
          "  %-16s %4zu pairs: %10.2f us, ours %8.2f; %d contacts not found, %d late, %d early by > 0.1 %% of "
          "the step\n",
          what, us.size(), mean(us), mean(ours_us), errors.missed, errors.late, errors.too_early);
    };
    print("fcl_advancement", advancement_us, of_advancement);
    print("fcl_naive", naive_us, of_naive);
    std::fflush(stdout);
    add(step_s, "impact.of_fcls", ours_us, "fcl_advancement", advancement_us);
    add(step_s, "fcl_advancement", advancement_us);
    add(step_s, "fcl_naive", naive_us);
    const auto count = [&](const char* what, int n) {
      figures.push_back({label(step_s, what), static_cast<double>(n), "1", "", std::nullopt, 0, 0});
    };
    count("fcl_advancement.missed", of_advancement.missed);
    count("fcl_advancement.late", of_advancement.late);
    count("fcl_advancement.early", of_advancement.too_early);
    count("fcl_naive.missed", of_naive.missed);
    count("fcl_naive.late", of_naive.late);
  }

  std::string name_;
  bool quick_, alone_;
  collision::TriangleSoup soup_;
  WideTree tree_;
  FclImpact fcl_;
  std::vector<MovingPair> pairs_;
  WideQuery contacts_;
  MeshImpactQuery impacts_;
};

int run(const Options& options) {
  std::vector<std::string> meshes = options.arguments;
  const bool alone = std::erase(meshes, "--alone") > 0;
  std::vector<int> sizes = {8000};
  if (meshes.empty()) {
    meshes = {"knot", "sphere", "tree"};
    sizes = {8000, 32000, 64000};
  }
  if (options.quick) sizes = {500};
  std::vector<Figure> figures;
  std::size_t wrong = 0;
  std::printf("%-8s %6s %5s %6s %6s %9s %9s %9s %9s %7s %9s %9s %9s %8s\n", "mesh", "tris", "step", "pairs", "hits",
              "contact", "median", "impact", "median", "ratio", "hits", "none", "touching", "iterat.");
  for (const std::string& what : meshes) {
    for (const int triangles : sizes) {
      const auto mesh = make_triangle_mesh(what, triangles, 1);
      if (!mesh) {
        std::fprintf(stderr, "error: %s\n", mesh.error().c_str());
        return 2;
      }
      Bench bench(std::filesystem::path(what).stem().string(), *mesh, options.quick, alone);
      for (const double step_s : {1.0, 0.25, 4.0, 16.0}) bench.run(step_s);
      figures.insert(figures.end(), bench.figures.begin(), bench.figures.end());
      wrong += bench.wrong;
    }
  }
  if (!write_figures(options, figures)) return 3;
  if (wrong > 0) std::fprintf(stderr, "error: %zu wrong answers; see above\n", wrong);
  return wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace peerd::bench::peers

int main(int argc, char** argv) { return peerd::bench::peers::run(peerd::bench::parse_options(argc, argv)); }
