#include "peerd/peer/config/resolve.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"
#include "tests/peerd/peer/config/scenario_text.hpp"

namespace peerd::config::resolve_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF CAR_B Transform { translation 1 0 0 }
DEF CAR_A Transform { translation 2 0 0 rotation 0 1 0 1 }
DEF VAN Transform { translation 3 0 0 }
DEF CAR_C Transform { translation 4 0 0 }
DEF ROCK Transform { translation 99 0 0 }
)";
constexpr ObjectId kCarB{0}, kCarA{1}, kVan{2}, kCarC{3};

class ResolveTest : public testing_support::ScenarioText {
 protected:
  ResolveTest() : ScenarioText("world = \"w.wrl\"\nduration_s = 10\n") { folder.write("w.wrl", kWorld); }
  Result<std::vector<PeerObjects>> resolved(const std::string& text, std::vector<std::string> sets = {}) {
    const auto scenario = result(text, std::move(sets));
    if (!scenario) return std::unexpected(scenario.error());
    const auto world = load_world(scenario->world);
    if (!world) return std::unexpected(world.error());
    return resolve(scenario->runs.front(), world->scene);
  }
  std::vector<PeerObjects> peers(const std::string& text, std::vector<std::string> sets = {}) {
    return must(resolved(text, std::move(sets)));
  }
  std::string error(const std::string& text) {
    const auto objects = resolved(text);
    if (objects) return "accepted";
    EXPECT_EQ(objects.error().exit_code, 2);
    return objects.error().text;
  }
  std::vector<std::string> warnings(const std::string& text) {
    const Scenario scenario = read(text);
    return settings_without_effect(scenario.runs.front(), load_world(scenario.world)->scene);
  }
};

std::vector<ObjectId> moved(const PeerObjects& peer) {
  std::vector<ObjectId> objects;
  for (const auto& [object, motion] : peer.motions) objects.push_back(object);
  return objects;
}
double x_at(const PeerObjects& peer, ObjectId object, double t) { return peer.motions.at(object).pose(t).position.x(); }

const std::string kTwo = "[peer.a]\nid = 1\nowns = [\"CAR_*\"]\n[peer.b]\nid = 2\nowns = [\"VAN\"]\n";

TEST_F(ResolveTest, PatternsBecomeObjectsOnceEach) {
  const auto p = peers("[peer.b]\nid = 2\nowns = [\"CAR_C\", \"CAR_?\"]\n[peer.a]\nid = 1\nowns = [\"V*\"]\n");
  ASSERT_EQ(p.size(), 2u);
  EXPECT_THAT(p[0].owned, ElementsAre(kVan)) << "in the order of run.peers, by id";
  EXPECT_THAT(p[1].owned, ElementsAre(kCarC, kCarB, kCarA)) << "in the order of the settings, then of the world";
  EXPECT_THAT(moved(p[1]), IsEmpty());
}

TEST_F(ResolveTest, WhoRunsAnObjectDrivesItAndCountsThemAll) {
  const auto p = peers(
      "[peer.a]\nid = 1\nowns = [\"CAR_A\"]\n[peer.b]\nid = 2\nowns = [\"CAR_C\", \"VAN\"]\n"
      "[motion.\"CAR_*\"]\nx = \"100*n + t\"\n");
  EXPECT_THAT(moved(p[0]), ElementsAre(kCarA));
  EXPECT_THAT(moved(p[1]), ElementsAre(kCarC));
  EXPECT_EQ(x_at(p[0], kCarA, 7.0), 107.0) << "CAR_B, which nobody runs, is number 0";
  EXPECT_EQ(x_at(p[1], kCarC, 7.0), 207.0);
}

TEST_F(ResolveTest, APeersOwnMotionComesFirst) {
  const auto p = peers(kTwo + "[motion.\"*\"]\nx = \"n\"\n[peer.a.motion.CAR_A]\nx = \"-7\"\n");
  EXPECT_EQ(x_at(p[0], kCarA, 0.0), -7.0);
  EXPECT_EQ(x_at(p[0], kCarC, 0.0), 3.0) << "still the fourth of all";
  EXPECT_EQ(x_at(p[1], kVan, 0.0), 2.0);
}

