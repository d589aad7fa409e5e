#include "replication/physics/parts/contact_polygons.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "collision/scene/scene_query.hpp"
#include "core/motion/scene_motion.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::contact_polygons_test {

using namespace test;

// What collide says of two nodes at a world time.
std::vector<ShapePair> pairs_of_collide(const Scene& scene, ObjectId a, ObjectId b, double t_s) {
  collision::SceneQuery query(scene);
  SceneMotion motion(scene);
  query.set_transforms(motion.transforms_at(t_s));
  for (SceneMotion::MovedGeometry& moved : motion.moved_geometries(t_s)) query.reshape(moved.index, moved.form);
  const auto found = query.collide(a, b, CollisionType::kAllPairs);
  EXPECT_TRUE(found.has_value());
  return found->pairs;
}

// The first contact in a world whose objects go by their velocityVectors, with session time as world time.
struct Met {
  explicit Met(const std::string& text, const std::vector<const char*>& owned = {})
      : world(text, owned), motion(*world.model, sim(0s)) {
    if (!world.model->flexible.empty()) {
      flexible = std::make_unique<FlexibleParts>(*world.model);
      flexible->set_world_zero(sim(0s));
      motion.set_flexible(*flexible);
    }
    for (const char* const path : owned) {
      const ObjectId id = world[path];
      KinematicState state = motion.relative_at(id, sim(0s));
      state.velocity = world.scene.object(id).velocity;
      motion.declare(id, Role::kPredicted);
      motion.set_base(id, sim(0s), state);
    }
  }
  const ContactEvent& first(Duration until) {
    motion.advance(sim(until));
    const auto all = contacts_of(motion);
    EXPECT_FALSE(all.empty());
    met = all.empty() ? ContactEvent{} : all.front();
    return *met;
  }
  TouchedPolygons touched(CollisionType type) const {
    ContactEvent contact = *met;
    contact.type = type;
    return touched_polygons(*world.model, motion, flexible.get(), contact);
  }
  std::vector<ShapePair> collide(double t_s) const {
    return pairs_of_collide(world.scene, met->collider, met->collidee, t_s);
  }

  World world;
  std::unique_ptr<FlexibleParts> flexible;
  MotionWorld motion;
  std::optional<ContactEvent> met;
};

std::string box_and_wall(const std::string& response = "", const std::string& size = "1 1 1") {
  return box("BOX", size, "-4.5 0 0", "velocityVector 2 0 0 " + response) + box("WALL", "1 9 9", "0.5 0 0") +
         interest("BOX", "\"WALL\"", 2);
}

// Nothing here is rounded: at 2 s the face of the box is in that of the wall.
TEST(ContactPolygons, OfAFaceInAFaceAreThoseOfCollide) {
  for (const char* const response : {"", kBounces, kStops}) {
    Met m(box_and_wall(response), {"BOX"});
    ASSERT_EQ(m.first(3s).at, sim(2s));
    const auto expected = m.collide(2.0);
    ASSERT_EQ(expected.size(), 5u) << "the face, and the edges of four others";
    EXPECT_EQ(m.touched(CollisionType::kAllPairs).pairs, expected) << response;
    EXPECT_EQ(m.touched(CollisionType::kAllPairs).count, 5u);
    EXPECT_EQ(m.touched(CollisionType::kWitness).pairs, std::vector{expected.front()}) << "the least";
    EXPECT_EQ(m.touched(CollisionType::kWitness).count, 1u);
    EXPECT_EQ(m.touched(CollisionType::kBox).count, 0u);
  }
}

// At the contact time, rounded down, the corner is some nanometres before the wall: collide has nothing there, and a
// few nanoseconds later what the peer names.
TEST(ContactPolygons, OfACornerThatIsAboutToTouchAreThoseAroundIt) {
  Met m(box("BOX", "1 1 1", "-4.7 0.1 0.2", "velocityVector 1.7 0 0 rotation 0.3 0.5 0.7 0.9") +
            box("WALL", "1 9 9", "0.5 0 0") + interest("BOX", "\"WALL\"", 2),
        {"BOX"});
  const double at_s = to_seconds(m.first(4s).at.time_since_epoch());
  ASSERT_TRUE(m.collide(at_s - 2e-9).empty());
  const auto later = m.collide(at_s + 1e-7);
  ASSERT_EQ(later.size(), 3u) << "the faces around the corner";
  EXPECT_EQ(m.touched(CollisionType::kAllPairs).pairs, later);
  EXPECT_EQ(m.touched(CollisionType::kWitness).pairs, std::vector{later.front()});
}

