#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "tests/replication/peer/worlds.hpp"

// Many bodies that fall onto each other in a shaft and stay there.
namespace peerd::replication::heap_test {

using namespace test;

const Vec3 kGravity(0, -9.81, 0);

struct Kind {
  const char* geometry;
  double restitution;
};

// A shaft 1.4 m wide and as deep, and bodies at any tilt above each other in it.
class Heap {
 public:
  Heap(const Kind& kind, int count, std::uint64_t seed) : count_(count), w_(text(kind, count, seed)) {
    for (const ObjectId body : bodies()) world_.declare(body, Role::kAuthoritative);
    for (const ObjectId body : bodies()) {
      KinematicState state = world_.at(body, sim(0s));
      state.acceleration = kGravity;
      world_.set_base(body, sim(0s), state);
    }
  }

  [[nodiscard]] MotionWorld& world() { return world_; }
  [[nodiscard]] std::vector<ObjectId> bodies() const {
    std::vector<ObjectId> ids;
    for (int i = 0; i < count_; ++i) ids.push_back(w_["B" + std::to_string(i)]);
    return ids;
  }
  // For bodies of 1 kg [J].
  [[nodiscard]] double energy(SimTime t) const {
    double sum = 0.0;
    for (const ObjectId body : bodies()) {
      const KinematicState s = world_.at(body, t);
      sum += 0.5 * s.velocity.squaredNorm() - kGravity.dot(s.position);
    }
    return sum;
  }

 private:
  static std::string text(const Kind& kind, int count, std::uint64_t seed) {
    std::mt19937_64 rng(seed);
    const auto within = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(rng() >> 11) * 0x1p-53;
    };
    std::string all = box("FLOOR", "9 1 9", "0 -0.5 0") + box("LEFT", "1 90 9", "-1.2 40 0") +
                      box("RIGHT", "1 90 9", "1.2 40 0") + box("BACK", "9 90 1", "0 40 -1.2") +
                      box("FRONT", "9 90 1", "0 40 1.2");
    std::string names = R"("FLOOR" "LEFT" "RIGHT" "BACK" "FRONT")";
    for (int i = 0; i < count; ++i) {
      const std::string name = "B" + std::to_string(i);
      const auto number = [&](double x) { return std::to_string(x) + " "; };
      all += "DEF " + name + " Transform { translation " + number(within(-0.3, 0.3)) + number(0.6 + 0.8 * i) +
             number(within(-0.3, 0.3)) + "rotation " + number(within(-1, 1)) + number(within(-1, 1)) +
             number(within(0.1, 1)) + number(within(0, std::numbers::pi)) +
             "collisionResponse CollisionResponse { responseType 2 restitution " + std::to_string(kind.restitution) +
             " } children Shape { geometry " + kind.geometry + " } }\n";
      names += " \"" + name + "\"";
    }
    for (int i = 0; i < count; ++i) {
      const std::string name = "\"B" + std::to_string(i) + "\"";
      std::string others = names;
      others.erase(others.find(name), name.size());
      all += interest("B" + std::to_string(i), others);
    }
    return all;
  }

  int count_;
  World w_;
  MotionWorld world_{*w_.model, sim(0s)};
};

constexpr const char* kBox = "Box { size 0.4 0.3 0.5 }";
constexpr const char* kBall = "Sphere { radius 0.2 }";

// Advances in steps of that length, none of which may bring energy.
void fall(Heap& heap, Duration until, Duration step) {
  double before = heap.energy(sim(0s));
  for (Duration t = step; t <= until; t += step) {
    heap.world().advance(sim(t));
    const double now = heap.energy(sim(t));
    ASSERT_LE(now, before * (1.0 + 1e-9)) << to_seconds(t) << " s";
    before = now;
  }
}

// No energy comes from nothing, nothing is found in anything else, and no contact needs more than its own answer.
TEST(Heap, LosesEnergyAndOverlapsNothing) {
  for (const Kind& kind : {Kind{kBox, 0.0}, Kind{kBox, 0.5}, Kind{kBox, 0.9}, Kind{kBall, 0.0}, Kind{kBall, 0.5}}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(testing::Message() << kind.geometry << ", restitution " << kind.restitution << ", seed " << seed);
      Heap heap(kind, 8, seed);
      ASSERT_NO_FATAL_FAILURE(fall(heap, 5s, 10ms));
      const MotionCounters& counters = heap.world().counters();
      EXPECT_EQ(counters.overlapped, 0u);
      EXPECT_EQ(counters.jammed, 0u);
      EXPECT_EQ(counters.capped, 0u);
      EXPECT_LT(counters.contacts, 100u * 8u * (kind.restitution > 0.5 ? 4u : 1u));
    }
  }
}