TEST_F(ResolveTest, APeersPatternMovesWhatThatPeerRuns) {
  const auto p = peers(
      "[peer.a]\nid = 1\nowns = [\"CAR_A\"]\n[peer.b]\nid = 2\nowns = [\"CAR_C\"]\n"
      "[peer.a.motion.\"CAR_*\"]\nx = \"n\"\n");
  EXPECT_THAT(moved(p[0]), ElementsAre(kCarA));
  EXPECT_THAT(moved(p[1]), IsEmpty());
}

TEST_F(ResolveTest, PathsKeepTheWorldsOrientationUnlessTheyFaceForward) {
  const auto at = [&](const std::string& more) {
    const auto p = peers(kTwo + "[motion.CAR_A]\nwaypoints = [[0, 0, 0, 0], [5, 0, 0, 10]]\n" + more);
    return p[0].motions.at(kCarA).sample(1.0);
  };
  EXPECT_LT(angle_between(at("").orientation, Quat(Eigen::AngleAxisd(1.0, Vec3::UnitY()))), 1e-6);
  EXPECT_TRUE(at("").angular_velocity_body.isZero(1e-12));
  EXPECT_LT((at("face_forward = true").orientation * Vec3(0, 0, -1) - Vec3(0, 0, 1)).norm(), 1e-12);
}

TEST_F(ResolveTest, HeldUntilTheStart) {
  const std::string walk = kTwo + "[motion.\"CAR_*\"]\nwalk = {within_m = [-9, -9, 9, 9]}\n";
  EXPECT_FALSE(peers(walk)[0].motions.at(kCarA).sample(-1.0).velocity.isZero(0.0)) << "under way";
  const auto p = peers(walk + "before_start = \"hold\"\n");
  EXPECT_EQ(x_at(p[0], kCarA, 0.0), 2.0) << "from its place in the world, at t = 0";
  EXPECT_TRUE(p[0].motions.at(kCarA).sample(-1.0).velocity.isZero(0.0));
  EXPECT_FALSE(p[0].motions.at(kCarA).sample(0.0).velocity.isZero(0.0));
  const auto way = peers(kTwo + "[motion.VAN]\nwaypoints = [[-4, 0, 0, 0], [4, 8, 0, 0]]\nbefore_start = \"hold\"\n");
  EXPECT_EQ(x_at(way[1], kVan, -2.0), 4.0) << "where the way is at t = 0";
  EXPECT_TRUE(way[1].motions.at(kVan).sample(-2.0).velocity.isZero(0.0));
  EXPECT_EQ(way[1].motions.at(kVan).sample(-2.0).position.x(), 4.0);
}

TEST_F(ResolveTest, RandomMotionsFollowTheScenariosSeedOrTheirOwn) {
  const auto x = [&](const std::string& seed, std::vector<std::string> sets) {
    const auto p = peers(kTwo + "[motion.\"CAR_*\".walk]\nwithin_m = [-9, -9, 9, 9]\n" + seed, std::move(sets));
    return x_at(p[0], kCarA, 9.0);
  };
  EXPECT_EQ(x("", {}), x("", {"seed=1"}));
  EXPECT_NE(x("", {}), x("", {"seed=2"}));
  EXPECT_EQ(x("seed = 5", {}), x("seed = 5", {"seed=2"}));
  EXPECT_NE(x("seed = 5", {}), x("", {}));
}

