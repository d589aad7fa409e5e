#include "core/geometry/tessellate.hpp"

#include <algorithm>
#include <cassert>
#include <numbers>
#include <utility>

#include "core/geometry/elevation_grid.hpp"
#include "core/geometry/extrusion.hpp"
#include "core/geometry/polygon_writer.hpp"
#include "core/geometry/triangulation.hpp"
#include "core/sin_cos.hpp"

namespace peerd {
namespace {

// Sine and cosine of k/n of a full turn. Only angles up to 1/8 turn are computed, so that every circle is its own
// mirror image and meets the axes, to the last bit.
SinCos sin_cos_of_fraction(std::uint64_t k, std::uint64_t n) {
  const std::uint64_t quarter = 4 * k / n, rest = 4 * k % n;  // rest/n of a quarter
  const auto angle = [&](std::uint64_t r) {
    return std::numbers::pi / 2.0 * (static_cast<double>(r) / static_cast<double>(n));
  };
  SinCos at = sin_cos(angle(std::min(rest, n - rest)));
  if (rest > n - rest) std::swap(at.sin, at.cos);
  switch (quarter % 4) {
    case 1:
      return {at.cos, -at.sin};
    case 2:
      return {-at.sin, -at.cos};
    case 3:
      return {-at.cos, at.sin};
    default:
      return at;
  }
}

// The standard wraps textures counter-clockwise, seen from above, from where the back (x = 0, z < 0) is: so do we.
using Circle = std::vector<SinCos>;

Circle make_circle(const Tessellation& tessellation) {
  Circle circle;
  for (std::uint64_t k = 0; k < tessellation.slices; ++k) circle.push_back(sin_cos_of_fraction(k, tessellation.slices));
  return circle;
}

// Returns its first vertex.
std::uint64_t add_ring(PolygonWriter& out, const Circle& circle, double radius, double y) {
  const std::uint64_t first = out.vertex_count();
  for (const SinCos& at : circle) out.vertex(-(radius * at.sin), y, -(radius * at.cos));
  return first;
}

// Around the axis, lower edge first.
void add_band(PolygonWriter& out, std::uint64_t lower, std::uint64_t upper, std::uint64_t slices) {
  for (std::uint64_t k = 0; k < slices; ++k) {
    const std::uint64_t next = (k + 1) % slices;
    out.polygon({lower + k, lower + next, upper + next, upper + k});
  }
}
void add_fan_to_top(PolygonWriter& out, std::uint64_t ring, std::uint64_t top, std::uint64_t slices) {
  for (std::uint64_t k = 0; k < slices; ++k) out.polygon({ring + k, ring + (k + 1) % slices, top});
}
void add_fan_to_bottom(PolygonWriter& out, std::uint64_t bottom, std::uint64_t ring, std::uint64_t slices) {
  for (std::uint64_t k = 0; k < slices; ++k) out.polygon({bottom, ring + (k + 1) % slices, ring + k});
}

struct Sizes {
  const Tessellation& tessellation;
  [[nodiscard]] std::uint64_t slices() const { return tessellation.slices; }
  [[nodiscard]] std::uint64_t stacks() const { return tessellation.stacks; }

  MeshSize operator()(const BoxGeometry&) const { return {6, 12}; }
  MeshSize operator()(const SphereGeometry&) const { return {slices() * stacks(), slices() * (2 * stacks() - 2)}; }
  MeshSize operator()(const ConeGeometry& cone) const {
    return {(cone.side ? slices() : 0) + (cone.bottom ? 1 : 0),
            (cone.side ? slices() : 0) + (cone.bottom ? slices() - 2 : 0)};
  }
  MeshSize operator()(const CylinderGeometry& cylinder) const {
    const std::uint64_t caps = (cylinder.top ? 1 : 0) + (cylinder.bottom ? 1 : 0);
    return {(cylinder.side ? slices() : 0) + caps, (cylinder.side ? 2 * slices() : 0) + caps * (slices() - 2)};
  }
  MeshSize operator()(const ElevationGridGeometry& grid) const { return elevation_grid_size(grid); }
  MeshSize operator()(const ExtrusionGeometry& extrusion) const { return extrusion_size(extrusion); }
  MeshSize operator()(const FaceSetGeometry& faces) const {
    MeshSize size;
    std::uint64_t corners = 0;
    const auto close = [&] {
      if (corners == 0) return;
      ++size.polygons;
      size.triangles += triangle_count(corners);
      corners = 0;
    };
    for (const std::int32_t corner : faces.corners) {
      if (corner == Mesh::kEndOfPolygon) {
        close();
      } else {
        ++corners;
      }
    }
    close();
    return size;
  }
  MeshSize operator()(const NoSurface&) const { return {}; }
};

struct Builder {
  const Tessellation& tessellation;
  template <class T>
  [[nodiscard]] MeshSize size(const T& geometry) const {
    return Sizes{tessellation}(geometry);
  }

