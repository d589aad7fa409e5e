#include "core/motion/carriers.hpp"

#include <gmock/gmock.h>

#include "tests/core/read_text.hpp"

namespace peerd::carriers_test {

const std::string kTurn = R"(
DEF T TimeSensor { cycleInterval 4 loop TRUE }
DEF O OrientationInterpolator { key [ 0 0.5 1 ] keyValue [ 0 1 0 0, 0 1 0 3, 0 1 0 6 ] }
DEF P PositionInterpolator { key [ 0 1 ] keyValue [ 1 1 1, 2 2 2 ] }
ROUTE T.fraction_changed TO O.set_fraction
ROUTE T.fraction_changed TO P.set_fraction
)";

struct Carried {
  explicit Carried(const std::string& text, std::vector<const char*> movable = {}) : scene(scene_of(text)) {
    PredefinedMotion motion(scene);
    std::vector<ObjectId> ids;
    for (const char* path : movable) ids.push_back(id(path));
    carriers.emplace(scene, motion, ids);
  }
  [[nodiscard]] ObjectId id(const char* path) const { return scene.find(path).value(); }
  [[nodiscard]] std::string above(const char* path) const {
    const auto carrier = carriers->above(id(path));
    return carrier ? scene.path_of(*carrier) : "";
  }

  Scene scene;
  std::optional<Carriers> carriers;
};

TEST(Carriers, AreWhatRoutesVelocitiesAndOwnersMove) {
  const Carried c(
      "DEF WORLD Group { children [ DEF BUS Transform { children [ DEF SEAT Transform { }"
      "DEF DOOR Transform { velocityVector 0 0 1 children DEF HANDLE Transform { } } ] }"
      "DEF FAN Transform { } DEF WALL Transform { } ] }" +
          kTurn + "ROUTE O.value_changed TO FAN.set_rotation",
      {"WORLD/BUS"});
  EXPECT_TRUE(c.carriers->contains(c.id("BUS")));
  EXPECT_TRUE(c.carriers->contains(c.id("DOOR")));
  EXPECT_TRUE(c.carriers->contains(c.id("FAN")));
  for (const char* still : {"WORLD", "SEAT", "HANDLE", "WALL"}) EXPECT_FALSE(c.carriers->contains(c.id(still)));
  EXPECT_EQ(c.above("WALL"), "");
  EXPECT_EQ(c.above("BUS"), "");
  EXPECT_EQ(c.above("SEAT"), "WORLD/BUS");
  EXPECT_EQ(c.above("DOOR"), "WORLD/BUS");
  EXPECT_EQ(c.above("HANDLE"), "WORLD/BUS/DOOR");
}

TEST(Carriers, AreNeverDistorted) {
  const Carried c(
      "DEF GROWS Transform { children DEF INSIDE Transform { velocityVector 1 0 0 } }"
      "DEF UNEVEN Transform { scale 1 2 1 children [ DEF SLIDES Transform { velocityVector 1 0 0 }"
      "DEF TURNS Transform { children DEF LEAF Shape { } } ] }"
      "DEF EVEN Transform { scale -2 -2 -2 children DEF TURNS2 Transform { } }"
      "DEF ARM Transform { scale 1 2 -1 children DEF HAND Transform { } }" +
      kTurn +
      "ROUTE P.value_changed TO GROWS.set_scale ROUTE O.value_changed TO TURNS.set_rotation "
      "ROUTE O.value_changed TO TURNS2.set_rotation ROUTE O.value_changed TO ARM.set_rotation");
  for (const char* path : {"GROWS", "INSIDE", "TURNS", "LEAF"}) {
    EXPECT_TRUE(c.carriers->distorted(c.id(path))) << path;
    EXPECT_FALSE(c.carriers->contains(c.id(path))) << path;
  }
  for (const char* path : {"SLIDES", "TURNS2", "ARM"}) {
    EXPECT_FALSE(c.carriers->distorted(c.id(path))) << path;
    EXPECT_TRUE(c.carriers->contains(c.id(path))) << path;
  }
  EXPECT_FALSE(c.carriers->distorted(c.id("HAND"))) << "its own scale goes along when the arm turns";
}

}  // namespace peerd::carriers_test