// All of a pattern fly together, also where one peer runs only some of them.
TEST_F(ResolveTest, AFlockIsOneWhoeverRunsItsBirds) {
  const std::string flock = "[motion.\"CAR_*\".flock]\nwithin_m = [0, 0, 0, 90, 90, 90]\n";
  const auto one = peers(kTwo + flock);
  const auto two = peers("[peer.a]\nid = 1\nowns = [\"CAR_A\"]\n[peer.b]\nid = 2\nowns = [\"CAR_C\"]\n" + flock);
  for (const double t : {0.0, 3.3, 9.9}) {
    EXPECT_EQ(x_at(one[0], kCarA, t), x_at(two[0], kCarA, t));
    EXPECT_EQ(x_at(one[0], kCarC, t), x_at(two[1], kCarC, t));
  }
}

TEST_F(ResolveTest, ATrackLiesBesideTheScenario) {
  folder.write("way.csv", "t,x,y,z\n0,5,0,0\n2,9,0,0\n");
  EXPECT_NEAR(x_at(peers(kTwo + "[motion.VAN]\ntrack = \"way.csv\"\n")[1], kVan, 1.0), 7.0, 1e-12);
  EXPECT_THAT(error(kTwo + "[motion.VAN]\ntrack = \"none.csv\"\n"),
              HasSubstr("none.csv: error: there is no such file"));
}

TEST_F(ResolveTest, ErrorsHaveTheirPlaces) {
  const std::string file = (folder / "my.toml").string();
  EXPECT_THAT(error("[peer.a]\nid = 1\nowns = [\"CAR_A\",\n\"BUS_*\"]"),
              testing::StartsWith(file + ":6:1: error: peer.a.owns: no object of the world is called like"));
  EXPECT_THAT(error(kTwo + "[motion.\"BUS_*\"]\n"), HasSubstr(file + ":9:1: error: motion.BUS_*: no object"));
  EXPECT_THAT(error(kTwo + "[peer.c]\nid = 3\nowns = [\"*_A\"]"),
              HasSubstr(file + ":11:9: error: peer.c.owns: peer a owns \"CAR_A\" too"));
  EXPECT_THAT(error(kTwo + "[motion.\"CAR_*\"]\n[motion.\"*_A\"]\n"),
              HasSubstr("\"CAR_A\" is moved by motion.*_A too"));
  EXPECT_THAT(error(kTwo + "[peer.a.motion.\"CAR_*\"]\n[peer.a.motion.CAR_A]\n"), HasSubstr("moved by"));
  EXPECT_THAT(error(kTwo + "[peer.a.motion.VAN]\n"),
              HasSubstr(file + ":9:1: error: peer.a.motion.VAN: the peer moves only what it owns; add \"VAN\" to "
                               "peer.a.owns"));
  EXPECT_THAT(error(kTwo + "[motion.\"CAR_*\"]\nx = \"sin(\"\n"),
              HasSubstr(file + ":9:1: error: motion.CAR_*: formula \"sin(\""));
  EXPECT_THAT(error(kTwo + "[motion.\"CAR_*\"]\nwalk = {within_m = [50, 50, 60, 60]}\n"),
              HasSubstr("object number 0 must stand at least 1 m inside of within_m"));
  EXPECT_THAT(error(kTwo + "[peer.a.viewpoint]\nobject = \"VAM\"\n"), HasSubstr("did you mean \"VAN\"?"));
}

TEST_F(ResolveTest, ViewsRideOnWhatTheyName) {
  const auto p = peers(kTwo + "[[peer.b.view]]\nobject = \"CAR_A\"\n[[peer.b.view]]\nfar_m = 9\n");
  EXPECT_THAT(p[1].views, ElementsAre(std::optional(kCarA), std::nullopt));
  EXPECT_THAT(error(kTwo + "[[peer.a.view]]\nobject = \"VAM\"\n"), HasSubstr("did you mean \"VAN\"?"));
}

TEST_F(ResolveTest, WhoSkipsTheUnseenNeedsAView) {
  const std::string skips = kTwo + "skip_unseen = true\n";
  EXPECT_THAT(error(skips), HasSubstr("peer.b.skip_unseen: the peer has no viewpoint"));
  EXPECT_TRUE(resolved(skips + "[peer.b.viewpoint]\n").has_value());
  EXPECT_TRUE(resolved(skips + "[[peer.b.view]]\n").has_value());
  folder.write("w.wrl", std::string(kWorld) + "Viewpoint { }\n");
  EXPECT_TRUE(resolved(skips).has_value()) << "the world's";
}