  // 6.6: centred, sides along the axes.
  Mesh operator()(const BoxGeometry& box) const {
    PolygonWriter out(8, size(box));
    for (int corner = 0; corner < 8; ++corner) {  // bits 0, 1, 2: the positive side of x, y, z
      const auto half = [&](std::size_t k) { return ((corner >> k & 1) != 0 ? 0.5 : -0.5) * box.size[k]; };
      out.vertex(half(0), half(1), half(2));
    }
    out.polygon({0, 4, 6, 2});  // -x
    out.polygon({1, 3, 7, 5});  // +x
    out.polygon({0, 1, 5, 4});  // -y
    out.polygon({2, 6, 7, 3});  // +y
    out.polygon({0, 2, 3, 1});  // -z
    out.polygon({4, 5, 7, 6});  // +z
    return std::move(out).finish();
  }

  // 6.42: from the pole at +y stack by stack; the vertices are on the sphere.
  Mesh operator()(const SphereGeometry& sphere) const {
    const Circle circle = make_circle(tessellation);
    const std::uint64_t slices = circle.size(), stacks = tessellation.stacks;
    const double radius = sphere.radius;
    PolygonWriter out(slices * (stacks - 1) + 2, size(sphere));
    out.vertex(0, radius, 0);
    for (std::uint64_t j = 1; j < stacks; ++j) {
      const SinCos polar = sin_cos_of_fraction(j, 2 * stacks);
      add_ring(out, circle, radius * polar.sin, radius * polar.cos);
    }
    const std::uint64_t bottom = out.vertex_count();
    out.vertex(0, -radius, 0);
    const auto ring = [&](std::uint64_t j) { return 1 + (j - 1) * slices; };
    add_fan_to_top(out, ring(1), 0, slices);
    for (std::uint64_t j = 1; j + 1 < stacks; ++j) add_band(out, ring(j + 1), ring(j), slices);
    add_fan_to_bottom(out, bottom, ring(stacks - 1), slices);
    return std::move(out).finish();
  }

  // 6.10: the apex at y = height/2, the bottom at -height/2. Polygons: side, bottom.
  Mesh operator()(const ConeGeometry& cone) const {
    const Circle circle = make_circle(tessellation);
    if (!cone.side && !cone.bottom) return {};
    const double half = 0.5 * cone.height;
    PolygonWriter out(circle.size() + 1, size(cone));
    const std::uint64_t ring = add_ring(out, circle, cone.bottom_radius, -half);
    if (cone.side) {
      const std::uint64_t apex = out.vertex_count();
      out.vertex(0, half, 0);
      add_fan_to_top(out, ring, apex, circle.size());
    }
    if (cone.bottom) out.ring(ring, circle.size(), /*reversed=*/true);
    return std::move(out).finish();
  }

  // 6.14: from y = -height/2 to height/2. Polygons: side, top, bottom. No ring is there without a polygon on it.
  Mesh operator()(const CylinderGeometry& cylinder) const {
    const Circle circle = make_circle(tessellation);
    const double half = 0.5 * cylinder.height;
    const bool at_bottom = cylinder.side || cylinder.bottom, at_top = cylinder.side || cylinder.top;
    PolygonWriter out(2 * circle.size(), size(cylinder));
    const std::uint64_t lower = at_bottom ? add_ring(out, circle, cylinder.radius, -half) : 0;
    const std::uint64_t upper = at_top ? add_ring(out, circle, cylinder.radius, half) : 0;
    if (cylinder.side) add_band(out, lower, upper, circle.size());
    if (cylinder.top) out.ring(upper, circle.size(), /*reversed=*/false);
    if (cylinder.bottom) out.ring(lower, circle.size(), /*reversed=*/true);
    return std::move(out).finish();
  }

  Mesh operator()(const ElevationGridGeometry& grid) const { return build_elevation_grid(grid); }
  Mesh operator()(const ExtrusionGeometry& extrusion) const { return build_extrusion(extrusion); }
  Mesh operator()(const FaceSetGeometry& faces) const { return make_mesh(faces.points, faces.corners, faces.ccw); }
  Mesh operator()(const NoSurface&) const { return {}; }
};

}  // namespace

Mesh build_mesh(const Geometry& geometry, const Tessellation& tessellation) {
  assert(tessellation.slices >= 3 && tessellation.stacks >= 2);
  return std::visit(Builder{tessellation}, geometry);
}

MeshSize mesh_size(const Geometry& geometry, const Tessellation& tessellation) {
  assert(tessellation.slices >= 3 && tessellation.stacks >= 2);
  return std::visit(Sizes{tessellation}, geometry);
}

}  // namespace peerd
