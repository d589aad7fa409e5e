// The adapter alone: PQP is found where a user has installed it (its own license allows research). It takes its number
// type and its boxes from the PQP_Compile.h that it was built with.
#include <PQP.h>

#include <memory>
#include <vector>

#include "bench/peers/engine.hpp"

namespace peerd::bench::peers {
namespace {

class PqpEngine final : public Engine {
 public:
  void build(const TriangleMesh& mesh) override {
    model_ = std::make_unique<PQP_Model>();
    model_->BeginModel(static_cast<int>(mesh.triangles.size()));
    int number = 0;
    for (const auto& t : mesh.triangles) {
      PQP_REAL corners[3][3];
      for (std::size_t c = 0; c < 3; ++c) put(mesh.vertices[static_cast<std::size_t>(t[c])], corners[c]);
      model_->AddTri(corners[0], corners[1], corners[2], number++);
    }
    model_->EndModel();
  }
  void make_bodies(std::size_t count) override { bodies_.resize(count); }
  void move(std::span<const Placement> bodies) override {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
          bodies_[i].rotation[row][column] = static_cast<PQP_REAL>(bodies[i].rotation[row][column]);
        }
      }
      put(bodies[i].position, bodies_[i].position);
    }
  }
  bool first(std::size_t a, std::size_t b) override { return pairs(a, b, PQP_FIRST_CONTACT) > 0; }
  std::size_t all(std::size_t a, std::size_t b) override { return pairs(a, b, PQP_ALL_CONTACTS); }

 private:
  struct Body {
    PQP_REAL rotation[3][3], position[3];
  };
  static void put(const Point& p, PQP_REAL* out) {
    out[0] = static_cast<PQP_REAL>(p.x);
    out[1] = static_cast<PQP_REAL>(p.y);
    out[2] = static_cast<PQP_REAL>(p.z);
  }
  std::size_t pairs(std::size_t a, std::size_t b, int which) {
    PQP_Collide(&result_, bodies_[a].rotation, bodies_[a].position, model_.get(), bodies_[b].rotation,
                bodies_[b].position, model_.get(), which);
    return static_cast<std::size_t>(result_.NumPairs());
  }

  std::unique_ptr<PQP_Model> model_;
  std::vector<Body> bodies_;
  PQP_CollideResult result_;
};

}  // namespace

EngineKind pqp() {
  return {"pqp", Pairs::kAll, []() -> std::unique_ptr<Engine> { return std::make_unique<PqpEngine>(); }};
}

}  // namespace peerd::bench::peers