// The wheel is a part of CAR that moves in it, and the collidee comes first in the file.
TEST(ContactPolygons, OfAPartThatIsCarriedAreThoseOfCollide) {
  const std::string text =
      box("WALL", "1 9 9", "8.5 0 0") +
      "DEF CAR Transform { translation 0 1 0 velocityVector 2 0 0 children [ DEF WHEEL Transform { "
      "translation 1 -0.5 0 velocityVector 0.25 0 0 children [ "
      "Transform { rotation 0 1 0 1.5707963267948966 children DEF RIM Shape { geometry Box { size 1 1 "
      "2 } } } ] } ] }\n" +
      interest("CAR", "\"WALL\"", 2);
  Met m(text, {"CAR", "CAR/WHEEL"});
  const double at_s = to_seconds(m.first(4s).at.time_since_epoch());
  EXPECT_NEAR(at_s, 6.0 / 2.25, 1e-6);
  const auto touched = m.touched(CollisionType::kAllPairs);
  ASSERT_EQ(touched.pairs.size(), 5u);
  for (const ShapePair& pair : touched.pairs) EXPECT_EQ(pair.collider.shape, m.world["RIM"]);
  const auto later = m.collide(at_s + 1e-6);
  ASSERT_FALSE(later.empty());
  for (const ShapePair& pair : later) EXPECT_THAT(touched.pairs, testing::Contains(pair));
}

TEST(ContactPolygons, OfAFlexibleShapeAreThoseThatHaveComeToTouch) {
  Met m(box("GROWS", "1 1 1", "0 0 0") + box("WALL", "1 4 4", "1.6 0 0") + interest("GROWS", "\"WALL\"", 2) + kGrows);
  ASSERT_EQ(m.world.model->flexible.size(), 1u);
  const double at_s = to_seconds(m.first(1900ms).at.time_since_epoch());
  const auto touched = m.touched(CollisionType::kAllPairs);
  const auto later = m.collide(at_s + 1e-5);
  ASSERT_EQ(later.size(), 4u) << "by then the face is behind that of the wall";
  EXPECT_LE(touched.pairs.size(), 5u);
  for (const ShapePair& pair : later) EXPECT_THAT(touched.pairs, testing::Contains(pair));
}

// A ball meets a wall as the sphere that it is: its polygons stay inside of it.
TEST(ContactPolygons, OfASphereAreTheNearest) {
  Met m(
      "DEF BALL Transform { translation -4 0.3 0.2 velocityVector 1.5 0.1 0 rotation 0.2 0.3 1 0.7 children Shape { "
      "geometry Sphere { radius 0.5 } } }\n" +
          box("WALL", "1 9 9", "0.5 0 0") + interest("BALL", "\"WALL\"", 2),
      {"BALL"});
  static_cast<void>(m.first(4s));
  ASSERT_EQ(m.touched(CollisionType::kWitness).pairs.size(), 1u);
  const double at_s = to_seconds(m.met->at.time_since_epoch());
  ASSERT_TRUE(m.collide(at_s).empty()) << "the polygons do not touch";
  // The ball goes on until a vertex does.
  double s = at_s;
  while (m.collide(s).empty() && s < at_s + 0.1) s += 1e-6;
  const auto later = m.collide(s);
  for (const ShapePair& pair : later) EXPECT_THAT(m.touched(CollisionType::kAllPairs).pairs, testing::Contains(pair));
}

