#include "collision_meshes.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <random>

#include "bench/polygon_file.hpp"
#include "core/geometry/mesh.hpp"

namespace peerd::bench {
namespace {

using collision::TriangleSoup;
constexpr double kTurn = 2 * std::numbers::pi;

// Its own numbers from bits: the standard's distributions differ from one library to the next.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  double real(double low, double high) { return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 bits_;
};

struct Polygons {
  std::vector<Vec3> vertices;
  std::vector<std::int32_t> corners;
};

std::optional<TriangleSoup> centred(const Polygons& polygons) {
  WorldBox box;
  for (const Vec3& v : polygons.vertices) box.merge(v);
  if (polygons.corners.empty() || box.is_empty()) return {};
  const Vec3 center = (box.lo + box.hi) / 2;
  double radius = 0;
  for (const Vec3& v : polygons.vertices) radius = std::max(radius, (v - center).norm());
  std::vector<Eigen::Vector3f> vertices;
  for (const Vec3& v : polygons.vertices) vertices.emplace_back(((v - center) / radius).cast<float>());
  auto soup = collision::make_soup(make_mesh(std::move(vertices), std::vector(polygons.corners)));
  if (!soup || soup->faces.empty()) return {};
  return *std::move(soup);
}

// A few waves over a surface.
class Bumps {
 public:
  explicit Bumps(std::uint64_t seed) {
    Random random(seed);
    for (Wave& wave : waves_) {
      wave.way = Vec3(random.real(-9, 9), random.real(-9, 9), random.real(-9, 9));
      wave.phase = random.real(0, kTurn);
    }
  }
  [[nodiscard]] double at(const Vec3& p) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::sin(wave.way.dot(p) + wave.phase);
    return sum / std::size(waves_);
  }

 private:
  struct Wave {
    Vec3 way;
    double phase;
  };
  Wave waves_[6];
};

// Two triangles for each of the squares of a closed grid.
void append_tube(Polygons& out, std::uint32_t along, std::uint32_t around) {
  const auto vertex = [&](std::uint32_t i, std::uint32_t j) {
    return static_cast<std::int32_t>(i % along * around + j % around);
  };
  for (std::uint32_t i = 0; i < along; ++i) {
    for (std::uint32_t j = 0; j < around; ++j) {
      out.corners.insert(out.corners.end(), {vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), -1});
      out.corners.insert(out.corners.end(), {vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1), -1});
    }
  }
}

// A stump of a cone with four sides: eight triangles.
void append_stump(Polygons& out, const Vec3& from, const Vec3& to, double thick, double thin) {
  const Vec3 way = (to - from).normalized(), u = way.unitOrthogonal(), v = way.cross(u);
  const auto first = static_cast<std::int32_t>(out.vertices.size());
  for (int end = 0; end < 2; ++end) {
    for (int i = 0; i < 4; ++i) {
      const double r = end == 0 ? thick : thin, angle = kTurn * i / 4;
      out.vertices.push_back((end == 0 ? from : to) + r * (std::cos(angle) * u + std::sin(angle) * v));
    }
  }
  for (int i = 0; i < 4; ++i) {
    const std::int32_t a = first + i, b = first + (i + 1) % 4;
    out.corners.insert(out.corners.end(), {a, b, b + 4, -1, a, b + 4, a + 4, -1});
  }
}

}  // namespace

TriangleSoup bumpy_knot(std::uint32_t triangles, std::uint64_t seed) {
  const Bumps bumps(seed);
  const auto around = static_cast<std::uint32_t>(std::sqrt(triangles / 2.0 / 10.0)), along = triangles / 2 / around;
  Polygons out;
  const auto curve = [](double t) {  // of a trefoil knot on a torus
    const double r = 1 + 0.45 * std::cos(3 * t);
    return Vec3(r * std::cos(2 * t), r * std::sin(2 * t), 0.45 * std::sin(3 * t));
  };
  for (std::uint32_t i = 0; i < along; ++i) {
    const double t = kTurn * i / along;
    const Vec3 p = curve(t), way = (curve(t + 1e-4) - curve(t - 1e-4)).normalized();
    const Vec3 out_of_center = Vec3(p[0], p[1], 0).normalized();
    const Vec3 u = (out_of_center - way * way.dot(out_of_center)).normalized(), v = way.cross(u);
    for (std::uint32_t j = 0; j < around; ++j) {
      const double angle = kTurn * j / around;
      const Vec3 side = std::cos(angle) * u + std::sin(angle) * v;
      out.vertices.push_back(p + side * (0.17 + 0.06 * bumps.at(p + 0.2 * side)));
    }
  }
  append_tube(out, along, around);
  return *centred(out);
}

