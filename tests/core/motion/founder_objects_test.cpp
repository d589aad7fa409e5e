#include "core/motion/founder_objects.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/reader.hpp"

namespace peerd::founder_objects_test {

using testing::ElementsAre;

std::vector<std::string> founder_objects_in(const std::string& world) {
  const std::string text = "#VRML V2.0 utf8\n" + world;
  const ReadResult read = read_world(text);
  if (!read.scene) throw std::runtime_error(render(read, read.diagnostics.front()));
  std::vector<std::string> all;
  for (const ObjectId id : founder_objects(*read.scene)) all.push_back(read.scene->path_of(id));
  return all;
}

TEST(FounderObjects, AreTheTransformsThatTheFileMarks) {
  const auto found = founder_objects_in(R"(
DEF A Transform { enslaved TRUE velocityVector 1 0 0 children DEF B Transform { enslaved TRUE } }
DEF C Transform { enslaved FALSE }
DEF D Transform { remote TRUE })");
  EXPECT_THAT(found, ElementsAre("A", "A/B"));
}

TEST(FounderObjects, EachInstanceIsOne) {
  EXPECT_THAT(founder_objects_in("DEF A Transform { enslaved TRUE } Group { children USE A }"),
              ElementsAre("A", "1/A"));
}

TEST(FounderObjects, WhatARouteMovesOrDistortsHasNoOwnerByTheFile) {
  const auto found = founder_objects_in(R"(
DEF A Transform { enslaved TRUE children DEF INSIDE Transform { enslaved TRUE } }
DEF B Transform { children DEF BELOW Transform { enslaved TRUE } }
DEF C Transform { scale 1 2 1 children DEF TURNING Transform { enslaved TRUE } }
DEF CLOCK TimeSensor { loop TRUE }
DEF PATH PositionInterpolator { key [ 0 1 ] keyValue [ 1 1 1, 2 2 2 ] }
DEF TURN OrientationInterpolator { key [ 0 1 ] keyValue [ 0 1 0 0, 0 1 0 1 ] }
ROUTE CLOCK.fraction_changed TO PATH.set_fraction
ROUTE CLOCK.fraction_changed TO TURN.set_fraction
ROUTE PATH.value_changed TO A.translation
ROUTE PATH.value_changed TO B.scale
ROUTE TURN.value_changed TO TURNING.rotation)");
  EXPECT_THAT(found, ElementsAre("A/INSIDE")) << "A moves, B/BELOW and C/TURNING change their shape";
}

}  // namespace peerd::founder_objects_test