// Two that are deep in each other since a law has put them there: the exact answer, and no polygon that is only near.
TEST(ContactPolygons, OfTwoThatOverlapAreThoseOfCollide) {
  Met m(box("BOX", "1 1 1", "-9 0.125 0") + box("WALL", "1 9 9", "0.5 0 0") + interest("BOX", "\"WALL\"", 2), {"BOX"});
  m.motion.advance(sim(1s));
  m.motion.set_base(m.world["BOX"], sim(1s), moving({-0.25, 0.125, 0}, {0, 0.01, 0}));
  const ContactEvent& contact = m.first(2s);
  EXPECT_EQ(contact.at, sim(1s));
  const auto touched = m.touched(CollisionType::kAllPairs);
  EXPECT_EQ(touched.count, 4u) << "the sides, and not the face inside";
}

TEST(ContactPolygons, OfWhatIsWhollyInsideAreThoseThatItMeets) {
  Met m(box("BOX", "1 1 1", "-9 0 0", kBounces) + box("ROOM", "9 9 9", "9 0 0") + interest("BOX", "\"ROOM\"", 2),
        {"BOX"});
  m.motion.advance(sim(1s));
  m.motion.set_base(m.world["BOX"], sim(1s), moving({9, 0, 0}, {1, 0, 0}));
  m.motion.advance(sim(4900ms));
  EXPECT_TRUE(contacts_of(m.motion).empty());
  EXPECT_NEAR(to_seconds(m.first(6s).at - sim(0s)), 5.0, 1e-6);
  EXPECT_EQ(m.met->normal, Vec3(-1, 0, 0));
  EXPECT_EQ(m.touched(CollisionType::kAllPairs).count, 5u) << "the side of the box, and those at its edges";
  EXPECT_EQ(m.touched(CollisionType::kWitness).pairs.size(), 1u);
}

// Many polygons of one plane: all are counted, and the first are kept.
TEST(ContactPolygons, BeyondTheLimitAreCounted) {
  std::string points, faces;
  for (int i = 0; i < 10; ++i) {
    for (int k = 0; k < 10; ++k) {
      for (const auto& [y, z] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
        points += "0 " + std::to_string(i + y) + " " + std::to_string(k + z) + ", ";
      }
      const int n = 4 * (10 * i + k);
      for (int v = 0; v < 4; ++v) faces += std::to_string(n + v) + " ";
      faces += "-1 ";
    }
  }
  Met m(
      "DEF GRID Transform { translation -4 -5 -5 velocityVector 2 0 0 children Shape { geometry IndexedFaceSet { coord "
      "Coordinate { point [ " +
          points + " ] } coordIndex [ " + faces + " ] } } }\n" + box("WALL", "1 99 99", "0.5 0 0") +
          interest("GRID", "\"WALL\"", 2),
      {"GRID"});
  EXPECT_NEAR(to_seconds(m.first(3s).at.time_since_epoch()), 2.0, 1e-6) << "as near as a micrometre, and no less";
  const auto touched = m.touched(CollisionType::kAllPairs);
  const auto expected = m.collide(2.0);
  ASSERT_EQ(expected.size(), 100u);
  EXPECT_EQ(touched.count, 100u);
  ASSERT_EQ(touched.pairs.size(), TouchedPolygons::kKept);
  EXPECT_TRUE(std::ranges::equal(touched.pairs, std::span(expected).first(TouchedPolygons::kKept)));
}

// An answer with setBack has moved the box; the polygons are those where it met the wall, with its moving part.
TEST(ContactPolygons, AreThoseBeforeAnAnswerSetTheObjectBack) {
  Met m("DEF BOX Transform { translation -9 0.125 0 velocityVector 0.001 0 0 " + std::string(kBounces) +
            " children DEF PART Transform { translation 1 0 0 children Shape { geometry Box { size 1 1 1 } } } }\n" +
            box("WALL", "1 9 9", "0.5 0 0") + interest("BOX", "\"WALL\"", 2),
        {"BOX", "BOX/PART"});
  m.motion.advance(sim(900ms));
  m.motion.set_base(m.world["BOX"], sim(1s), moving({-1.25, 0.125, 0}, {1, 0, 0}));
  const ContactEvent& contact = m.first(2s);
  ASSERT_NE(contact.collider_before.position, m.motion.at(m.world["BOX"], contact.at).position) << "it was set back";
  EXPECT_EQ(m.touched(CollisionType::kAllPairs).count, 4u);
}

}  // namespace peerd::replication::contact_polygons_test
