#include <fcl/fcl.h>

#include <vector>

#include "bench/peers/engine.hpp"

namespace peerd::bench::peers {
namespace {

// No query is to stop for having found too many.
constexpr std::size_t kAllContacts = std::size_t{1} << 30;

template <class Volume>
class FclEngine : public Engine {
 public:
  using Scalar = typename Volume::S;
  using Model = fcl::BVHModel<Volume>;
  using Transform = fcl::Transform3<Scalar>;
  using Vector = fcl::Vector3<Scalar>;

  void build(const TriangleMesh& mesh) override {
    std::vector<Vector> vertices;
    std::vector<fcl::Triangle> triangles;
    for (const Point& p : mesh.vertices) vertices.push_back(vector(p));
    for (const auto& t : mesh.triangles) {
      const auto corner = [&](std::size_t k) { return static_cast<std::size_t>(t[k]); };
      triangles.emplace_back(corner(0), corner(1), corner(2));
    }
    model_ = std::make_shared<Model>();
    model_->beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size()));
    model_->addSubModel(vertices, triangles);
    model_->endModel();
  }
  void make_bodies(std::size_t count) override { bodies_.resize(count, Transform::Identity()); }
  void move(std::span<const Placement> bodies) override {
    for (std::size_t i = 0; i < bodies.size(); ++i) bodies_[i] = transform(bodies[i]);
  }
  bool first(std::size_t a, std::size_t b) override { return contacts(a, b, 1) > 0; }
  std::size_t all(std::size_t a, std::size_t b) override { return contacts(a, b, kAllContacts); }

 protected:
  static Vector vector(const Point& p) {
    return {static_cast<Scalar>(p.x), static_cast<Scalar>(p.y), static_cast<Scalar>(p.z)};
  }
  static Transform transform(const Placement& placement) {
    Transform out = Transform::Identity();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        out.linear()(row, column) = static_cast<Scalar>(placement.rotation[row][column]);
      }
    }
    out.translation() = vector(placement.position);
    return out;
  }
  [[nodiscard]] const Model& model() const { return *model_; }

 private:
  std::size_t contacts(std::size_t a, std::size_t b, std::size_t most) const {
    const fcl::CollisionRequest<Scalar> request(most, /*enable_contact_=*/false);
    fcl::CollisionResult<Scalar> result;
    fcl::collide(model_.get(), bodies_[a], model_.get(), bodies_[b], request, result);
    return result.numContacts();
  }

  std::shared_ptr<Model> model_;
  std::vector<Transform, Eigen::aligned_allocator<Transform>> bodies_;
};

// FCL's fcl::collide() takes hierarchies of k-DOPs to the world anew with every query: copied and refitted, twice. Here
// every body has one of its own that is refitted once a frame.
template <class Volume>
class FclRefitEngine final : public FclEngine<Volume> {
  using Base = FclEngine<Volume>;
  using typename Base::Model;
  using typename Base::Scalar;
  using typename Base::Transform;
  using typename Base::Vector;

 public:
  void make_bodies(std::size_t count) override {
    for (std::size_t i = 0; i < count; ++i) bodies_.push_back(std::make_unique<Model>(this->model()));
  }
  void move(std::span<const Placement> bodies) override {
    vertices_.resize(static_cast<std::size_t>(this->model().num_vertices));
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const Transform world = Base::transform(bodies[i]);
      for (std::size_t v = 0; v < vertices_.size(); ++v) vertices_[v] = world * this->model().vertices[v];
      bodies_[i]->beginReplaceModel();
      bodies_[i]->replaceSubModel(vertices_);
      bodies_[i]->endReplaceModel(/*refit=*/true, /*bottomup=*/true);
    }
  }
  bool first(std::size_t a, std::size_t b) override { return contacts(a, b, 1) > 0; }
  std::size_t all(std::size_t a, std::size_t b) override { return contacts(a, b, kAllContacts); }

 private:
  std::size_t contacts(std::size_t a, std::size_t b, std::size_t most) {
    const fcl::CollisionRequest<Scalar> request(most, /*enable_contact_=*/false);
    fcl::CollisionResult<Scalar> result;
    fcl::detail::MeshCollisionTraversalNode<Volume> traversal;
    Transform here = Transform::Identity(), there = Transform::Identity();
    fcl::detail::initialize(traversal, *bodies_[a], here, *bodies_[b], there, request, result);
    fcl::detail::collide(&traversal);
    return result.numContacts();
  }

  std::vector<std::unique_ptr<Model>> bodies_;
  std::vector<Vector> vertices_;
};

template <class E>
std::unique_ptr<Engine> make() {
  return std::make_unique<E>();
}

}  // namespace

EngineKind fcl_obb() { return {"fcl-OBB", Pairs::kAll, make<FclEngine<fcl::OBBd>>}; }
EngineKind fcl_obbrss() { return {"fcl-OBBRSS", Pairs::kAll, make<FclEngine<fcl::OBBRSSd>>}; }
EngineKind fcl_obb_float() { return {"fcl-OBB-float", Pairs::kAll, make<FclEngine<fcl::OBB<float>>>}; }
EngineKind fcl_kdop18_float_refit() {
  return {"fcl-KDOP18-float-refit", Pairs::kAll, make<FclRefitEngine<fcl::KDOP<float, 18>>>};
}

}  // namespace peerd::bench::peers
