#include "peerd/view/frames/movers.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/peerd/view/picture/picture_of_text.hpp"

namespace peerd::view::movers_test {

using peerd::testing_support::scene_of;
using testing::ElementsAre;

std::vector<std::string> paths(const Scene& scene, const Movers& movers) {
  std::vector<std::string> out;
  for (const ObjectId id : movers.ids) out.push_back(scene.path_of(id));
  return out;
}

TEST(Movers, AreWhatTheWorldMovesAndWhatPeersMay) {
  const Scene scene = scene_of(R"(
DEF T TimeSensor { loop TRUE }
DEF I PositionInterpolator { key [0 1] keyValue [0 0 0, 1 0 0] }
DEF STANDS Transform { children DEF MILL Transform { children Shape { geometry Box { } } } }
DEF OWNED Transform { enslaved TRUE children [
  DEF INNER Transform { velocityVector 1 0 0 children DEF DEEP Transform { children Shape { geometry Box { } } } } ] }
DEF BALL Transform { children Shape { geometry Sphere { } } }
DEF WALL Shape { geometry Box { } }
CollisionInterest { objectPath "BALL" interests "WALL" }
DEF KEYED Transform { children Shape { geometry Box { } } }
KeySensor { recipient "KEYED" keyValue 65 value 1 0 0 }
ROUTE T.fraction_changed TO I.set_fraction
ROUTE I.value_changed TO MILL.set_translation)");
  const Movers movers = movers_of(scene);
  EXPECT_THAT(paths(scene, movers), ElementsAre("STANDS/MILL", "OWNED", "OWNED/INNER", "BALL", "KEYED"));
  EXPECT_THAT(movers.above, ElementsAre(Movers::kNone, Movers::kNone, 1u, Movers::kNone, Movers::kNone));
  EXPECT_THAT(movers.of_peer, ElementsAre(false, true, false, true, true));
}

// A body that changes its shape is nowhere as a rigid one.
TEST(Movers, AreRigid) {
  const Scene scene = scene_of(R"(
DEF T TimeSensor { loop TRUE }
DEF I PositionInterpolator { key [0 1] keyValue [1 1 1, 2 1 1] }
DEF GROWS Transform { enslaved TRUE children DEF IN Transform { enslaved TRUE children Shape { geometry Box { } } } }
ROUTE T.fraction_changed TO I.set_fraction
ROUTE I.value_changed TO GROWS.set_scale)");
  EXPECT_THAT(paths(scene, movers_of(scene)), ElementsAre());
}

}  // namespace peerd::view::movers_test
