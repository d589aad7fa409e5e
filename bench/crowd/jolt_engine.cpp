// Jolt with its usual step. Bodies keep their orientation, never sleep in a gas, and lose nothing there.
#include <Jolt/Jolt.h>

#include <Jolt/Core/Factory.h>
#include <Jolt/Core/JobSystemSingleThreaded.h>
#include <Jolt/Core/TempAllocator.h>
#include <Jolt/Physics/Body/BodyCreationSettings.h>
#include <Jolt/Physics/Collision/Shape/BoxShape.h>
#include <Jolt/Physics/PhysicsSystem.h>
#include <Jolt/RegisterTypes.h>

#include "bench/crowd/engine.hpp"

namespace peerd::bench {
namespace {

constexpr JPH::ObjectLayer kFixed = 0, kMoving = 1;

class BroadLayers final : public JPH::BroadPhaseLayerInterface {
 public:
  JPH::uint GetNumBroadPhaseLayers() const override { return 2; }
  JPH::BroadPhaseLayer GetBroadPhaseLayer(JPH::ObjectLayer layer) const override {
    return JPH::BroadPhaseLayer(static_cast<JPH::BroadPhaseLayer::Type>(layer));
  }
#if defined(JPH_EXTERNAL_PROFILE) || defined(JPH_PROFILE_ENABLED)
  const char* GetBroadPhaseLayerName(JPH::BroadPhaseLayer) const override { return "layer"; }
#endif
};
class LayerPairs final : public JPH::ObjectLayerPairFilter {
 public:
  bool ShouldCollide(JPH::ObjectLayer a, JPH::ObjectLayer b) const override { return a == kMoving || b == kMoving; }
};
class BroadPairs final : public JPH::ObjectVsBroadPhaseLayerFilter {
 public:
  bool ShouldCollide(JPH::ObjectLayer a, JPH::BroadPhaseLayer b) const override {
    return a == kMoving || b == JPH::BroadPhaseLayer(kMoving);
  }
};
class Begun final : public JPH::ContactListener {
 public:
  void OnContactAdded(const JPH::Body&, const JPH::Body&, const JPH::ContactManifold&, JPH::ContactSettings&) override {
    ++count;
  }
  std::uint64_t count = 0;
};

JPH::RVec3 to_jolt(const Vec3& v) {
  return {static_cast<JPH::Real>(v.x()), static_cast<JPH::Real>(v.y()), static_cast<JPH::Real>(v.z())};
}

void register_types() {
  if (JPH::Factory::sInstance != nullptr) return;
  JPH::RegisterDefaultAllocator();
  JPH::Factory::sInstance = new JPH::Factory();
  JPH::RegisterTypes();
}

class Jolt : public CrowdEngine {
 public:
  explicit Jolt(const CrowdScene& scene) : falls_(scene.kind == CrowdKind::kPile) {
    const auto count = static_cast<JPH::uint>(scene.bodies.size() + 16);
    system_.Init(count, 0, 4 * count + 1024, 4 * count + 1024, broad_layers_, broad_pairs_, layer_pairs_);
    system_.SetGravity(JPH::Vec3(0, falls_ ? static_cast<float>(-kGravity_m_s2) : 0, 0));
    JPH::PhysicsSettings settings = system_.GetPhysicsSettings();
    if (!falls_) settings.mMinVelocityForRestitution = 0;
    system_.SetPhysicsSettings(settings);
    system_.SetContactListener(&begun_);
    for (const CrowdWall& wall : walls_of(scene)) {
      add(wall.centre, new JPH::BoxShape(JPH::Vec3(to_jolt(wall.half))), Vec3::Zero(), false);
    }
    const JPH::RefConst<JPH::Shape> cube = new JPH::BoxShape(JPH::Vec3::sReplicate(0.5F));
    for (const CrowdBody& body : scene.bodies) bodies_.push_back(add(body.place, cube, body.velocity, body.moves));
    system_.OptimizeBroadPhase();
  }

  void step() override { system_.Update(static_cast<float>(kStep_s), 1, &temporary_, &jobs_); }
  void poses(std::vector<CrowdPose>& bodies) override {
    bodies.clear();
    const JPH::BodyInterface& all = system_.GetBodyInterfaceNoLock();
    for (const JPH::BodyID id : bodies_) {
      const JPH::RVec3 at = all.GetPosition(id);
      const JPH::Vec3 v = all.GetLinearVelocity(id);
      bodies.push_back({{at.GetX(), at.GetY(), at.GetZ()}, {v.GetX(), v.GetY(), v.GetZ()}});
    }
  }
  std::uint64_t contacts() override { return begun_.count; }

 private:
  JPH::BodyID add(const Vec3& place, const JPH::Shape* shape, const Vec3& velocity, bool moves) {
    JPH::BodyCreationSettings settings(shape, to_jolt(place), JPH::Quat::sIdentity(),
                                       moves ? JPH::EMotionType::Dynamic : JPH::EMotionType::Static,
                                       moves ? kMoving : kFixed);
    settings.mFriction = falls_ ? 0.5F : 0;  // Jolt takes the geometric mean of two
    settings.mRestitution = falls_ ? 0 : 1;
    settings.mLinearDamping = settings.mAngularDamping = 0;
    settings.mAllowSleeping = falls_;
    if (moves) {
      settings.mLinearVelocity = JPH::Vec3(to_jolt(velocity));
      settings.mAllowedDOFs =
          JPH::EAllowedDOFs::TranslationX | JPH::EAllowedDOFs::TranslationY | JPH::EAllowedDOFs::TranslationZ;
      settings.mOverrideMassProperties = JPH::EOverrideMassProperties::CalculateInertia;
      settings.mMassPropertiesOverride.mMass = 1;
    }
    return system_.GetBodyInterfaceNoLock().CreateAndAddBody(
        settings, moves ? JPH::EActivation::Activate : JPH::EActivation::DontActivate);
  }

  bool falls_;
  BroadLayers broad_layers_;
  LayerPairs layer_pairs_;
  BroadPairs broad_pairs_;
  Begun begun_;
  JPH::TempAllocatorImplWithMallocFallback temporary_{32 << 20};
  JPH::JobSystemSingleThreaded jobs_{JPH::cMaxPhysicsJobs};
  JPH::PhysicsSystem system_;
  std::vector<JPH::BodyID> bodies_;
};

}  // namespace

std::unique_ptr<CrowdEngine> jolt_engine(const CrowdScene& scene) {
  register_types();
  return std::make_unique<Jolt>(scene);
}

}  // namespace peerd::bench