TriangleSoup bumpy_sphere(std::uint32_t triangles, std::uint64_t seed) {
  const Bumps bumps(seed);
  const auto rings = static_cast<std::uint32_t>(std::sqrt(triangles / 4.0)), around = triangles / 2 / rings;
  Polygons out;
  const auto add = [&](const Vec3& way) { out.vertices.push_back(way * (1 + 0.35 * bumps.at(way))); };
  for (std::uint32_t i = 1; i <= rings; ++i) {
    for (std::uint32_t j = 0; j < around; ++j) {
      const double polar = std::numbers::pi * i / (rings + 1), angle = kTurn * j / around;
      add({std::sin(polar) * std::cos(angle), std::cos(polar), std::sin(polar) * std::sin(angle)});
    }
  }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return static_cast<std::int32_t>(i * around + j % around); };
  const auto north = static_cast<std::int32_t>(out.vertices.size());
  add({0, 1, 0}), add({0, -1, 0});
  for (std::uint32_t j = 0; j < around; ++j) {
    out.corners.insert(out.corners.end(), {north, at(0, j), at(0, j + 1), -1});
    out.corners.insert(out.corners.end(), {north + 1, at(rings - 1, j + 1), at(rings - 1, j), -1});
    for (std::uint32_t i = 0; i + 1 < rings; ++i) {
      out.corners.insert(out.corners.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1), -1});
      out.corners.insert(out.corners.end(), {at(i, j), at(i + 1, j + 1), at(i, j + 1), -1});
    }
  }
  return *centred(out);
}

TriangleSoup branches(std::uint32_t triangles, std::uint64_t seed) {
  Random random(seed);
  Polygons out;
  struct Branch {
    Vec3 from, way;
    double length, thick;
  };
  std::vector<Branch> all = {{Vec3(0, -1, 0), Vec3(0, 1, 0), 0.7, 0.05}};
  for (std::size_t i = 0; i < triangles / 8; ++i) {
    const Branch b = all[i];
    const Vec3 to = b.from + b.way * b.length;
    append_stump(out, b.from, to, b.thick, 0.6 * b.thick);
    for (int child = 0; child < 3; ++child) {
      const Vec3 aside(random.real(-1, 1), random.real(-0.6, 1), random.real(-1, 1));
      const Vec3 from = b.from + b.way * b.length * random.real(0.4, 1);
      all.push_back({from, (b.way + 1.2 * aside).normalized(), b.length * random.real(0.55, 0.85), 0.62 * b.thick});
    }
  }
  return *centred(out);
}

std::optional<TriangleSoup> read_soup(const std::string& path) {
  const auto file = read_polygon_file(path);
  if (!file) return {};
  Polygons out;
  for (const auto& p : file->vertices) out.vertices.emplace_back(p[0], p[1], p[2]);
  for (const std::vector<int>& polygon : file->polygons) {
    out.corners.insert(out.corners.end(), polygon.begin(), polygon.end());
    out.corners.push_back(Mesh::kEndOfPolygon);
  }
  return centred(out);
}

std::vector<NamedSoup> soups_of_files(const std::vector<std::string>& arguments, std::size_t most) {
  std::vector<std::string> paths = arguments;
  if (const char* const corpus = std::getenv("PEERD_CORPUS"); paths.empty() && corpus != nullptr) {
    for (const char* name :
         {"al.obj", "galleon.obj", "p51_mustang.obj", "suzanne.obj", "cgal_elephant.off", "rocker-arm.obj"}) {
      paths.push_back((std::filesystem::path(corpus) / "meshes" / name).string());
    }
  }
  std::vector<NamedSoup> out;
  for (const std::string& path : paths) {
    auto soup = read_soup(path);
    const std::string name = std::filesystem::path(path).stem().string();
    if (!soup) std::fprintf(stderr, "%s: no OBJ or OFF that can be read; left out\n", path.c_str());
    if (soup && soup->faces.size() > most) std::fprintf(stderr, "%s: too large; left out\n", path.c_str());
    if (soup && soup->faces.size() <= most) out.push_back({name, *std::move(soup)});
  }
  return out;
}

}  // namespace peerd::bench
