// Box3D with four sub-steps, its usual number. Bodies keep their orientation, never sleep in a gas, and lose nothing
// there.
#include <box3d/box3d.h>

#include "bench/crowd/engine.hpp"

namespace peerd::bench {
namespace {

constexpr int kSubSteps = 4;

b3Vec3 to_box3d(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

class Box3d : public CrowdEngine {
 public:
  explicit Box3d(const CrowdScene& scene) : falls_(scene.kind == CrowdKind::kPile) {
    b3WorldDef world = b3DefaultWorldDef();
    world.gravity = {0, falls_ ? static_cast<float>(-kGravity_m_s2) : 0, 0};
    world.enableSleep = falls_;
    if (!falls_) world.restitutionThreshold = 0;
    world.workerCount = 1;
    world_ = b3CreateWorld(&world);
    for (const CrowdWall& wall : walls_of(scene)) add(wall.centre, wall.half, Vec3::Zero(), false);
    for (const CrowdBody& body : scene.bodies) {
      bodies_.push_back(add(body.place, Vec3::Constant(0.5), body.velocity, body.moves));
    }
  }
  Box3d(const Box3d&) = delete;
  Box3d& operator=(const Box3d&) = delete;
  ~Box3d() override { b3DestroyWorld(world_); }

  void step() override {
    b3World_Step(world_, static_cast<float>(kStep_s), kSubSteps);
    begun_ += static_cast<std::uint64_t>(b3World_GetContactEvents(world_).beginCount);
  }
  void poses(std::vector<CrowdPose>& bodies) override {
    bodies.clear();
    for (const b3BodyId id : bodies_) {
      const b3Pos at = b3Body_GetPosition(id);
      const b3Vec3 v = b3Body_GetLinearVelocity(id);
      bodies.push_back({{at.x, at.y, at.z}, {v.x, v.y, v.z}});
    }
  }
  std::uint64_t contacts() override { return begun_; }

 private:
  b3BodyId add(const Vec3& place, const Vec3& half, const Vec3& velocity, bool moves) {
    b3BodyDef body = b3DefaultBodyDef();
    body.type = moves ? b3_dynamicBody : b3_staticBody;
    const b3Vec3 at = to_box3d(place);
    body.position = {at.x, at.y, at.z};
    body.linearVelocity = to_box3d(velocity);
    body.motionLocks.angularX = body.motionLocks.angularY = body.motionLocks.angularZ = true;
    body.enableSleep = falls_;
    const b3BodyId id = b3CreateBody(world_, &body);
    b3ShapeDef shape = b3DefaultShapeDef();
    shape.density = 1;
    shape.baseMaterial.friction = falls_ ? 0.5F : 0;
    shape.baseMaterial.restitution = falls_ ? 0 : 1;
    shape.enableContactEvents = true;
    const b3BoxHull box =
        b3MakeBoxHull(static_cast<float>(half.x()), static_cast<float>(half.y()), static_cast<float>(half.z()));
    static_cast<void>(b3CreateHullShape(id, &shape, &box.base));
    return id;
  }

  bool falls_;
  b3WorldId world_{};
  std::vector<b3BodyId> bodies_;
  std::uint64_t begun_ = 0;
};

}  // namespace

std::unique_ptr<CrowdEngine> box3d_engine(const CrowdScene& scene) { return std::make_unique<Box3d>(scene); }

}  // namespace peerd::bench
