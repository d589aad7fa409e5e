// Bullet, as its distribution compiles it. Bodies keep their orientation, never sleep, and lose nothing in a gas.
#include <btBulletDynamicsCommon.h>

#include "bench/crowd/engine.hpp"

namespace peerd::bench {
namespace {

std::uint64_t begun = 0;  // Bullet tells of contacts by a global function
void on_begin(btPersistentManifold* const&) { ++begun; }

btVector3 to_bullet(const Vec3& v) {
  return {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z())};
}
Vec3 to_vec3(const btVector3& v) { return {v.x(), v.y(), v.z()}; }

class Bullet : public CrowdEngine {
 public:
  explicit Bullet(const CrowdScene& scene) : falls_(scene.kind == CrowdKind::kPile) {
    world_.setGravity(btVector3(0, falls_ ? static_cast<btScalar>(-kGravity_m_s2) : 0, 0));
    if (!falls_) world_.getSolverInfo().m_restitutionVelocityThreshold = 0;
    for (const CrowdWall& wall : walls_of(scene)) {
      walls_.push_back(std::make_unique<btBoxShape>(to_bullet(wall.half)));
      add(wall.centre, *walls_.back(), false);
    }
    for (const CrowdBody& body : scene.bodies) {
      btRigidBody& added = add(body.place, cube_, body.moves);
      if (!body.moves) continue;
      added.setLinearVelocity(to_bullet(body.velocity));
      added.setAngularFactor(0);
      if (!falls_) added.setActivationState(DISABLE_DEACTIVATION);
    }
    bodies_.erase(bodies_.begin(), bodies_.begin() + static_cast<std::ptrdiff_t>(walls_.size()));
    begun = 0;
    gContactStartedCallback = on_begin;
  }

  void step() override { world_.stepSimulation(static_cast<btScalar>(kStep_s), 0, static_cast<btScalar>(kStep_s)); }
  void poses(std::vector<CrowdPose>& bodies) override {
    bodies.clear();
    for (const btRigidBody* body : bodies_) {
      bodies.push_back({to_vec3(body->getWorldTransform().getOrigin()), to_vec3(body->getLinearVelocity())});
    }
  }
  std::uint64_t contacts() override { return begun; }

 private:
  btRigidBody& add(const Vec3& place, btCollisionShape& shape, bool moves) {
    btRigidBody::btRigidBodyConstructionInfo info(moves ? 1 : 0, nullptr, &shape,
                                                  moves ? btVector3(1, 1, 1) / 6 : btVector3(0, 0, 0));
    info.m_startWorldTransform = btTransform(btQuaternion::getIdentity(), to_bullet(place));
    info.m_friction = falls_ ? 0.7071F : 0;  // Bullet multiplies those of two
    info.m_restitution = falls_ ? 0 : 1;
    owned_.push_back(std::make_unique<btRigidBody>(info));
    world_.addRigidBody(owned_.back().get());
    bodies_.push_back(owned_.back().get());
    return *owned_.back();
  }

  bool falls_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broad_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broad_, &solver_, &configuration_};
  btBoxShape cube_{btVector3(0.5, 0.5, 0.5)};
  std::vector<std::unique_ptr<btBoxShape>> walls_;
  std::vector<std::unique_ptr<btRigidBody>> owned_;
  std::vector<btRigidBody*> bodies_;
};

}  // namespace

std::unique_ptr<CrowdEngine> bullet_engine(const CrowdScene& scene) { return std::make_unique<Bullet>(scene); }

}  // namespace peerd::bench