TEST_F(ResolveTest, ARandomMotionOfHoursIsRefused) {
  EXPECT_THAT(error_of(resolved(kTwo + "[motion.VAN]\ndrive = {}\n", {"duration_s=3601"})).text,
              HasSubstr("motion.VAN: such a motion is made before the run, so for 3600 s at most"));
}

TEST_F(ResolveTest, AProgramOutsideCallsThemAsTheSettingsDo) {
  const auto all = peers(kTwo + "[motion.\"CAR_*\"]\noutside = true\n[peer.a.motion.CAR_A]\nx = \"t\"\n");
  EXPECT_EQ(all[0].outside, (std::map<std::string, ObjectId>{{"CAR_B", kCarB}, {"CAR_C", kCarC}}));
  EXPECT_EQ(moved(all[0]), std::vector{kCarA}) << "a peer's own motion comes first";
  EXPECT_TRUE(all[1].outside.empty());
}

TEST_F(ResolveTest, FormulasThatMoveNothingAreParsedToo) {
  const std::string own = kTwo + "[peer.a.motion.CAR_A]\nx = \"t\"\n";
  EXPECT_THAT(error(own + "[motion.CAR_A]\nx = \"sin(t\"\n"), HasSubstr("motion.CAR_A: formula \"sin(t\": "));
  EXPECT_THAT(error(own + "[motion.ROCK]\nx = \"sin(t\"\n"), HasSubstr("motion.ROCK: formula \"sin(t\": "));
  EXPECT_THAT(error(own + "[motion.ROCK]\ntrack = \"none.csv\"\n"),
              HasSubstr("none.csv: error: there is no such file"));
}

TEST_F(ResolveTest, MotionsWithoutEffectAreNamed) {
  const std::string own = kTwo + "[peer.a.motion.CAR_A]\nx = \"t\"\n";
  EXPECT_THAT(warnings(own + "[motion.ROCK]\nx = \"t\"\n"),
              ElementsAre(HasSubstr("my.toml:11:1: warning: motion.ROCK has no effect: no peer owns what it names")));
  EXPECT_THAT(warnings(own + "[motion.CAR_A]\nx = \"t\"\n"),
              ElementsAre(HasSubstr("motion.CAR_A has no effect: peer.a.motion.CAR_A comes first")));
  EXPECT_THAT(warnings(own + "[motion.\"CAR_*\"]\nx = \"t\"\n"), IsEmpty()) << "it moves the others";
  EXPECT_THAT(warnings(own), IsEmpty());
}

TEST_F(ResolveTest, OwnedNodesThatNobodyMovesAreNamed) {
  folder.write("w.wrl",
               "#VRML V2.0 utf8\nDEF T TimeSensor { } DEF P PositionInterpolator { key 0 keyValue 0 0 0 }\n"
               "DEF LIFT Transform { } DEF BALLOON Transform { children DEF BASKET Transform { } }\n"
               "ROUTE T.fraction_changed TO P.set_fraction ROUTE P.value_changed TO LIFT.translation\n"
               "ROUTE P.value_changed TO BALLOON.scale\n");
  const std::string own = "[peer.a]\nid = 1\nowns = [\"LIFT\", \"BASKET\"]\n";
  EXPECT_THAT(warnings(own), ElementsAre(HasSubstr("my.toml:5:9: warning: peer.a.owns: \"LIFT\" stands still: a ROUTE"),
                                         HasSubstr("my.toml:5:17: warning: peer.a.owns: \"BALLOON/BASKET\" stays")));
  EXPECT_THAT(warnings(own + "[motion.LIFT]\nx = \"t\"\n"), ElementsAre(HasSubstr("BASKET")));
}

