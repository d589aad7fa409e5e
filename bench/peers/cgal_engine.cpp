#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Rigid_triangle_mesh_collision_detection.h>
#include <CGAL/Surface_mesh.h>

#include <array>
#include <vector>

#include "bench/peers/engine.hpp"

namespace peerd::bench::peers {
namespace {

// Says whether surfaces touch; no pairs.
class CgalEngine final : public Engine {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

 public:
  void build(const TriangleMesh& mesh) override {
    std::vector<Mesh::Vertex_index> vertices;
    for (const Point& p : mesh.vertices) vertices.push_back(mesh_.add_vertex({p.x, p.y, p.z}));
    for (const auto& t : mesh.triangles) {
      const auto corner = [&](std::size_t k) { return vertices[static_cast<std::size_t>(t[k])]; };
      mesh_.add_face(corner(0), corner(1), corner(2));
    }
    add_body();
    std::array<std::size_t, 1> itself = {0};  // its tree is made for the first query
    static_cast<void>(bodies_.get_all_intersections(0, itself));
  }
  void make_bodies(std::size_t count) override {
    for (std::size_t i = 1; i < count; ++i) add_body();
  }
  void move(std::span<const Placement> bodies) override {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const auto& r = bodies[i].rotation;
      const Point& t = bodies[i].position;
      bodies_.set_transformation(i, CGAL::Aff_transformation_3<Kernel>(r[0][0], r[0][1], r[0][2], t.x, r[1][0], r[1][1],
                                                                       r[1][2], t.y, r[2][0], r[2][1], r[2][2], t.z));
    }
  }
  bool first(std::size_t a, std::size_t b) override {
    std::array<std::size_t, 1> other = {b};
    return !bodies_.get_all_intersections(a, other).empty();
  }
  std::size_t all(std::size_t, std::size_t) override { return 0; }

 private:
  // One hierarchy for all of it, also where it has many parts, as each branch of a tree is one.
  void add_body() { bodies_.add_mesh(mesh_, CGAL::parameters::apply_per_connected_component(false)); }

  Mesh mesh_;
  CGAL::Rigid_triangle_mesh_collision_detection<Mesh> bodies_;
};

}  // namespace

EngineKind cgal_rigid() {
  return {"cgal-rigid", Pairs::kNone, []() -> std::unique_ptr<Engine> { return std::make_unique<CgalEngine>(); }};
}

}  // namespace peerd::bench::peers
