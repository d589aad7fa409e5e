// The rows of contacts say with which polygons the two touch, as peerd collide does at their times.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "collision/scene/scene_query.hpp"
#include "core/motion/scene_motion.hpp"
#include "core/scene/reader.hpp"
#include "tests/peerd/scratch_folder.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::contact_rows_test {

using measure::ContactRow;
using peerd::testing_support::ScratchFolder;
using testing_support::Ran;
using testing_support::run_scenario;

std::string box(const std::string& name, const std::string& size, const std::string& at, const std::string& fields = "",
                const std::string& children = "") {
  return "DEF " + name + " Transform { translation " + at + " " + fields + " children [ Shape { geometry Box { size " +
         size + " } } " + children + "] }\n";
}
std::string all_pairs(const std::string& collider, const std::string& collidee) {
  return "CollisionInterest { objectPath \"" + collider + "\" interests [ \"" + collidee + "\" ] collisionType 2 }\n";
}

const std::string kFlyer =
    box("FLYER", "1 1 1", "0 0 0", "velocityVector 2 0 0") + box("WALL", "1 4 4", "5 0 0") + all_pairs("FLYER", "WALL");
const std::string kTilted = box("FLYER", "1 1 1", "0 0 0", "velocityVector 1.7 0 0 rotation 0.3 0.5 0.7 0.9") +
                            box("WALL", "1 4 4", "5 0 0") + all_pairs("FLYER", "WALL");
const std::string kWheel = box("CAR", "4 1 2", "0 2 0", "velocityVector 3 0 0", box("WHEEL", "1 1 0.4", "1 -1 0")) +
                           box("CURB", "0.5 0.6 4", "8.1 0.5 0") + all_pairs("CAR", "CURB");
const std::string kArm = "DEF ARM Transform { scale 1 2 -1 children " + box("HAND", "0.5 0.5 0.5", "3 0.2 0.5") +
                         "}\n" + box("BALL", "0.6 0.6 0.6", "0 0.4 3") +
                         R"(DEF CLOCK TimeSensor { cycleInterval 4 loop TRUE }
DEF ROUND OrientationInterpolator { key [ 0 0.25 0.5 0.75 1 ] keyValue [ 0 1 0 0, 0 1 0 1.5707963,
0 1 0 3.1415926, 0 1 0 4.712389, 0 1 0 6.2831853 ] }
ROUTE CLOCK.fraction_changed TO ROUND.set_fraction ROUTE ROUND.value_changed TO ARM.set_rotation
)" + all_pairs("ARM", "BALL");
const std::string kGrows = box("GROWS", "1 1 1", "0 0 0") + box("WALL", "1 4 4", "1.6 0 0") +
                           R"(DEF CLOCK TimeSensor { cycleInterval 4 loop TRUE }
DEF WIDE PositionInterpolator { key [ 0 0.5 1 ] keyValue [ 1 1 1, 4 1 1, 1 1 1 ] }
ROUTE CLOCK.fraction_changed TO WIDE.set_fraction ROUTE WIDE.value_changed TO GROWS.set_scale
)" + all_pairs("GROWS", "WALL");

struct Case {
  const char* name;
  std::string world;
  std::vector<std::string> owned;  // by each peer, one
};
class Rows : public testing::TestWithParam<Case> {
 protected:
  Rows() {
    const std::string text = "#VRML V2.0 utf8\n" + GetParam().world;
    folder_.write("w.wrl", text);
    scene = read_world(text).scene.value();
    std::string scenario = "world = \"w.wrl\"\nduration_s = 4\n[network]\nlatency_ms = 50\n";
    for (std::size_t i = 0; i < 2; ++i) {
      scenario +=
          "[peer." + std::string(1, static_cast<char>('a' + i)) + "]\nid = " + std::to_string(i + 1) + "\nowns = [";
      if (i < GetParam().owned.size()) scenario += "\"" + GetParam().owned[i] + "\"";
      scenario += "]\n";
    }
    rows = run_scenario(folder_.write("s.toml", scenario)).front().record.contacts;
  }
  std::vector<ShapePair> collide(const ContactRow& row, double t_s) const {
    collision::SceneQuery query(scene);
    SceneMotion motion(scene);
    query.set_transforms(motion.transforms_at(t_s));
    for (SceneMotion::MovedGeometry& moved : motion.moved_geometries(t_s)) query.reshape(moved.index, moved.form);
    return query.collide(row.collider, row.collidee, CollisionType::kAllPairs).value().pairs;
  }
  // What collide finds first, from the time of the row on.
  std::vector<ShapePair> soon(const ContactRow& row) const {
    for (int i = 0; i <= 200; ++i) {
      if (auto found = collide(row, row.t_s + i * 1e-7); !found.empty()) return found;
    }
    return {};
  }