TEST_F(ResolveTest, PathsThatHaveQuotesStandInSingleOnes) {
  folder.write("w.wrl", "v 0 0 0\nv 1 0 0\nv 0 1 0\no left arm\nf 1 2 3\n");  // an OBJ file, whatever its name
  EXPECT_THAT(error("[peer.a]\nid = 1\nowns = [\"left arm\"]\n[peer.b]\nid = 2\nowns = [\"left arm\"]\n"),
              HasSubstr("peer.b.owns: peer a owns '\"left arm\"' too"));
  EXPECT_THAT(error("[peer.a]\nid = 1\nowns = [\"\\\"left arm\\\"/hand\"]\n"),
              HasSubstr("the world has no object '\"left arm\"/hand'"));
}

class FounderTest : public ResolveTest {
 protected:
  FounderTest() {
    folder.write("w.wrl",
                 "#VRML V2.0 utf8\nDEF CAR_B Transform { enslaved TRUE }\nDEF CAR_A Transform { }\n"
                 "DEF VAN Transform { enslaved TRUE }\n");
  }
};

TEST_F(FounderTest, IsTheLowestIdOfThoseThatBeginTogether) {
  const auto p = peers(
      "[peer.a]\nid = 3\n[peer.b]\nid = 2\n[peer.c]\nid = 1\n"
      "[event.late]\nat_s = 2\nkind = \"join\"\npeer = \"c\"\n");
  ASSERT_EQ(p.size(), 3u) << "by id";
  EXPECT_THAT(p[0].owned, IsEmpty()) << "it comes late";
  EXPECT_THAT(p[1].owned, ElementsAre(kCarB, kVan));
  EXPECT_THAT(p[2].owned, IsEmpty());
  EXPECT_THAT(p[1].owned_by_founder, IsEmpty()) << "all peers know it from the configuration";
}

TEST_F(FounderTest, SettingsThatNameAnOwnerComeFirst) {
  const auto p = peers("[peer.a]\nid = 1\n[peer.b]\nid = 2\nowns = [\"CAR_*\"]\n");
  EXPECT_THAT(p[0].owned, ElementsAre(kVan));
  EXPECT_THAT(p[1].owned, ElementsAre(kCarB, kCarA));
}

TEST_F(FounderTest, APeerOfItsOwnConfigurationHasToSee) {
  const auto p = peers("[peer.a]\nid = 1\nowns = [\"CAR_*\"]\n[motion.VAN]\nx = \"t\"\n");
  EXPECT_THAT(p[0].owned, ElementsAre(kCarB, kCarA));
  EXPECT_THAT(p[0].owned_by_founder, ElementsAre(kVan));
  EXPECT_EQ(x_at(p[0], kVan, 7.0), 7.0) << "it moves what it may come to own";
}

TEST_F(FounderTest, AMotionOfWhatItOwnsHasAnEffect) {
  EXPECT_THAT(warnings("[peer.a]\nid = 1\n[peer.b]\nid = 2\n"
                       "[motion.VAN]\nx = \"t\"\n[motion.CAR_A]\nx = \"t\"\n"),
              ElementsAre(HasSubstr("motion.CAR_A has no effect")));
}

// The objects that any peer of any run owns, whatever else it names.
TEST_F(ResolveTest, KnowsWhatIsOwnedInAllRuns) {
  std::vector<RunSettings> runs = read(kTwo + "[peer.c]\nid = 3\nowns = [\"ROCKET\", \"VA*\"]\n").runs;
  const auto world = must(load_world(folder / "w.wrl"));
  EXPECT_THAT(owned_in(runs, world.scene), ElementsAre(kCarB, kCarA, kVan, kCarC));
  runs.push_back(read("[peer.a]\nid = 1\nowns = [\"ROCK\"]\n").runs.front());
  EXPECT_THAT(owned_in(runs, world.scene), ElementsAre(kCarB, kCarA, kVan, kCarC, ObjectId{4}));
  EXPECT_THAT(owned_in({}, world.scene), IsEmpty());
}

}  // namespace peerd::config::resolve_test
