#pragma once
#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "collision/contact/contact_time.hpp"

// Scenes and bodies built by hand, and the random convex polyhedra of the property tests.
namespace peerd::collision::test {

using Faces = std::vector<std::vector<std::uint32_t>>;

inline Mesh make_mesh(const std::vector<Eigen::Vector3f>& vertices, const Faces& faces, bool ccw = true) {
  std::vector<std::int32_t> corners;
  for (const auto& face : faces) {
    corners.insert(corners.end(), face.begin(), face.end());
    corners.push_back(Mesh::kEndOfPolygon);
  }
  return peerd::make_mesh(vertices, std::move(corners), ccw);
}

inline std::vector<Eigen::Vector3f> box_vertices(float x, float y, float z) {
  std::vector<Eigen::Vector3f> v;
  for (int i = 0; i < 8; ++i) {
    v.emplace_back((i & 1 ? 0.5F : -0.5F) * x, (i & 2 ? 0.5F : -0.5F) * y, (i & 4 ? 0.5F : -0.5F) * z);
  }
  return v;
}

// Polygons: 0 -x, 1 +x, 2 -y, 3 +y, 4 -z, 5 +z.
inline const Faces kBoxFaces = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};

inline Mesh box_mesh(float x, float y, float z) { return make_mesh(box_vertices(x, y, z), kBoxFaces); }

// A polygon in the plane x = 0, facing +x.
inline Mesh wall_mesh(float y, float z) {
  return make_mesh({{0, -y / 2, -z / 2}, {0, y / 2, -z / 2}, {0, y / 2, z / 2}, {0, -y / 2, z / 2}}, {{0, 1, 2, 3}});
}

// A polygon in the plane y = 0, facing +y.
inline Mesh floor_mesh(float x, float z) {
  return make_mesh({{-x / 2, 0, -z / 2}, {-x / 2, 0, z / 2}, {x / 2, 0, z / 2}, {x / 2, 0, -z / 2}}, {{0, 1, 2, 3}});
}

// A Transform OBJECT with a Shape for each mesh below it.
inline Scene scene_of(const std::vector<Mesh>& meshes, const TransformFields& transform = {}) {
  Scene scene;
  Instance object;
  object.kind = NodeKind::kTransform;
  object.def = "OBJECT";
  object.transform = 0;
  scene.transforms.push_back(transform);
  object.subtree_end = static_cast<std::uint32_t>(meshes.size()) + 1;
  scene.instances.push_back(object);
  for (std::uint32_t i = 0; i < meshes.size(); ++i) {
    Instance shape;
    shape.kind = NodeKind::kShape;
    shape.parent = 0;
    shape.child_index = i;
    shape.subtree_end = i + 2;
    shape.geometry = i;
    scene.instances.push_back(shape);
    scene.geometries.emplace_back(FaceSetGeometry{meshes[i].vertices, meshes[i].corners, meshes[i].ccw});
  }
  return scene;
}

inline Body body_of(Mesh mesh) { return make_body(scene_of({std::move(mesh)}), ObjectId{0}); }
inline Body box(float x, float y, float z) { return body_of(box_mesh(x, y, z)); }

inline KinematicState moving(const Vec3& p, const Vec3& v = Vec3::Zero(), const Vec3& a = Vec3::Zero()) {
  KinematicState s;
  s.position = p;
  s.velocity = v;
  s.acceleration = a;
  return s;
}

inline Vec3 random_vector(std::mt19937_64& rng, double size) {
  std::uniform_real_distribution<double> u(-size, size);
  const double x = u(rng), y = u(rng);
  return {x, y, u(rng)};
}

inline Quat random_rotation(std::mt19937_64& rng) {
  std::normal_distribution<double> g;
  const double w = g(rng), x = g(rng), y = g(rng);
  return Quat(w, x, y, g(rng)).normalized();
}

// The hull of random points near a sphere: every triple that has all other points behind it is a face.
inline Mesh random_polyhedron(std::mt19937_64& rng, std::size_t points) {
  std::vector<Eigen::Vector3f> v;
  for (std::size_t i = 0; i < points; ++i) v.push_back(random_vector(rng, 1.0).normalized().cast<float>());
  Faces faces;
  const auto n = static_cast<std::uint32_t>(points);
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = i + 1; j < n; ++j) {
      for (std::uint32_t k = j + 1; k < n; ++k) {
        const Vec3 a = v[i].cast<double>(), b = v[j].cast<double>(), c = v[k].cast<double>();
        const Vec3 normal = (b - a).cross(c - a);
        std::size_t front = 0, behind = 0;
        for (std::uint32_t m = 0; m < n; ++m) {
          if (m == i || m == j || m == k) continue;
          (normal.dot(v[m].cast<double>() - a) > 0.0 ? front : behind) += 1;
        }
        if (front == 0) faces.push_back({i, j, k});
        if (behind == 0) faces.push_back({i, k, j});
      }
    }
  }
  return make_mesh(v, faces);
}

}  // namespace peerd::collision::test
