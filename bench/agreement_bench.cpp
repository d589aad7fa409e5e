// Question: do our transforms, Extrusions, ElevationGrids, solids and interpolators agree with Coin's?
//
// agreement_bench [--quick] [--out DIR] [--commit NAME]: both read the same generated texts, whose numbers are binary32
// to the last digit; what differs is then what is computed. Ours is binary64 and rounds once at most, Coin computes in
// binary32: each bound below counts its roundings on the way to an answer, of u = 2^-24 each, to first order. A figure
// is the largest difference, and its ratio the largest to the bound of its own case. Exit code 1: one is over its
// bound.
//
// Where Coin does what the standard (ISO/IEC 14772-1) has otherwise or leaves open, the case is not judged, but is
// listed with how far apart the two are. Whether it is such a case is decided here, from its numbers and before looking
// at any answer.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "coin_answers.hpp"
#include "coin_reader.hpp"
#include "core/animation/interpolator.hpp"
#include "core/geometry/tessellate.hpp"
#include "core/geometry/triangulation.hpp"
#include "core/scene/reader.hpp"
#include "core/vrml/default_values.hpp"
#include "core/vrml/document.hpp"
#include "figures.hpp"
#include "generated_text.hpp"

namespace peerd::bench {
namespace {

constexpr double kU = 0x1p-24;  // of one rounding to binary32, relative
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr const char* kHeader = "#VRML V2.0 utf8\n";

using Triangles = std::vector<Triangle>;

// This section holds the quantities that are compared.

struct Quantity {
  std::string name, unit;
  bool judged = true;
  std::string note;  // why it is not judged
  std::size_t cases = 0, over = 0;
  double difference = 0, ratio = 0;
  std::string worst = {};  // the case of `ratio`
};

class Report {
 public:
  void compare(const char* name, const char* unit, double difference, double bound, const std::string& of) {
    add(find(name, unit, true, ""), difference, bound, of);
  }
  void leave_out(const char* name, const char* unit, const char* why, double difference, double bound,
                 const std::string& of) {
    add(find(name, unit, false, why), difference, bound, of);
  }
  void wrong(const std::string& what) { wrong_.push_back(what); }

  [[nodiscard]] bool print() const {
    std::printf("%-32s %8s %12s %-4s %9s  %s\n", "judged", "cases", "largest", "", "/bound", "where");
    for (const Quantity& q : quantities_) {
      if (!q.judged) continue;
      std::printf("%-32s %8zu %12.3g %-4s %9.3f  %s%s\n", q.name.c_str(), q.cases, q.difference, q.unit.c_str(),
                  q.ratio, q.worst.c_str(),
                  q.over > 0 ? (" WRONG: " + std::to_string(q.over) + " over the bound").c_str() : "");
    }
    std::printf("%-32s %8s %12s %-4s %9s  %s\n", "not judged", "cases", "largest", "", "differ", "why");
    for (const Quantity& q : quantities_) {
      if (q.judged) continue;
      std::printf("%-32s %8zu %12.3g %-4s %9zu  %s\n", q.name.c_str(), q.cases, q.difference, q.unit.c_str(), q.over,
                  q.note.c_str());
    }
    for (const std::string& what : wrong_) std::printf("WRONG: %s\n", what.c_str());
    return wrong_.empty() && std::ranges::none_of(quantities_, [](const auto& q) { return q.judged && q.over > 0; });
  }
  [[nodiscard]] std::vector<Figure> figures() const {
    std::vector<Figure> figures;
    for (const Quantity& q : quantities_) {
      const auto ratio = q.judged ? std::optional(q.ratio) : std::nullopt;
      figures.push_back({q.name, q.difference, q.unit, "Coin", ratio, q.difference, q.difference});
    }
    return figures;
  }