  Scene scene;
  std::vector<ContactRow> rows;

 private:
  ScratchFolder folder_;
};

TEST_P(Rows, SayTheTypeAndTouchingPolygons) {
  ASSERT_FALSE(rows.empty());
  std::set<PeerId> peers;
  for (const ContactRow& row : rows) {
    peers.insert(row.peer);
    EXPECT_EQ(row.type, CollisionType::kAllPairs);
    EXPECT_GT(row.polygons.count, 0u) << row.kind;
    EXPECT_EQ(row.polygons.count, row.polygons.pairs.size());
    EXPECT_TRUE(std::ranges::is_sorted(row.polygons.pairs));
  }
  EXPECT_EQ(peers.size(), 2u);
}

// What another peer owns is known from updates, which are rounded: only rows of what the peer itself owns, or the world
// moves, are compared.
TEST_P(Rows, HoldWhatCollideFindsThere) {
  std::size_t compared = 0;
  for (const ContactRow& row : rows) {
    if (row.kind != "owner" && row.kind != "scene") continue;
    ++compared;
    const auto first = soon(row);
    EXPECT_FALSE(first.empty()) << row.t_s << " s is too early by 20 us";
    for (const ShapePair& pair : first) {
      EXPECT_THAT(row.polygons.pairs, testing::Contains(pair))
          << scene.path_of(pair.collider.shape) << ' ' << pair.collider.polygon << " - "
          << scene.path_of(pair.collidee.shape) << ' ' << pair.collidee.polygon << " at " << row.t_s << " s";
    }
    EXPECT_LE(row.polygons.pairs.size(), 25u) << "and not much else: two boxes have at most 36 pairs";
  }
  EXPECT_GT(compared, 0u);
}

INSTANTIATE_TEST_SUITE_P(Table, Rows,
                         testing::Values(Case{"FlyerOfNobody", kFlyer, {}}, Case{"OwnedFlyer", kFlyer, {"FLYER"}},
                                         Case{"TiltedOfNobody", kTilted, {}}, Case{"OwnedTilted", kTilted, {"FLYER"}},
                                         Case{"WheelOfNobody", kWheel, {}}, Case{"WheelOfAnOwnedCar", kWheel, {"CAR"}},
                                         Case{"ArmOfNobody", kArm, {}}, Case{"ArmAndOwnedBall", kArm, {"BALL"}},
                                         Case{"GrowsOfNobody", kGrows, {}},
                                         Case{"GrowsAgainstAnOwnedWall", kGrows, {"WALL"}}),
                         [](const auto& test) { return std::string(test.param.name); });

// Between two owners: the decider's row, and that of the other one by what the decider has published.
class Decided : public Rows {};
TEST_P(Decided, SayTheTypeAndTouchingPolygonsOnBothPeers) {
  std::set<std::string> kinds;
  for (const ContactRow& row : rows) {
    kinds.insert(row.kind);
    EXPECT_EQ(row.type, CollisionType::kAllPairs);
    EXPECT_GT(row.polygons.count, 0u) << row.kind;
  }
  EXPECT_THAT(kinds, testing::IsSupersetOf({"decided", "applied"}));
}
INSTANTIATE_TEST_SUITE_P(Table, Decided,
                         testing::Values(Case{"FlyerAndWall", kFlyer, {"FLYER", "WALL"}},
                                         Case{"CurbAndCar", kWheel, {"CURB", "CAR"}}),
                         [](const auto& test) { return std::string(test.param.name); });

// The face is in that of the wall at 2 s, and nothing of that is rounded.
class ExactRows : public Rows {};
TEST_P(ExactRows, AreThoseOfCollide) {
  ASSERT_FALSE(rows.empty());
  for (const ContactRow& row : rows) {
    ASSERT_EQ(row.t_s, 2.0);
    EXPECT_EQ(row.polygons.pairs, collide(row, row.t_s));
  }
}
INSTANTIATE_TEST_SUITE_P(Table, ExactRows, testing::Values(Case{"FlyerOfNobody", kFlyer, {}}),
                         [](const auto& test) { return std::string(test.param.name); });

}  // namespace peerd::sim::contact_rows_test
