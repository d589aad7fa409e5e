#include "bench/peers/meshes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "bench/polygon_file.hpp"

namespace peerd::bench::peers {
namespace {

constexpr double kPi = std::numbers::pi;

// Two triangles over the corners a b c d of a cell.
void add_cell(TriangleMesh& mesh, int a, int b, int c, int d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

Point trefoil(double u) {
  const double r = 2 + std::cos(3 * u);
  return {r * std::cos(2 * u), r * std::sin(2 * u), -std::sin(3 * u)};
}

TriangleMesh knot(int triangles) {
  const int around = std::max(8, static_cast<int>(std::lround(std::sqrt(triangles / 2.0 / 12))));
  const int along = triangles / 2 / around;
  TriangleMesh mesh;
  for (int i = 0; i < along; ++i) {
    const double u = 2 * kPi * i / along, step = 1e-4;
    const Point center = trefoil(u);
    const Point tangent = unit(trefoil(u + step) - trefoil(u - step));
    const Point binormal = unit(cross(tangent, center + Point{0.01, 0.02, 3}));
    const Point normal = cross(binormal, tangent);
    for (int j = 0; j < around; ++j) {
      const double w = 2 * kPi * j / around;
      const double r = 0.35 + 0.05 * std::sin(40 * u) * std::cos(3 * w);
      mesh.vertices.push_back(center + (r * std::cos(w)) * normal + (r * std::sin(w)) * binormal);
    }
  }
  for (int i = 0; i < along; ++i) {
    const int ring = i * around, next = (i + 1) % along * around;
    for (int j = 0; j < around; ++j) {
      const int k = (j + 1) % around;
      add_cell(mesh, ring + j, next + j, next + k, ring + k);
    }
  }
  return mesh;
}

// theta from the pole, phi around.
Point bumpy(double theta, double phi) {
  const double s = std::sin(theta);
  const double r = 1 + 0.18 * std::sin(7 * theta) * std::cos(9 * phi) * s + 0.10 * std::sin(23 * phi + 5 * theta) * s;
  return {r * s * std::cos(phi), r * s * std::sin(phi), r * std::cos(theta)};
}

TriangleMesh sphere(int triangles) {
  const int rows = static_cast<int>(std::lround(std::sqrt(triangles / 4.0))), columns = 2 * rows;
  TriangleMesh mesh;
  mesh.vertices.push_back(bumpy(0, 0));
  for (int i = 1; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) mesh.vertices.push_back(bumpy(kPi * i / rows, 2 * kPi * j / columns));
  }
  const int last = static_cast<int>(mesh.vertices.size());
  mesh.vertices.push_back(bumpy(kPi, 0));
  const auto at = [&](int row, int column) { return 1 + (row - 1) * columns + column % columns; };
  for (int j = 0; j < columns; ++j) {
    mesh.triangles.push_back({0, at(1, j), at(1, j + 1)});
    mesh.triangles.push_back({last, at(rows - 1, j + 1), at(rows - 1, j)});
    for (int i = 1; i + 1 < rows; ++i) add_cell(mesh, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
  }
  return mesh;
}

// Branches are grown in the order in which they sprouted, until no whole one fits.
TriangleMesh tree(int triangles, unsigned seed) {
  std::mt19937 generator(seed);
  const auto random = [&] { return generator() / 4294967296.0; };
  constexpr int kAround = 8, kRings = 5, kSprouts = 5, kPerBranch = 2 * kAround * kRings;
  struct Branch {
    Point begin, direction;
    double length, radius;
  };
  std::vector<Branch> branches = {{{0, 0, -1}, {0, 0, 1}, 1.0, 0.08}};
  TriangleMesh mesh;
  for (std::size_t i = 0; i < branches.size(); ++i) {
    if (static_cast<int>(mesh.triangles.size()) + kPerBranch > triangles) break;
    const Branch branch = branches[i];
    const Point& d = branch.direction;
    const Point n = unit(cross(d, std::fabs(d.x) < 0.8 ? Point{1, 0, 0} : Point{0, 1, 0})), o = cross(d, n);
    const Point bend = 0.25 * Point{random() - .5, random() - .5, random() - .5};
    const auto axis = [&](double s) { return branch.begin + (s * branch.length) * d + (s * s * branch.length) * bend; };
    const int first = static_cast<int>(mesh.vertices.size());
    for (int ring = 0; ring <= kRings; ++ring) {
      const double s = static_cast<double>(ring) / kRings, r = branch.radius * (1 - 0.7 * s);
      for (int j = 0; j < kAround; ++j) {
        const double w = 2 * kPi * (j + 0.5 * ring) / kAround;
        mesh.vertices.push_back(axis(s) + (r * std::cos(w)) * n + (r * std::sin(w)) * o);
      }
    }
    for (int ring = 0; ring < kRings; ++ring) {
      for (int j = 0; j < kAround; ++j) {
        const int a = first + ring * kAround + j, b = first + ring * kAround + (j + 1) % kAround;
        mesh.triangles.push_back({a, b, a + kAround});
        mesh.triangles.push_back({b, b + kAround, a + kAround});
      }
    }
    for (int sprout = 0; sprout < kSprouts; ++sprout) {
      const double s = 0.3 + 0.7 * random();
      const double away = 0.5 + 0.7 * random();
      const double w = 2 * kPi * random();
      const Point direction = unit(std::cos(away) * d + std::sin(away) * (std::cos(w) * n + std::sin(w) * o));
      branches.push_back({axis(s), direction, branch.length * (0.45 + 0.25 * random()),
                          std::max(0.004, branch.radius * (0.4 + 0.2 * random()))});
    }
  }
  return mesh;
}

std::expected<TriangleMesh, std::string> read_mesh(const std::string& path) {
  const auto file = read_polygon_file(path);
  if (!file) return std::unexpected(file.error());
  TriangleMesh mesh;
  for (const auto& p : file->vertices) mesh.vertices.push_back({p[0], p[1], p[2]});
  for (const auto& corners : file->polygons) {
    for (std::size_t i = 2; i < corners.size(); ++i) mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
  }
  if (mesh.triangles.empty()) return std::unexpected(path + " has no triangles");
  return mesh;
}

double to_binary32(double x) {
  // volatile: GCC 12's vectorizer takes neighbours' way to binary32 and back for nothing, and leaves both out.
  volatile float rounded = static_cast<float>(x);
  return static_cast<double>(rounded);
}

void normalize(TriangleMesh& mesh) {
  Point lo{1e30, 1e30, 1e30}, hi{-1e30, -1e30, -1e30};
  for (const Point& p : mesh.vertices) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  }
  const Point center = 0.5 * (lo + hi);
  double radius = 0;
  for (const Point& p : mesh.vertices) radius = std::max(radius, length(p - center));
  for (Point& p : mesh.vertices) {
    const Point q = (1 / radius) * (p - center);
    p = {to_binary32(q.x), to_binary32(q.y), to_binary32(q.z)};
    mesh.radius = std::max(mesh.radius, length(p));
  }
}

}  // namespace

std::expected<TriangleMesh, std::string> make_triangle_mesh(const std::string& what, int triangles, unsigned seed) {
  std::expected<TriangleMesh, std::string> mesh;
  if (what == "knot") {
    mesh = knot(triangles);
  } else if (what == "sphere") {
    mesh = sphere(triangles);
  } else if (what == "tree") {
    mesh = tree(triangles, seed);
  } else {
    mesh = read_mesh(what);
  }
  if (mesh) normalize(*mesh);
  return mesh;
}

}  // namespace peerd::bench::peers