 private:
  static void add(Quantity& q, double difference, double bound, const std::string& of) {
    ++q.cases;
    if (!(difference <= bound)) ++q.over;  // nor where it is none
    if (!(difference <= q.difference)) q.difference = difference;
    const double ratio = difference == 0 ? 0 : difference / bound;
    if (!(ratio <= q.ratio)) q.ratio = ratio, q.worst = of;
  }
  Quantity& find(const char* name, const char* unit, bool judged, const char* why) {
    for (Quantity& q : quantities_) {
      if (q.name == name) return q;
    }
    quantities_.push_back({.name = name, .unit = unit, .judged = judged, .note = why});
    return quantities_.back();
  }
  std::vector<Quantity> quantities_;  // in the order of their first case
  std::vector<std::string> wrong_;
};

struct World {
  std::string name, text;
};

// Both readings of a world; says so where there is none.
struct Readings {
  Scene ours;
  std::vector<Triangles> coins;
};
std::optional<Readings> read_both(const World& world, Report& report) {
  ReadResult ours = read_world(world.text);
  if (!ours.scene) return report.wrong(world.name + " cannot be read"), std::nullopt;
  auto coins = shapes_of_coin(world.text);
  if (!coins) return report.wrong(world.name + " cannot be read by Coin"), std::nullopt;
  return Readings{std::move(*ours.scene), std::move(*coins)};
}

// Triangles

Triangles triangles_of(const Mesh& mesh, std::size_t begin, std::size_t end) {
  Triangulator triangulator;
  Triangles out;
  for (std::size_t i = begin; i < end; ++i) {
    const auto polygon = mesh.polygon(i);
    for (const CornerTriangle& t : triangulator.triangulate(mesh, i)) {
      Triangle& triangle = out.emplace_back();
      for (std::size_t k = 0; k < 3; ++k) {
        triangle[k] = mesh.vertices[static_cast<std::size_t>(polygon[t[k]])].cast<double>();
      }
    }
  }
  return out;
}

// The quadrilaterals [0, end) cut from corner `from` to the one across: where they are not planar, 6.17 and 6.18 leave
// the cut open, and this is Coin's.
Triangles cut_quadrilaterals(const Mesh& mesh, std::size_t end, std::size_t from) {
  Triangles out;
  for (std::size_t i = 0; i < end; ++i) {
    const auto polygon = mesh.polygon(i);
    const auto p = [&](std::size_t k) -> Vec3 {
      return mesh.vertices[static_cast<std::size_t>(polygon[(from + k) % 4])].cast<double>();
    };
    out.push_back({p(0), p(1), p(2)});
    out.push_back({p(0), p(2), p(3)});
  }
  return out;
}

struct Measures {
  double area = 0, volume = 0;                      // of the cones from `origin`: its sign says which side is the front
  double area_by_vertex = 0, volume_by_vertex = 0;  // how far they move at most when every vertex moves by 1
};
Measures measures_of(const Triangles& triangles, const Vec3& origin) {
  Measures m;
  for (const Triangle& t : triangles) {
    const Vec3 a = t[0] - origin, b = t[1] - origin, c = t[2] - origin;
    m.area += (b - a).cross(c - a).norm() / 2;
    m.volume += a.dot(b.cross(c)) / 6;
    m.area_by_vertex += ((b - a).norm() + (c - b).norm() + (a - c).norm()) / 2;
    m.volume_by_vertex += (a.norm() * b.norm() + b.norm() * c.norm() + c.norm() * a.norm()) / 6;
  }
  return m;
}

std::vector<Vec3> corners_of(const Triangles& triangles) {
  std::vector<Vec3> out;
  for (const Triangle& t : triangles) out.insert(out.end(), t.begin(), t.end());
  const auto less = [](const Vec3& a, const Vec3& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::ranges::sort(out, less);
  out.erase(std::ranges::unique(out).begin(), out.end());
  return out;
}

// How far the farthest element of either is from the nearest of the other.
template <class T>
double apart(const std::vector<T>& a, const std::vector<T>& b, auto distance) {
  double farthest = 0;
  const auto from = [&](const std::vector<T>& these, const std::vector<T>& those, bool swapped) {
    for (const T& x : these) {
      double nearest = kInfinity;
      for (const T& y : those) nearest = std::min(nearest, swapped ? distance(y, x) : distance(x, y));
      farthest = std::max(farthest, nearest);
    }
  };
  from(a, b, false);
  from(b, a, true);
  return farthest;
}
double apart(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  return apart(a, b, [](const Vec3& p, const Vec3& q) { return (p - q).norm(); });
}
// Compares corner by corner in the same sense; any corner may come first.
double apart(const Triangles& a, const Triangles& b) {
  if (a.size() != b.size()) return kInfinity;
  return apart(a, b, [](const Triangle& s, const Triangle& t) {
    double best = kInfinity;
    for (std::size_t turn = 0; turn < 3; ++turn) {
      double worst = 0;
      for (std::size_t k = 0; k < 3; ++k) worst = std::max(worst, (s[k] - t[(k + turn) % 3]).norm());
      best = std::min(best, worst);
    }
    return best;
  });
}

// Numbers in texts. A number that was cut to binary32 reads as that again.

double cut(double x) { return static_cast<double>(static_cast<float>(x)); }
void number(std::string& out, double x) { append(out, "%.9g ", cut(x)); }
void vector(std::string& out, const char* field, const Vec3& v) {
  append(out, "%s ", field);
  for (const double x : v) number(out, x);
}
Vec3 random_vector(Random& random, double most) {
  return {random.real(-most, most), random.real(-most, most), random.real(-most, most)};
}
Vec3 random_direction(Random& random) {
  for (;;) {
    const Vec3 v = random_vector(random, 1);
    if (v.norm() > 0.1 && v.norm() <= 1) return v.normalized();
  }
}
void rotation(std::string& out, Random& random) {
  for (const double x : random_direction(random)) number(out, x);
  number(out, random.real(-6.3, 6.3));
}

// Transforms

// A tetrahedron and a parallelogram.
void shape(std::string& out, Random& random) {
  out += "Shape { geometry IndexedFaceSet { coordIndex [0 2 1 -1 0 1 3 -1 1 2 3 -1 2 0 3 -1 4 5 6 7 -1]\n";
  out += "coord Coordinate { point [";
  for (int i = 0; i < 4; ++i) vector(out, "", random_vector(random, 1));
  const Vec3 corner = random_vector(random, 1), u = random_direction(random), v = u.cross(random_direction(random));
  for (const Vec3& p : {corner, Vec3(corner + u), Vec3(corner + u + v), Vec3(corner + v)}) vector(out, "", p);
  out += "] } } }\n";
}

void nest(std::string& out, Random& random, std::uint32_t levels) {
  out += "Transform {\n";
  if (random.below(4) > 0) vector(out, "translation", random_vector(random, 10));
  if (random.below(4) > 0) out += "rotation ", rotation(out, random);
  if (random.below(3) > 0) {
    const auto factor = [&] { return std::exp2(random.real(-2, 2)); };
    const double all = factor();
    vector(out, "scale", random.below(4) == 0 ? Vec3(all, all, all) : Vec3(factor(), factor(), factor()));
  }
  if (random.below(3) > 0) out += "scaleOrientation ", rotation(out, random);
  if (random.below(3) > 0) vector(out, "center", random_vector(random, 5));
  out += "children [\n";
  if (levels == 1 || random.below(3) == 0) shape(out, random);
  if (levels > 1) nest(out, random, levels - 1);
  if (levels > 1 && random.below(4) == 0) nest(out, random, 1 + random.below(levels - 1));
  out += "] }\n";
}

// The bound is on the rounding error of a vertex p below a path of transforms. For each of them, Coin's model matrix
// takes six products of matrices, each entry a sum of four (4 u), one product with the matrix of the transforms above
// (4 u), and three matrices from axis and angle (12 u each). All of these are relative to the magnitudes, which grow as
// |p| -> |translation| + |center| + largest scale (|p| + |center|) level by level: the magnitudes of a rotation's
// entries may add to sqrt 3 of that, but roundings don't all add up either. Applying the matrix takes 4 u.
double transform_bound(const Scene& scene, std::size_t instance, double p) {
  double roundings = 4;
  for (auto i = static_cast<std::int32_t>(instance); i >= 0; i = scene.instances[static_cast<std::size_t>(i)].parent) {
    const Instance& at = scene.instances[static_cast<std::size_t>(i)];
    if (at.transform == Instance::kNone) continue;
    const TransformFields& t = scene.transforms[at.transform];
    p = t.translation.norm() + t.center.norm() + t.scale.maxCoeff() * (p + t.center.norm());
    roundings += 6 * 4 + 4 + 3 * 12;
  }
  return roundings * kU * p;
}

void compare_transforms(bool quick, Report& report) {
  for (std::uint32_t seed = 1; seed <= (quick ? 20u : 600u); ++seed) {
    Random random(seed);
    World world{"nest " + std::to_string(seed), kHeader};
    nest(world.text, random, 1 + seed % 10);
    const auto both = read_both(world, report);
    if (!both) continue;
    std::size_t shapes = 0;
    for (std::size_t i = 0; i < both->ours.instances.size(); ++i) {
      const Instance& instance = both->ours.instances[i];
      if (instance.geometry == Instance::kNone) continue;
      if (shapes == both->coins.size()) {
        report.wrong(world.name + ": Coin has fewer shapes");
        break;
      }
      const Mesh mesh = build_mesh(both->ours.geometries[instance.geometry]);
      const Eigen::Affine3d world_from_local = both->ours.world_from_local(ObjectId{static_cast<std::uint32_t>(i)});
      Triangles ours = triangles_of(mesh, 0, mesh.polygon_count());
      double magnitude = 0, farthest = 0;
      for (Triangle& t : ours) {
        for (Vec3& p : t) {
          magnitude = std::max(magnitude, p.norm());
          p = world_from_local * p;
          farthest = std::max(farthest, p.norm());
        }
      }
      const double bound = transform_bound(both->ours, i, magnitude);
      const double difference = apart(ours, both->coins[shapes++]);
      report.compare("transforms.vertex", "m", difference, bound, world.name);
      report.compare("transforms.vertex_relative", "1", difference / farthest, bound / farthest, world.name);
    }
    if (shapes != both->coins.size()) report.wrong(world.name + ": Coin has more shapes");
  }
}

// ElevationGrids

// Coin adds a spacing up as often as there are columns, or rows.
void compare_grids(bool quick, Report& report) {
  for (std::uint32_t seed = 1; seed <= (quick ? 10u : 200u); ++seed) {
    Random random(seed);
    World world{"grid " + std::to_string(seed), kHeader};
    const std::uint32_t columns = 2 + random.below(20), rows = 2 + random.below(20);
    const double x_spacing = cut(random.real(0.05, 3)), z_spacing = cut(random.real(0.05, 3));
    const double steep = std::exp2(random.real(-6, 3));
    append(world.text, "Shape { geometry ElevationGrid { xDimension %u zDimension %u xSpacing %.9g zSpacing %.9g\n",
           columns, rows, x_spacing, z_spacing);
    world.text += "height [";
    for (std::uint32_t i = 0; i < columns * rows; ++i) number(world.text, random.real(-steep, steep));
    world.text += "] } }\n";
    const auto both = read_both(world, report);
    if (!both) continue;
    const Mesh mesh = build_mesh(both->ours.geometries.at(0));
    const Triangles ours = cut_quadrilaterals(mesh, mesh.polygon_count(), 1), &coins = both->coins.at(0);
    const double x_rounding = columns * (columns * x_spacing) * kU, z_rounding = rows * (rows * z_spacing) * kU;
    const double bound = std::hypot(x_rounding, z_rounding);
    const Measures our = measures_of(ours, Vec3::Zero()), coin = measures_of(coins, Vec3::Zero());
    report.compare("grid.vertex", "m", apart(corners_of(ours), corners_of(coins)), bound, world.name);
    report.compare("grid.triangle", "m", apart(ours, coins), bound, world.name);
    report.compare("grid.area", "m2", std::abs(our.area - coin.area), our.area_by_vertex * bound, world.name);
    report.compare("grid.volume", "m3", std::abs(our.volume - coin.volume), our.volume_by_vertex * bound, world.name);
    // 6.17 says which four points a quadrilateral has, and not how it is cut where they aren't planar. We cut from
    // [i, j] to [i + 1, j + 1], or as ear clipping does; Coin along the other diagonal.
    const double area = measures_of(triangles_of(mesh, 0, mesh.polygon_count()), Vec3::Zero()).area;
    report.leave_out("grid.area_by_our_cut", "m2", "6.17 leaves open how a quadrilateral is cut that isn't planar",
                     std::abs(area - coin.area), our.area_by_vertex * bound, world.name);
  }
}

// Extrusions

enum SpineKind : std::uint32_t {
  kStraight,
  kDown,
  kBent,
  kZigzag,
  kWithMiddles,  // of some segments: collinear points in a bent spine
  kSpiral,
  kRing,
  kKnot,
  kThereAndBack,
  kGentle,
  kDecimals,  // collinear before they are cut to binary32
  kCoincident,
  kSpineKinds
};
constexpr const char* kSpineNames[] = {"straight",       "straight_down", "bent",     "zigzag",
                                       "with_middles",   "spiral",        "ring",     "knot",
                                       "there_and_back", "gentle",        "decimals", "coincident"};

using Path = std::vector<Vec3>;

// Steps in random directions, none nearly along the last, on a grid that has all middles.
Path random_path(Random& random, std::size_t points, bool flat) {
  const auto on_grid = [](double x) { return std::round(x * 64) / 64; };
  Path path = {Vec3::Zero()};
  Vec3 last = Vec3::Zero();
  while (path.size() < points) {
    Vec3 d = random_direction(random);
    if (flat) d = Vec3(d.x(), d.y(), 0.5 * d.x()).normalized();
    if (std::abs(d.dot(last)) > 0.97) continue;
    const Vec3 step = (d * random.real(1, 4)).unaryExpr(on_grid);
    last = step.normalized();
    path.push_back(path.back() + step);
  }
  return path;
}

Path make_spine(SpineKind kind, Random& random) {
  const std::size_t points = 3 + random.below(8);
  const Vec3 u = random_direction(random), v = u.cross(random_direction(random)).normalized(), w = u.cross(v);
  Path path;
  switch (kind) {
    case kStraight:
    case kDown: {
      Vec3 d = kind == kDown ? Vec3(0, -1, 0) : Vec3((random_direction(random) * 8).array().round() / 8);
      if (d.x() == 0 && d.z() == 0 && kind != kDown) d.y() = 1;
      double at = 0;
      for (std::size_t i = 1 + random.below(8); i < 10; ++i, at += 1 + random.below(5)) path.push_back(at * d);
      return path;
    }
    case kBent:
      return random_path(random, points, false);
    case kZigzag:
      return random_path(random, points, true);
    case kWithMiddles:
      for (const Vec3& p : random_path(random, points, false)) {
        if (!path.empty() && random.below(2) == 0) path.emplace_back((path.back() + p) / 2);
        path.push_back(p);
      }
      return path;
    case kSpiral:
    case kGentle: {
      const double turn = 2 * std::numbers::pi / (kind == kGentle ? random.real(200, 400) : random.real(5, 20));
      const double radius = random.real(1, 4), rise = random.real(0, 0.5) * turn * radius;
      const std::size_t steps = kind == kGentle ? 100 : 8 + random.below(30);
      for (std::size_t i = 0; i < steps; ++i) {
        const auto t = static_cast<double>(i);
        path.emplace_back(radius * std::cos(turn * t) * u + radius * std::sin(turn * t) * v + rise * t * w);
      }
      return path;
    }
    case kRing: {
      for (std::size_t i = 0; i < points; ++i) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(points);
        path.emplace_back(random.real(2, 4) * (std::cos(angle) * u + std::sin(angle) * v));
      }
      path.push_back(path.front());
      return path;
    }
    case kKnot:
      path = random_path(random, points + 1, false);
      path.push_back(path.front());
      return path;
    case kThereAndBack:
      path = random_path(random, points, false);
      path.push_back(path[path.size() - 2]);
      path.push_back(path.back() + Vec3(0.25, 1, 3));
      return path;
    case kDecimals: {  // multiples of one decimal; binary32 has none of them
      const Vec3 d = (random_direction(random) * 9).array().round() + Vec3(0, 10, 0).array();
      for (std::size_t i = 0; i < points; ++i) path.emplace_back(0.1 * static_cast<double>(i) * d);
      return path;
    }
    default:
      path = random_path(random, points, false);
      path.insert(path.begin() + 1 + random.below(static_cast<std::uint32_t>(points - 1)), path[1]);
      for (std::size_t i = 1; i < path.size(); ++i) {
        if (path[i] == path[i - 1]) return path;
      }
      path.push_back(path.back());
      return path;
  }
}

World make_extrusion(std::uint32_t seed, SpineKind kind) {
  Random random(seed);
  World world{std::string(kSpineNames[kind]) + ' ' + std::to_string(seed), kHeader};
  const Path spine = make_spine(kind, random);
  std::string& out = world.text;
  const bool convex = random.below(2) == 0, closed = random.below(3) > 0;
  append(out, "Shape { geometry Extrusion { convex %s beginCap %s endCap %s\nspine [", convex ? "TRUE" : "FALSE",
         random.below(3) > 0 ? "TRUE" : "FALSE", random.below(3) > 0 ? "TRUE" : "FALSE");
  for (const Vec3& p : spine) vector(out, "", p);
  out += "]\ncrossSection [";
  const std::uint32_t points = convex ? 3 + random.below(6) : 2 * (3 + random.below(4));
  const bool left = random.below(2) == 0;
  for (std::uint32_t i = 0; i < points + (closed ? 1 : 0); ++i) {  // around an ellipse, or a star
    const double angle = (left ? -1 : 1) * 2 * std::numbers::pi * (i % points) / points;
    const double radius = convex || i % 2 == 0 ? 0.5 : 0.2;
    number(out, radius * std::cos(angle) + 0.1), number(out, 0.8 * radius * std::sin(angle));
  }
  out += "]\n";
  const auto count = [&] { return random.below(3) == 0 ? 1 : spine.size(); };
  if (random.below(2) == 0) {
    out += "scale [";
    for (std::size_t i = count(); i > 0; --i) number(out, random.real(0.3, 2)), number(out, random.real(0.3, 2));
    out += "]\n";
  }
  if (random.below(2) == 0) {
    out += "orientation [";
    for (std::size_t i = count(); i > 0; --i) rotation(out, random);
    out += "]\n";
  }
  out += "} }\n";
  return world;
}

struct SpineReading {
  const char* name = nullptr;  // of the cases that are not judged
  const char* why = nullptr;
  double sine = 1;  // the smallest that an axis is computed by
};

// Finds from the spine alone whether Coin's source follows 6.18.3 there.
SpineReading read_spine(std::span<const Eigen::Vector3f> points, bool decimals) {
  Path spine;
  for (const Eigen::Vector3f& p : points) spine.push_back(p.cast<double>());
  const std::size_t last = spine.size() - 1;
  const bool closed = spine.front() == spine.back();
  for (std::size_t i = 0; i < last; ++i) {
    // "If two points are coincident, they both have the same SCP." Coin takes each for the other's neighbour.
    if (spine[i] == spine[i + 1]) {
      return {"extrusion.coincident", "6.18.3: coincident points have the same SCP; Coin's differ", 1};
    }
  }
  // Spines that are made to be collinear have few bits, so that this test is exact for them.
  const auto collinear = [&](std::size_t i) { return (spine[1] - spine[0]).cross(spine[i] - spine[0]).isZero(0); };
  bool straight = true;  // decimals are, but for the rounding to binary32
  for (std::size_t i = 0; i <= last && !decimals; ++i) straight = straight && collinear(i);
  if (straight) {
    const Vec3 d = (spine[1] - spine[0]).normalized();
    const double sine = std::hypot(d.x(), d.z());
    if (sine > 0) return {nullptr, nullptr, sine};
    // "the rotation of a vector along the positive Y-axis to the vector formed by the spine points": of the many to the
    // opposite vector, both take the one about z.
    return {};
  }
  SpineReading reading;
  Vec3 first = Vec3::Zero(), before = Vec3::Zero();
  const auto undecided = [](double cosine) { return std::abs(cosine) < 1e-4; };
  for (std::size_t i = closed ? 0 : 1; i <= last - (closed ? 0 : 1); ++i) {
    const Vec3 to_next = ((i == last ? spine[1] : spine[i + 1]) - spine[i]);
    const Vec3 to_last = ((i == 0 ? spine[last - 1] : spine[i - 1]) - spine[i]);
    const Vec3 product = to_next.cross(to_last);
    if (product.isZero(0)) continue;
    const double sine = product.norm() / (to_next.norm() * to_last.norm());
    // "If the three points used in computing the Z-axis are collinear": Coin takes them for it from a cosine of 0.999.
    if (sine < 0.0448) {
      return {"extrusion.gentle_bend", "6.18.3: only collinear points keep the z axis; Coin's do below 2.6 degrees", 1};
    }
    reading.sine = std::min(reading.sine, sine);
    Vec3 z = product.normalized();
    if (!before.isZero(0)) {
      if (undecided(z.dot(before))) return {"extrusion.undecided", "6.18.3: z.z' about 0; may be flipped or not", 1};
      if (z.dot(before) < 0) z = -z;
    } else {
      first = z;
    }
    before = z;
  }
  // "If the spine curve is closed: The SCP for the first and last points is the same". Coin flips the last one.
  if (closed && before.dot(first) < 0) {
    return {"extrusion.closed_odd_flips", "6.18.3: a closed spine ends in its first SCP; Coin's z axis ends flipped",
            1};
  }
  return reading;
}

// The bound is on the rounding error of a vertex at the distance r from its spine point p. The y axis and the two
// directions for z take 5 u each (a difference, a length, a quotient); the directions' product takes 12 u by the sine
// between them, and 4 u to be a unit; x takes both and 6 u more; the orientation's matrix takes 12 u, two products of
// matrices and one of a vector 4 u each. Together they make (50 + 24 / sine) u of r, and 4 u of p.
double extrusion_bound(const ExtrusionGeometry& e, double sine) {
  double r = 0, p = 0, scale = e.scale.empty() ? 1 : 0;
  for (const auto& [x, z] : e.cross_section) r = std::max(r, std::hypot(double{x}, double{z}));
  for (const auto& [x, z] : e.scale) scale = std::max({scale, double{x}, double{z}});
  for (const Eigen::Vector3f& point : e.spine) p = std::max(p, point.cast<double>().norm());
  return ((50 + 24 / sine) * r * scale + 4 * (p + r * scale)) * kU;
}

void compare_extrusion(const World& world, SpineKind kind, Report& report) {
  const auto both = read_both(world, report);
  if (!both) return;
  const auto& e = std::get<ExtrusionGeometry>(both->ours.geometries.at(0));
  const SpineReading spine = read_spine(e.spine.span(), kind == kDecimals);
  const Mesh mesh = build_mesh(e);
  const std::size_t sides = (e.spine.size() - 1) * (e.cross_section.size() - 1);
  const Triangles& coins = both->coins.at(0);
  Triangles ours = cut_quadrilaterals(mesh, sides, 0);
  const Triangles caps = triangles_of(mesh, sides, mesh.polygon_count());
  const double bound = extrusion_bound(e, spine.sine);
  const double vertices = apart(corners_of(ours), corners_of(coins));
  if (spine.name != nullptr) return report.leave_out(spine.name, "m", spine.why, vertices, bound, world.name);
  report.compare((std::string("extrusion.") + kSpineNames[kind] + ".vertex").c_str(), "m", vertices, bound, world.name);

  const Vec3 origin = e.spine[0].cast<double>();
  if (e.spine[0] != e.spine[e.spine.size() - 1]) {
    ours.insert(ours.end(), caps.begin(), caps.end());
  } else if (!caps.empty()) {
    // 6.18.4: caps are generated "even if spine is also a closed curve".
    report.leave_out("extrusion.caps_of_closed", "m2", "6.18.4: a closed spine has caps too; Coin leaves them out",
                     measures_of(caps, origin).area, 0, world.name);
  }
  const Measures our = measures_of(ours, origin), coin = measures_of(coins, origin);
  report.compare("extrusion.area", "m2", std::abs(our.area - coin.area), our.area_by_vertex * bound, world.name);
  report.compare("extrusion.volume", "m3", std::abs(our.volume - coin.volume), our.volume_by_vertex * bound,
                 world.name);
}

void compare_extrusions(bool quick, Report& report) {
  for (std::uint32_t seed = 1; seed <= (quick ? 60u : 1'200u); ++seed) {
    const auto kind = static_cast<SpineKind>(seed % kSpineKinds);
    compare_extrusion(make_extrusion(seed, kind), kind, report);
  }
}

// Solids

void compare_solids(bool quick, Report& report) {
  for (std::uint32_t seed = 1; seed <= (quick ? 8u : 200u); ++seed) {
    Random random(seed);
    const double a = cut(random.real(0.1, 5)), b = cut(random.real(0.1, 5)), c = cut(random.real(0.1, 5));
    World world{"", kHeader};
    const std::uint32_t kind = seed % 4;
    world.text += "Shape { geometry ";
    if (kind == 0) append(world.text, "Box { size %.9g %.9g %.9g }", a, b, c);
    if (kind == 1) append(world.text, "Cone { bottomRadius %.9g height %.9g }", a, b);
    if (kind == 2) append(world.text, "Cylinder { radius %.9g height %.9g }", a, b);
    if (kind == 3) append(world.text, "Sphere { radius %.9g }", a);
    world.text += " }\n";
    world.name = "solid " + std::to_string(seed);
    const auto both = read_both(world, report);
    const auto coins_box = box_of_coin(world.text);
    if (!both || !coins_box) continue;
    const Mesh mesh = build_mesh(both->ours.geometries.at(0));
    const Triangles ours = triangles_of(mesh, 0, mesh.polygon_count()), &coins = both->coins.at(0);
    WorldBox box;
    for (const Vec3& p : corners_of(ours)) box.merge(p);
    const double size = std::max({a, b, c});
    const double corner = std::max((box.lo - coins_box->lo).norm(), (box.hi - coins_box->hi).norm());
    report.compare("solids.box", "m", corner, 4 * kU * size, world.name);  // halves, and a matrix of ones
    if (kind == 0) {
      const double area = measures_of(ours, Vec3::Zero()).area, coins_area = measures_of(coins, Vec3::Zero()).area;
      report.compare("solids.box_area", "m2", std::abs(area - coins_area), 8 * kU * area, world.name);
    }
    if (kind == 1) {  // from the apex to the farthest corner
      const auto side = [&](const Triangles& triangles) {
        double longest = 0;
        for (const Vec3& p : corners_of(triangles)) longest = std::max(longest, (p - Vec3(0, b / 2, 0)).norm());
        return longest;
      };
      report.compare("solids.cone_side", "m", std::abs(side(ours) - side(coins)), 8 * kU * side(ours), world.name);
    }
  }
}

// Interpolators

using animation::InterpolatorType;

struct InterpolatorKind {
  InterpolatorType type;
  const char *node, *figure, *unit;
  std::uint32_t floats;  // of keyValue a key
};
constexpr InterpolatorKind kInterpolators[] = {
    {InterpolatorType::kScalar, "ScalarInterpolator", "interpolator.scalar", "1", 1},
    {InterpolatorType::kPosition, "PositionInterpolator", "interpolator.position", "m", 3},
    {InterpolatorType::kCoordinate, "CoordinateInterpolator", "interpolator.coordinate", "m", 15},
    {InterpolatorType::kOrientation, "OrientationInterpolator", "interpolator.orientation", "rad", 4},
    {InterpolatorType::kColor, "ColorInterpolator", "interpolator.shades", "1", 3},
    {InterpolatorType::kColor, "ColorInterpolator", "interpolator.color", "1", 3}};

// Shades of one colour, exact ones: between them HSV and RGB are interpolated alike.
void color(std::string& out, Random& random, const Vec3& base, bool shades) {
  const Vec3 rgb = shades ? Vec3(base * std::exp2(-static_cast<double>(random.below(6))))
                          : Vec3(random.real(0, 1), random.real(0, 1), random.real(0, 1));
  vector(out, "", rgb);
}

World make_interpolator(const InterpolatorKind& kind, std::uint32_t seed, bool shades) {
  Random random(seed);
  World world{std::string(kind.node) + ' ' + std::to_string(seed), kHeader};
  const std::uint32_t keys = 1 + random.below(12);
  std::vector<double> key;
  for (std::uint32_t i = 0; i < keys; ++i) key.push_back(random.real(-0.5, 1.5));
  for (std::uint32_t i = 1; i < keys; ++i) {
    if (random.below(5) == 0) key[i] = key[i - 1];  // two values at once: both jump
  }
  std::ranges::sort(key);
  append(world.text, "%s { key [", kind.node);
  for (const double k : key) number(world.text, k);
  world.text += "]\nkeyValue [";
  const Vec3 base(random.below(17) / 16.0, random.below(17) / 16.0, random.below(17) / 16.0);
  for (std::uint32_t i = 0; i < keys; ++i) {
    if (kind.type == InterpolatorType::kOrientation) {
      rotation(world.text, random);
    } else if (kind.type == InterpolatorType::kColor) {
      color(world.text, random, base, shades);
    } else {
      for (std::uint32_t k = 0; k < kind.floats; ++k) number(world.text, random.real(-10, 10));
    }
  }
  world.text += "] }\n";
  return world;
}

std::vector<float> fractions_for(std::span<const float> key, Random& random) {
  std::vector<float> fractions = {-1e6F, 1e6F, 0, 1};
  for (const float k : key) {
    fractions.insert(fractions.end(), {k, std::nextafter(k, -1e9F), std::nextafter(k, 1e9F)});
  }
  while (fractions.size() < 300) fractions.push_back(static_cast<float>(random.real(-0.7, 1.7)));
  return fractions;
}

// Whether one of two ways is the shorter in binary32 too.
bool decided(const animation::Keys& keys) {
  for (std::size_t i = 1; i < keys.key.size(); ++i) {
    const Quat a = animation::orientation_at(keys, i - 1), b = animation::orientation_at(keys, i);
    if (std::abs(a.dot(b)) < 1e-5) return false;
  }
  return true;
}

// The weight takes 3 u (two differences, a quotient). Then of the largest value: the difference of two values, twice as
// large, 2 u, by the weight 2 (3 + 1) u, the sum 1 u and, of coordinates, our own 1 u: 12 u. A rotation's quaternion:
// 4 u from axis and angle, by weights whose sum is <= sqrt 2: 6 u; half a way of <= pi / 2 by the weight: 5 u; weights
// and sums: 8 u; twice as large as an angle: 38 u.
void compare_interpolator(const InterpolatorKind& kind, std::uint32_t seed, Report& report) {
  const bool is_color = kind.type == InterpolatorType::kColor,
             shades = std::string_view(kind.figure).ends_with("shades");
  const World world = make_interpolator(kind, seed, shades);
  const ReadResult ours = read_world(world.text);
  if (!ours.scene) return report.wrong(world.name + " cannot be read");
  const vrml::Node& node = ours.scene->document->nodes.at(0);
  const animation::Keys keys = {vrml::value_of(node, "key").as<float>(), vrml::value_of(node, "keyValue").as<float>()};
  if (kind.type == InterpolatorType::kOrientation && !decided(keys)) {
    return report.leave_out("interpolator.opposite", "rad", "6.32: undefined for opposite orientations", 0, 0,
                            world.name);
  }
  Random random(seed);
  const std::vector<float> fractions = fractions_for(keys.key, random);
  const auto coins = values_of_coin(world.text, fractions);
  if (!coins) return report.wrong(world.name + " cannot be answered by Coin");
  double largest = 0;
  for (const float x : keys.key_value) largest = std::max(largest, std::abs(double{x}));
  const double bound = (kind.type == InterpolatorType::kOrientation ? 38 : 12 * largest) * kU;
  animation::Value value;
  for (std::size_t i = 0; i < fractions.size(); ++i) {
    animation::evaluate(kind.type, keys, double{fractions[i]}, value);
    const std::vector<double>& coin = (*coins)[i];
    double difference = 0;
    if (coin.size() != kind.floats) {
      difference = kInfinity;
    } else if (kind.type == InterpolatorType::kOrientation) {
      difference = angle_between(value.quat(), Quat(coin[3], coin[0], coin[1], coin[2]).normalized());
    } else {
      for (std::size_t k = 0; k < coin.size(); ++k) {
        const double x = kind.floats > 4 ? double{value.numbers.at(k)} : value.number[k];
        difference = std::max(difference, std::abs(x - coin[k]));
      }
    }
    // 4.6.8: f(t) = v_0 where t <= t_0, so also if t_1 = t_0.
    if (keys.key.size() > 1 && fractions[i] == keys.key[0] && keys.key[1] == keys.key[0]) {
      report.leave_out("interpolator.repeated_first_key", "",
                       "4.6.8: v_0 for t <= t_0; Coin takes the last of equal keys", difference, bound, world.name);
      continue;
    }
    // 6.10: "A linear interpolation using the value of set_fraction as input is performed in HSV space." Coin's is in
    // RGB, so only at the keys and outside of them it must be the same.
    if (is_color && !shades && animation::find_key_interval(keys.key, double{fractions[i]}).weight > 0) {
      report.leave_out(kind.figure, kind.unit, "6.10: colours are interpolated in HSV; Coin does it in RGB", difference,
                       bound, world.name);
    } else {
      report.compare(is_color && !shades ? "interpolator.color_at_keys" : kind.figure, kind.unit, difference, bound,
                     world.name);
    }
  }
}

int run(const Options& options) {
  start_coin();
  Report report;
  compare_transforms(options.quick, report);
  compare_grids(options.quick, report);
  compare_extrusions(options.quick, report);
  compare_solids(options.quick, report);
  for (const InterpolatorKind& kind : kInterpolators) {
    for (std::uint32_t seed = 1; seed <= (options.quick ? 5u : 60u); ++seed) compare_interpolator(kind, seed, report);
  }
  const bool good = report.print();
  if (!write_figures(options, report.figures())) return 3;
  if (!good) std::fprintf(stderr, "error: not as Coin has it; see above\n");
  return good ? 0 : 1;
}

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) { return peerd::bench::run_main(argc, argv, peerd::bench::run); }