// Boxes at rest stand still, to the last bit, and cost no search any more. Nothing brakes a box that slides along the
// floor at a few millimetres a second: it takes its time to the wall.
TEST(Heap, OfThreeTiltedBoxesComesToRest) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(seed);
    Heap heap({kBox, 0.0}, 3, seed);
    heap.world().advance(sim(1000s));
    for (const ObjectId body : heap.bodies()) EXPECT_TRUE(heap.world().is_at_rest_from(body, sim(1000s)));
    const std::uint64_t searches = heap.world().counters().contact_searches;
    heap.world().advance(sim(1020s));
    EXPECT_EQ(heap.world().counters().contact_searches, searches);
  }
}

// In a crowd contacts are foreseen, and what bounces slowly stays.
TEST(Heap, ACrowdComesToRest) {
  struct Crowd {
    Kind kind;
    int count;
    std::size_t contacts_of_each;
  };
  for (const Crowd& crowd : {Crowd{{kBox, 0.0}, 30, 30}, Crowd{{kBox, 0.5}, 30, 80}, Crowd{{kBall, 0.0}, 16, 40}}) {
    SCOPED_TRACE(testing::Message() << crowd.kind.geometry << ", restitution " << crowd.kind.restitution);
    Heap heap(crowd.kind, crowd.count, 1);
    ASSERT_NO_FATAL_FAILURE(fall(heap, 20s, 50ms));
    for (const ObjectId body : heap.bodies()) EXPECT_LE(heap.world().at(body, sim(20s)).velocity.norm(), 1e-6);
    const MotionCounters counters = heap.world().counters();
    EXPECT_EQ(counters.overlapped, 0u);
    EXPECT_EQ(counters.capped, 0u);
    EXPECT_LE(counters.contacts, crowd.contacts_of_each * static_cast<std::size_t>(crowd.count));
    heap.world().advance(sim(21s));
    EXPECT_EQ(heap.world().counters().contacts, counters.contacts);
  }
}

// A crowd in which peers have to agree on each contact foresees none, and goes another way than one that foresees all.
TEST(Heap, ACrowdForeseesOnlyWhatNeedsNoAgreement) {
  double energy[2];
  for (const bool alone : {false, true}) {
    Heap heap({kBox, 0.0}, 30, 1);
    std::size_t asked = 0;
    heap.world().set_authority({{}, [&](ObjectId, ObjectId) {
                                  ++asked;
                                  return alone;
                                }});
    heap.world().advance(sim(4s));
    EXPECT_GT(asked, 100u);
    energy[alone ? 1 : 0] = heap.energy(sim(4s));
  }
  EXPECT_NE(energy[0], energy[1]);
}

TEST(Heap, DoesNotDependOnTicks) {
  std::vector<KinematicState> seen;
  for (const int hz : {20, 60, 144}) {
    Heap heap({kBox, 0.5}, 12, 3);
    for (int k = 1; k <= 3 * hz; ++k) heap.world().advance(sim(from_seconds(static_cast<double>(k) / hz)));
    const std::vector<ObjectId> bodies = heap.bodies();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const KinematicState s = heap.world().at(bodies[i], sim(3s));
      if (seen.size() < bodies.size()) {
        seen.push_back(s);
      } else {
        EXPECT_TRUE(same_bits(s, seen[i])) << "body " << i << " at " << hz << " Hz";
      }
    }
  }
}

// The corner of the other box, which is the collidee, meets a face of this one, and of its own faces none is there.
TEST(Heap, AnImpulseActsAlongTheFaceThatACornerMeets) {
  for (const bool by_impulse : {true, false}) {
    const std::string answers = by_impulse ? " collisionResponse CollisionResponse { responseType 2 } " : kBounces;
    auto&& [w, world] = Started(
        box("PLATE", "4 1 4", "0 -0.5 0", answers) + box("TIP", "1 1 1", "0 3 0", "rotation 1 0.4 0 0.7 " + answers) +
            interest("PLATE", "\"TIP\"") + interest("TIP", "\"PLATE\""),
        {{"PLATE", Role::kAuthoritative, moving({0, -0.5, 0}, {0, 1, 0})}, {"TIP", Role::kAuthoritative}});
    const KinematicState tip = world.at(w["TIP"], sim(0s));
    world.advance(sim(4s));
    const auto seen = contacts_of(world);
    ASSERT_GE(seen.size(), 1u);
    EXPECT_EQ(seen[0].collider, w["PLATE"]);
    EXPECT_EQ(seen[0].collider_before.velocity, Vec3(0, 1, 0));
    EXPECT_EQ(seen[0].normal == -Vec3::UnitY(), by_impulse) << seen[0].normal.transpose();
    if (!by_impulse) continue;
    EXPECT_TRUE(seen[0].collider_after.velocity.isZero(1e-15));
    EXPECT_TRUE(seen[0].collidee_after.velocity.isApprox(Vec3(0, 1, 0), 1e-15));
    EXPECT_EQ(world.at(w["TIP"], sim(0s)).position, tip.position);
  }
}

}  // namespace peerd::replication::heap_test
