// Question: how long does the distance of two meshes take, exact or to a tenth, at distances from touching to ten times
// their size, beside fcl::distance() on OBBRSS of the same meshes and places?
//
// distance_bench [--quick] [--out DIR] [--commit NAME] [FILE..]: two copies of a mesh of 64k triangles with a radius of
// 1 m (knot, sphere, or FILEs), each turned anyhow, one moved towards the other until they are as far apart as asked. A
// place's time is the least of some. Exit code 1: an interval of ours is wider than asked, or FCL's exact answer is not
// in it, but for 1e-6 of the distance and 1e-9 m.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "bench/figures.hpp"
#include "bench/peers/fcl_distance.hpp"
#include "bench/peers/soup.hpp"
#include "collision/query/mesh_distance.hpp"

namespace peerd::bench::peers {
namespace {

using collision::MeshDistance;
using collision::MeshDistanceQuery;
using collision::RelativeMotion;
using collision::TriangleSoup;
using collision::WideTree;

Placement placement_of(const Mat3& rotation, const Vec3& position) {
  Placement out{};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) out.rotation[row][column] = rotation(row, column);
  }
  out.position = {position[0], position[1], position[2]};
  return out;
}

template <class Ask>
double least_us(int times, Ask ask) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < times; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    ask();
    least =
        std::min(least, std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count());
  }
  return least;
}

double mean(const std::vector<double>& x) {
  double sum = 0.0;
  for (const double value : x) sum += value;
  return sum / static_cast<double>(x.size());
}

class Bench {
 public:
  Bench(std::string name, const TriangleMesh& mesh, bool quick)
      : name_(std::move(name)), quick_(quick), soup_(soup_of(mesh)), tree_(soup_), fcl_(mesh) {
    tree_.build_all();
  }

  // Places at which they are that far apart, to a twentieth; where 0 is asked, deep in each other.
  std::vector<RelativeMotion> places(double distance_m, std::size_t count) {
    std::mt19937_64 random(42);
    std::normal_distribution<double> normal;
    std::vector<RelativeMotion> out;
    while (out.size() < count) {
      const auto four = [&] { return std::array{normal(random), normal(random), normal(random), normal(random)}; };
      const auto q = four(), d = four();
      Pose there{Vec3::Zero(), Quat(q[0], q[1], q[2], q[3]).normalized()};
      const Vec3 from = Vec3(d[0], d[1], d[2]).normalized();
      double away = distance_m == 0.0 ? 0.3 : 3.0 + distance_m;
      for (int step = 0; step < 60; ++step) {
        there.position = away * from;
        const double now = query_.distance(tree_, tree_, {Pose{}, there}, {.relative_accuracy = 0.01}).upper_m;
        const double over = now - distance_m;
        if (std::abs(over) <= 0.05 * distance_m) {
          out.emplace_back(Pose{}, there);
          break;
        }
        away -= over > 0.0 ? over : 0.5 * over;
      }
    }
    return out;
  }

  void run(double distance_m, double relative) {
    std::vector<double> us, fcl_us, iterations;
    const std::size_t count = quick_ ? 4 : 50;
    for (const RelativeMotion& motion : places(distance_m, count)) {
      const Placement here = placement_of(Mat3::Identity(), Vec3::Zero()),
                      there = placement_of(motion.rotation, motion.translation);
      MeshDistance found;
      double fcl = 0.0;
      us.push_back(least_us(quick_ ? 1 : 5,
                            [&] { found = query_.distance(tree_, tree_, motion, {.relative_accuracy = relative}); }));
      fcl_us.push_back(least_us(quick_ ? 1 : 2, [&] { fcl = fcl_(here, there, relative); }));
      iterations.push_back(found.iterations);
      if (relative > 0.0) fcl = fcl_(here, there, 0.0);
      const double slack = 1e-9 + 1e-6 * distance_m;
      fcl = std::max(fcl, 0.0);
      if (fcl < found.lower_m - slack || fcl > found.upper_m + slack ||
          found.upper_m - found.lower_m > relative * found.upper_m * (1.0 + 1e-9) + 1e-12) {
        std::printf("  WRONG: [%.12g, %.12g], FCL %.12g\n", found.lower_m, found.upper_m, fcl);
        ++wrong;
      }
    }
    const double ratio = mean(fcl_us) / mean(us);
    std::printf(
        "  %-8s %8.4g m, to %4.0f %%: mean %9.2f us, median %9.2f us, %8.1f iterations; FCL %10.2f us, %7.1f times\n",
        name_.c_str(), distance_m, 100.0 * relative, mean(us), quartiles(us).median, mean(iterations), mean(fcl_us),
        ratio);
    std::fflush(stdout);
    char label[80];
    std::snprintf(label, sizeof label, "%s.%g_m.to_%g", name_.c_str(), distance_m, relative);
    const std::string cell = label;
    figures.push_back({cell + ".fcl_obbrss", mean(fcl_us), "us", "", std::nullopt});
    figures.push_back({cell + ".peerd", mean(us), "us", cell + ".fcl_obbrss", mean(us) / mean(fcl_us)});
    figures.push_back({cell + ".iterations", mean(iterations), "1", "", std::nullopt});
  }

  std::vector<Figure> figures;
  int wrong = 0;

 private:
  std::string name_;
  bool quick_;
  TriangleSoup soup_;
  WideTree tree_;
  FclDistance fcl_;
  MeshDistanceQuery query_;
};

}  // namespace
}  // namespace peerd::bench::peers

int main(int argc, char** argv) {
  using namespace peerd::bench;
  const Options options = parse_options(argc, argv);
  std::vector<std::string> meshes = options.arguments;
  if (meshes.empty()) meshes = {"knot", "sphere"};
  std::vector<Figure> figures;
  int wrong = 0;
  for (const std::string& what : meshes) {
    const auto mesh = peers::make_triangle_mesh(what, options.quick ? 2000 : 65536, 1);
    if (!mesh) {
      std::fprintf(stderr, "error: %s\n", mesh.error().c_str());
      return 2;
    }
    const std::size_t slash = what.rfind('/');
    peers::Bench bench(slash == std::string::npos ? what : what.substr(slash + 1), *mesh, options.quick);
    for (const double relative : {0.1, 0.0}) {
      for (const double distance_m : {0.0, 1e-4, 1e-2, 0.1, 1.0, 20.0}) bench.run(distance_m, relative);
    }
    figures.insert(figures.end(), bench.figures.begin(), bench.figures.end());
    wrong += bench.wrong;
  }
  if (!write_figures(options, figures)) return 2;
  return wrong == 0 ? 0 : 1;
}
