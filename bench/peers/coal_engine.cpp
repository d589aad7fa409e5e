// The adapter alone: Coal is found where a user has installed it.
#include <coal/BVH/BVH_model.h>
#include <coal/collision.h>

#include <memory>
#include <vector>

#include "bench/peers/engine.hpp"

namespace peerd::bench::peers {
namespace {

// No query is to stop for having found too many.
constexpr std::size_t kAllContacts = std::size_t{1} << 30;

template <class Volume>
class CoalEngine final : public Engine {
 public:
  void build(const TriangleMesh& mesh) override {
    std::vector<coal::Vec3s> vertices;
    std::vector<coal::Triangle> triangles;
    for (const Point& p : mesh.vertices) vertices.emplace_back(p.x, p.y, p.z);
    for (const auto& t : mesh.triangles) {
      const auto corner = [&](std::size_t k) { return static_cast<std::size_t>(t[k]); };
      triangles.emplace_back(corner(0), corner(1), corner(2));
    }
    model_ = std::make_unique<coal::BVHModel<Volume>>();
    model_->beginModel(static_cast<unsigned>(triangles.size()), static_cast<unsigned>(vertices.size()));
    model_->addSubModel(vertices, triangles);
    model_->endModel();
  }
  void make_bodies(std::size_t count) override { bodies_.resize(count); }
  void move(std::span<const Placement> bodies) override {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      coal::Matrix3s rotation;
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) rotation(row, column) = bodies[i].rotation[row][column];
      }
      const Point& p = bodies[i].position;
      bodies_[i].setTransform(rotation, coal::Vec3s(p.x, p.y, p.z));
    }
  }
  bool first(std::size_t a, std::size_t b) override { return contacts(a, b, 1) > 0; }
  std::size_t all(std::size_t a, std::size_t b) override { return contacts(a, b, kAllContacts); }

 private:
  std::size_t contacts(std::size_t a, std::size_t b, std::size_t most) const {
    const coal::CollisionRequest request(coal::NO_REQUEST, most);
    coal::CollisionResult result;
    coal::collide(model_.get(), bodies_[a], model_.get(), bodies_[b], request, result);
    return result.numContacts();
  }

  std::unique_ptr<coal::BVHModel<Volume>> model_;
  std::vector<coal::Transform3s> bodies_;
};

template <class Volume>
std::unique_ptr<Engine> make() {
  return std::make_unique<CoalEngine<Volume>>();
}

}  // namespace

EngineKind coal_obb() { return {"coal-OBB", Pairs::kAll, make<coal::OBB>}; }
EngineKind coal_obbrss() { return {"coal-OBBRSS", Pairs::kAll, make<coal::OBBRSS>}; }

}  // namespace peerd::bench::peers
