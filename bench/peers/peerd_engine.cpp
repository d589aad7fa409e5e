#include "bench/peers/engine.hpp"
#include "bench/peers/soup.hpp"
#include "collision/query/wide_query.hpp"

namespace peerd::bench::peers {
namespace {

using collision::RelativeMotion;
using collision::TriangleSoup;
using collision::WideQuery;
using collision::WideTree;

class PeerdEngine final : public Engine {
 public:
  explicit PeerdEngine(bool lazily) : lazily_(lazily) {}

  void build(const TriangleMesh& mesh) override {
    soup_ = soup_of(mesh);
    tree_.emplace(soup_);
    if (!lazily_) tree_->build_all();
  }
  void make_bodies(std::size_t count) override { bodies_.resize(count); }
  void move(std::span<const Placement> bodies) override {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
          bodies_[i].rotation(row, column) = bodies[i].rotation[row][column];
        }
      }
      bodies_[i].position = {bodies[i].position.x, bodies[i].position.y, bodies[i].position.z};
    }
  }
  bool first(std::size_t a, std::size_t b) override {
    relate(a, b);
    collision::PolygonPair pair{};
    return query_.find_pair(*tree_, *tree_, motion_, pair);
  }
  std::size_t all(std::size_t a, std::size_t b) override {
    relate(a, b);
    return query_.all_pairs(*tree_, *tree_, motion_).size();
  }

 private:
  struct Body {
    Mat3 rotation;
    Vec3 position;
  };
  void relate(std::size_t a, std::size_t b) {
    const Mat3 back = bodies_[a].rotation.transpose();
    motion_.rotation = multiply(back, bodies_[b].rotation);
    motion_.translation = multiply(back, Vec3(bodies_[b].position - bodies_[a].position));
  }

  bool lazily_;
  TriangleSoup soup_;
  std::optional<WideTree> tree_;
  std::vector<Body> bodies_;
  RelativeMotion motion_{Pose{}, Pose{}};
  WideQuery query_;
};

}  // namespace

EngineKind peerd_engine() {
  return {"peerd", Pairs::kAll, []() -> std::unique_ptr<Engine> { return std::make_unique<PeerdEngine>(false); }};
}

EngineKind peerd_lazily() {
  return {"peerd-lazily", Pairs::kAll, []() -> std::unique_ptr<Engine> { return std::make_unique<PeerdEngine>(true); }};
}

}  // namespace peerd::bench::peers
