// Numbers from the ends of their range in worlds: refused by name, or what follows from them is finite and
// does not take for ever. What is no number, and infinity: core/vrml/number_test.cpp.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "collision/scene/collision_watch.hpp"
#include "core/motion/predefined_motion.hpp"
#include "core/scene/reader.hpp"
#include "replication/physics/world/motion_world.hpp"

namespace peerd::file_extremes_test {

using namespace std::chrono_literals;
using testing::HasSubstr;

constexpr const char* kNumbers[] = {"1e38", "-1e38", "3.4028235e38", "1e-38", "1e-45", "1e-44", "-1e-45",
                                    "-0",   "0",     "1e19",         "1e9",   "1e39",  "1e-60", "-3.4028235e38"};

struct Field {
  const char* name;
  const char* in_box;     // fields of BOX's Transform
  const char* geometry;   // of BOX; none: a cube
  const char* elsewhere;  // other nodes
};
const Field kFields[] = {
    {"Translation", "translation @ 1 @", nullptr, ""},
    {"Rotation", "rotation @ 0 1 2", nullptr, ""},
    {"RotationAxis", "rotation @ @ @ 1", nullptr, ""},
    {"Angle", "rotation 0 1 0 @", nullptr, ""},
    {"Scale", "scale 1 @ 1", nullptr, ""},
    {"ScaleEven", "scale @ @ @", nullptr, ""},
    {"Center", "center @ 0 @ rotation 1 2 3 1", nullptr, ""},
    {"ScaleOrientation", "scale 1 2 1 scaleOrientation @ 1 0 @", nullptr, ""},
    {"Velocity", "velocityVector @ 0 @", nullptr, ""},
    {"Mass", "collisionResponse CollisionResponse { responseType 2 mass @ }", nullptr, ""},
    {"Restitution", "collisionResponse CollisionResponse { responseType 2 restitution @ }", nullptr, ""},
    {"Friction", "velocityVector 1 0 0 collisionResponse CollisionResponse { responseType 2 friction @ }", nullptr, ""},
    {"Threshold", "distanceThreshold @", nullptr, ""},
    {"BoxSize", "", "Box { size @ 1 @ }", ""},
    {"Radius", "", "Sphere { radius @ }", ""},
    {"Cone", "", "Cone { bottomRadius @ height @ }", ""},
    {"Cylinder", "", "Cylinder { radius 1 height @ }", ""},
    {"Points", "",
     "IndexedFaceSet { coord Coordinate { point [ 0 0 0, @ 0 0, 0 @ 0, 0 0 @ ] } coordIndex [ 0 1 2 -1 0 3 1 -1 ] }",
     ""},
    {"Elevation", "", "ElevationGrid { xDimension 2 zDimension 2 xSpacing @ zSpacing 1 height [ 0 @ 0 1 ] }", ""},
    {"Extrusion", "", "Extrusion { scale [ @ 1 ] spine [ 0 0 0, 0 @ 0, 0 2 1 ] }", ""},
    {"Cycle", "", nullptr,
     "DEF T TimeSensor { cycleInterval @ loop TRUE } DEF P PositionInterpolator { key [ 0 1 ] keyValue [ 5 0 0, 9 0 0 "
     "] "
     "} ROUTE T.fraction_changed TO P.set_fraction ROUTE P.value_changed TO BOX.translation"},
    {"Keys", "", nullptr,
     "DEF T TimeSensor { cycleInterval 2 loop TRUE } DEF P PositionInterpolator { key [ 0 @ 1 ] keyValue [ 5 0 0, 9 0 "
     "0, "
     "5 0 0 ] } ROUTE T.fraction_changed TO P.set_fraction ROUTE P.value_changed TO BOX.translation"},
    {"KeyValues", "", nullptr,
     "DEF T TimeSensor { cycleInterval 2 loop TRUE } DEF P PositionInterpolator { key [ 0 1 ] keyValue [ 5 @ 0, 9 0 @ "
     "] "
     "} ROUTE T.fraction_changed TO P.set_fraction ROUTE P.value_changed TO BOX.translation"},
    {"KeyRotations", "", nullptr,
     "DEF T TimeSensor { cycleInterval 2 loop TRUE } DEF P OrientationInterpolator { key [ 0 1 ] keyValue [ @ 1 0 1, 0 "
     "1 "
     "@ @ ] } ROUTE T.fraction_changed TO P.set_fraction ROUTE P.value_changed TO BOX.rotation"},
    {"StartTime", "", nullptr,
     "DEF T TimeSensor { cycleInterval 2 loop TRUE startTime @ stopTime @ } DEF P PositionInterpolator { key [ 0 1 ] "
     "keyValue [ 5 0 0, 9 0 0 ] } ROUTE T.fraction_changed TO P.set_fraction ROUTE P.value_changed TO BOX.translation"},
};

std::string with_number(std::string text, const std::string& number) {
  for (std::size_t at = 0; (at = text.find('@', at)) != std::string::npos;) text.replace(at, 1, number);
  return text;
}
std::string world_of(const Field& f, const std::string& number) {
  const std::string response =
      std::string(f.in_box).contains("collisionResponse") ? "" : " collisionResponse CollisionResponse { } ";
  const std::string geometry = f.geometry != nullptr ? f.geometry : "Box { }";
  return "#VRML V2.0 utf8\n" +
         with_number("DEF BOX Transform { " + response + f.in_box + " children Shape { geometry " + geometry +
                         " } }\n" +
                         "DEF BALL Transform { translation 0.5 0 0 velocityVector -1 0 0 collisionResponse "
                         "CollisionResponse { } children Shape { geometry Sphere { } } }\n" +
                         f.elsewhere,
                     number) +
         "\nCollisionInterest { objectPath \"BOX\" interests \"BALL\" collisionType 2 }\n"
         "CollisionInterest { objectPath \"BALL\" interests \"BOX\" collisionType 1 }\n";
}

bool sound(const KinematicState& s) {
  return s.position.allFinite() && s.velocity.allFinite() && s.acceleration.allFinite() &&
         s.angular_velocity_body.allFinite() && std::abs(s.orientation.norm() - 1.0) < 1e-9;
}

class WorldNumbers : public testing::TestWithParam<Field> {};
TEST_P(WorldNumbers, AreRefusedByNameOrHandled) {
  int good = 0;
  for (const char* const number : kNumbers) {
    SCOPED_TRACE(number);
    const std::string text = world_of(GetParam(), number);
    ReadResult result = read_world(text);
    if (!result.scene) {
      ASSERT_FALSE(result.diagnostics.empty());
      EXPECT_FALSE(render(result, result.diagnostics.front()).empty());
      continue;
    }
    ++good;
    const Scene scene = *std::move(result.scene);
    const ObjectId box = *scene.find("BOX"), ball = *scene.find("BALL");
    // Exact queries give an answer, or a refusal that names the Shape.
    collision::CollisionWatch watch(scene);
    for (const auto& refused : watch.tick().refused) EXPECT_THAT(refused.why, HasSubstr("BOX"));
    // The Transforms that the world moves by itself.
    PredefinedMotion moves(scene);
    for (const double t : {-1.0, 0.0, 0.3, 1.0, 86400.0, 1e9}) {
      if (moves.moves(box)) {
        const auto piece = moves.piece(box, t);
        ASSERT_LE(piece.begin_s, t);
        ASSERT_GT(piece.end_s, t);
        ASSERT_TRUE(sound(piece.state)) << t;
      }
    }
    // Three seconds of motion and contacts.
    const auto model = replication::make_world_model(scene);
    replication::MotionWorld motions(*model, SimTime{});
    for (const ObjectId object : {box, ball}) {
      if (moves.moves(object)) continue;
      motions.declare(object, replication::Role::kAuthoritative);
      KinematicState s = motions.at(object, SimTime{});
      ASSERT_TRUE(sound(s)) << "where the file has it";
      s.velocity = object == ball ? Vec3(-1, 0, 0) : Vec3::Zero();
      motions.set_base(object, SimTime{}, s);
    }
    for (Duration t = 0s; t <= 3s; t += 50ms) motions.advance(SimTime{t});
    // A ball rattles in the box that it fills, with a flight of 2 ms.
    EXPECT_LT(motions.counters().contact_searches, 20'000u);
    for (const ObjectId object : {box, ball}) ASSERT_TRUE(sound(motions.at(object, SimTime{3s})));
  }
  EXPECT_GT(good, 0);
}
INSTANTIATE_TEST_SUITE_P(Fields, WorldNumbers, testing::ValuesIn(kFields),
                         [](const auto& f) { return std::string(f.param.name); });

}  // namespace peerd::file_extremes_test
