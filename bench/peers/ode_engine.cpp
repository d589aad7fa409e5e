#include <ode/ode.h>

#include <algorithm>
#include <cstdarg>
#include <utility>
#include <vector>

#include "bench/peers/engine.hpp"

namespace peerd::bench::peers {
namespace {

constexpr int kMostContacts = 65535;  // of its interface

// It collides everything before it asks whether the first was enough, and makes one of contacts that are close.
class OdeEngine final : public Engine {
 public:
  OdeEngine() : contacts_(kMostContacts) {
    static const bool started = [] {
      dInitODE2(0);
      dSetMessageHandler([](int, const char*, std::va_list) {});  // about degenerate triangles
      return dAllocateODEDataForThread(dAllocateMaskAll) != 0;
    }();
    static_cast<void>(started);
  }
  ~OdeEngine() override {
    for (const dGeomID body : bodies_) dGeomDestroy(body);
    if (mesh_ != nullptr) dGeomTriMeshDataDestroy(mesh_);
  }
  OdeEngine(const OdeEngine&) = delete;
  OdeEngine& operator=(const OdeEngine&) = delete;

  void build(const TriangleMesh& mesh) override {
    for (const Point& p : mesh.vertices) vertices_.insert(vertices_.end(), {p.x, p.y, p.z});
    for (const auto& t : mesh.triangles) {
      for (const int corner : t) corners_.push_back(static_cast<dTriIndex>(corner));
    }
    mesh_ = dGeomTriMeshDataCreate();
    dGeomTriMeshDataBuildDouble(mesh_, vertices_.data(), 3 * sizeof(double), static_cast<int>(mesh.vertices.size()),
                                corners_.data(), static_cast<int>(corners_.size()), 3 * sizeof(dTriIndex));
  }
  void make_bodies(std::size_t count) override {
    while (bodies_.size() < count) bodies_.push_back(dCreateTriMesh(nullptr, mesh_, nullptr, nullptr, nullptr));
  }
  void move(std::span<const Placement> bodies) override {
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      dMatrix3 rotation = {};  // rows of four
      for (int row = 0; row < 3; ++row) std::copy_n(bodies[i].rotation[row], 3, rotation + 4 * row);
      dGeomSetRotation(bodies_[i], rotation);
      dGeomSetPosition(bodies_[i], bodies[i].position.x, bodies[i].position.y, bodies[i].position.z);
    }
  }
  bool first(std::size_t a, std::size_t b) override {
    return collide(a, b, static_cast<int>(1u | CONTACTS_UNIMPORTANT)) > 0;
  }
  std::size_t all(std::size_t a, std::size_t b) override {
    const int count = collide(a, b, kMostContacts);
    pairs_.clear();
    for (int i = 0; i < count; ++i) {
      const dContactGeom& contact = contacts_[static_cast<std::size_t>(i)];
      pairs_.emplace_back(contact.side1, contact.side2);
    }
    std::ranges::sort(pairs_);
    pairs_.erase(std::ranges::unique(pairs_).begin(), pairs_.end());
    return pairs_.size();
  }

 private:
  int collide(std::size_t a, std::size_t b, int flags) {
    return dCollide(bodies_[a], bodies_[b], flags, contacts_.data(), sizeof(dContactGeom));
  }

  std::vector<double> vertices_;
  std::vector<dTriIndex> corners_;
  dTriMeshDataID mesh_ = nullptr;
  std::vector<dGeomID> bodies_;
  std::vector<dContactGeom> contacts_;
  std::vector<std::pair<int, int>> pairs_;  // of triangles
};

}  // namespace

EngineKind ode() {
  return {"ode", Pairs::kMerged, []() -> std::unique_ptr<Engine> { return std::make_unique<OdeEngine>(); }};
}

}  // namespace peerd::bench::peers
