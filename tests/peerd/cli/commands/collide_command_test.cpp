#include "peerd/cli/commands/collide_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <tuple>

#include <nlohmann/json.hpp>

#include "tests/has_members.hpp"
#include "tests/peerd/cli/outcome.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::collide_command_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing_support::keys_of;
using testing_support::Outcome;
using testing_support::outcome_of;
using testing_support::ScratchFolder;
using Json = nlohmann::ordered_json;

constexpr std::string_view kHeader = "#VRML V2.0 utf8\n";

Outcome watch(const std::filesystem::path& world, const CollideOptions& options) {
  return outcome_of([&](auto& out, auto& err) { return run_collide(world.string(), options, out, err); });
}
Outcome collide(const std::filesystem::path& world, double at_s = 0.0, bool json = true) {
  return watch(world, {.json = json, .at_s = at_s});
}
std::filesystem::path write(const ScratchFolder& folder, std::string_view body) {
  return folder.write("world.wrl", std::string(kHeader) + std::string(body));
}

// Two unit squares that share the corner (1, 1, 0), and one far off.
constexpr std::string_view kSquares = R"(
DEF A Transform { children DEF SA Shape { geometry IndexedFaceSet {
  coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 1 0 ] } coordIndex [ 0 1 2 3 -1 ] } } }
DEF B Transform { translation 1 1 0 children Shape { geometry IndexedFaceSet {
  coord Coordinate { point [ 0 0 0, 1 0 0, 1 1 0, 0 0 1 ] } coordIndex [ 3 1 2 -1 0 1 2 -1 ] } } }
DEF C Transform { translation 9 0 0 children Shape { geometry Box {} } }
)";

TEST(Collide, NamesWhatDoesNothing) {
  const ScratchFolder folder;
  const Outcome outcome = collide(write(folder,
                                        "DEF CAR Transform { children Shape { geometry Box { } } }\nDEF CLOCK "
                                        "TimeSensor { }\nROUTE CAR.notColliding TO CLOCK.enabled\n"));
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.err, HasSubstr("world.wrl:4:11: warning: no peer runs this ROUTE from notColliding"));
}

TEST(Collide, JsonIsAsItIsPromised) {
  const ScratchFolder folder;
  const Outcome outcome = collide(write(folder, std::string(kSquares) + R"(
    CollisionInterest { objectPath "A" interests [ "B" "C" ] collisionType 2 }
    CollisionInterest { objectPath "B" interests "A" collisionType 1 }
    CollisionInterest { objectPath "A" interests "B" }
  )"));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json json = outcome.json();
  EXPECT_THAT(keys_of(json), ElementsAre("world", "time_s", "interests", "counters", "micros"));
  EXPECT_THAT(keys_of(json["counters"]),
              ElementsAre("hierarchies_built", "nodes_built", "bv_tests", "polygon_tests", "exact_tests"));
  ASSERT_EQ(json["interests"].size(), 4u);
  EXPECT_EQ(json["interests"][0],
            Json::parse(R"({"collider": "A", "collidee": "B", "type": "allpairs", "colliding": true,
    "pairs": [{"a": ["A/SA", 0], "b": ["B/0", 1]}]})"));
  EXPECT_EQ(json["interests"][1],
            Json::parse(R"({"collider": "A", "collidee": "C", "type": "allpairs", "colliding": false,
    "pairs": []})"));
  EXPECT_EQ(json["interests"][2],
            Json::parse(R"({"collider": "B", "collidee": "A", "type": "witness", "colliding": true,
    "pairs": [{"a": ["B/0", 1], "b": ["A/SA", 0]}]})"));
  EXPECT_EQ(json["interests"][3], Json::parse(R"({"collider": "A", "collidee": "B", "type": "box", "colliding": true,
    "pairs": []})"));
  EXPECT_THAT(collide(folder.path() / "world.wrl", 0.0, false).out, HasSubstr("A - B (allpairs): colliding, 1 pair"));
}

// The boxes of their vertices are apart, the thesis's overlap.
TEST(Collide, BoxesCanBeTheLargerOnesOfTheThesis) {
  const ScratchFolder folder;
  const auto world = write(folder, R"(
    DEF A Transform { rotation 1 1 0.3 0.7 children Shape { geometry Sphere { } } }
    DEF B Transform { rotation 0.2 1 0.5 0.4 translation 2.03 0 0 children Shape { geometry Sphere { } } }
    CollisionInterest { objectPath "A" interests "B" }
  )");
  for (const bool realigned : {false, true}) {
    const Outcome outcome = watch(world, {.json = true, .realigned_boxes = realigned});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.json()["interests"][0]["colliding"], realigned);
  }
}

// 2^-20 m at 10^6 m is no more than at the origin.
TEST(Collide, FarFromTheOriginIsAsAtTheOrigin) {
  const ScratchFolder folder;
  for (const char* const at : {"0", "1000000", "-1048576"}) {
    for (const auto& [gap, colliding] : {std::pair("0", true), {"0.00000095367431640625", false}}) {
      const std::string world = std::string("DEF A Transform { translation ") + at +
                                " 0 0 children Shape { geometry Box {} } } Transform { translation " + at +
                                " 0 0 children DEF B Transform { translation 2 0 0 children Transform { translation " +
                                gap +
                                " 0 0 children Shape { geometry Box {} } } } }"
                                "CollisionInterest { objectPath \"A\" interests \"B\" collisionType 1 }";
      EXPECT_EQ(collide(write(folder, world)).json()["interests"][0]["colliding"], colliding) << at << ' ' << gap;
    }
  }
}

// B meets A at 8 s and leaves it at 12 s; C falls on A from 8 s to 10 s, where it still is at the end of the cycle. D
// is a Shape: no eventOut.
constexpr std::string_view kMoving = R"(
    DEF A Transform { children Shape { geometry Box {} } }
    DEF B Transform { translation 10 0 0 velocityVector -1 0 0 children DEF D Shape { geometry Box {} } }
    DEF C Transform { children Shape { geometry Box {} } }
    DEF T TimeSensor { cycleInterval 10 loop TRUE startTime 0 }
    DEF P PositionInterpolator { key [ 0 1 ] keyValue [ 0 10 0, 0 0 0 ] }
    ROUTE T.fraction_changed TO P.set_fraction
    ROUTE P.value_changed TO C.set_translation
    CollisionInterest { objectPath "A" interests [ "D" "C" ] collisionType 1 })";

TEST(Collide, UntilATimeSaysWhatBeginsAndEnds) {
  const ScratchFolder folder;
  const auto world = write(folder, kMoving);
  const Outcome outcome = watch(world, {.json = true, .at_s = 7.0, .until_s = 12.75, .hz = 4.0});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  const Json json = outcome.json();
  EXPECT_THAT(keys_of(json), ElementsAre("world", "time_s", "until_s", "hz", "ticks", "tick_micros", "events",
                                         "counters", "micros", "warnings"));
  EXPECT_EQ(json["ticks"], 24);
  EXPECT_EQ(json["events"], Json::parse(R"([
    {"time_s": 8.0, "event": "began", "collider": "A", "collidee": "B/D", "type": "witness"},
    {"time_s": 8.0, "event": "began", "collider": "A", "collidee": "C", "type": "witness"},
    {"time_s": 8.0, "event": "notColliding", "object": "A", "value": false},
    {"time_s": 8.0, "event": "notColliding", "object": "C", "value": false},
    {"time_s": 10.25, "event": "ended", "collider": "A", "collidee": "C", "type": "witness"},
    {"time_s": 10.25, "event": "notColliding", "object": "C", "value": true},
    {"time_s": 12.25, "event": "ended", "collider": "A", "collidee": "B/D", "type": "witness"},
    {"time_s": 12.25, "event": "notColliding", "object": "A", "value": true}])"));
  const Json& counters = json["counters"];
  EXPECT_EQ(counters["pairs_far"].get<int>() + counters["pairs_unmoved"].get<int>() +
                counters["pairs_separated"].get<int>() + counters["pairs_asked"].get<int>(),
            48);
  EXPECT_GT(counters["pairs_far"], 10);
  EXPECT_THAT(
      watch(world, {.until_s = 8.0}).out,
      HasSubstr("8 s: A - C (witness) began\n8 s: A notColliding FALSE\n8 s: C notColliding FALSE\n481 ticks;"));
}

// The events equal a query at each tick, also for objects that bend.
TEST(Collide, UntilATimeAgreesWithAskingAtEachTime) {
  const ScratchFolder folder;
  const auto world = write(folder, std::string(kMoving) + R"(
    DEF E Shape { geometry IndexedFaceSet { coord DEF F Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] } coordIndex [ 0 1 2 ] } }
    DEF G Transform { translation 0 5 0 children Shape { geometry Box { size 2 2 2 } } }
    DEF Q CoordinateInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 1 0 0, 0 1 0, 0 0 0, 1 0 0, 0 11 0 ] }
    ROUTE T.fraction_changed TO Q.set_fraction
    ROUTE Q.value_changed TO F.set_point
    CollisionInterest { objectPath "E" interests [ "G" "C" ] collisionType 2 })");
  const Json events = watch(world, {.json = true, .until_s = 14.0, .hz = 8.0}).json()["events"];
  std::map<std::string, bool> colliding;
  std::size_t changes = 0, i = 0;
  for (int tick = 0; tick <= 112; ++tick) {
    for (; i < events.size() && events[i]["time_s"] == tick / 8.0; ++i) {
      const Json& event = events[i];
      if (event["event"] == "notColliding") continue;
      colliding[event["collider"].get<std::string>() + event["collidee"].get<std::string>()] =
          event["event"] == "began";
      ++changes;
    }
    const Json now = collide(world, tick / 8.0).json();
    for (const Json& interest : now["interests"]) {
      EXPECT_EQ(interest["colliding"],
                colliding[interest["collider"].get<std::string>() + interest["collidee"].get<std::string>()])
          << tick << interest;
    }
  }
  EXPECT_EQ(i, events.size());
  EXPECT_GT(changes, 8u);
}

TEST(Collide, VerticesBeyondAllMeasureAreRefusedByName) {
  const ScratchFolder folder;
  const auto world = write(folder, R"(
    Transform { scale 1 10 1 children DEF A Shape { geometry IndexedFaceSet {
      coord Coordinate { point [ 0 0 0, 1 0 0, 0 3e38 0 ] } coordIndex [ 0 1 2 ] } } }
    DEF B Shape { geometry Box {} }
    CollisionInterest { objectPath "A" interests "B" collisionType 1 })");
  for (const std::optional<double> until_s : {std::optional<double>(), std::optional(1.0)}) {
    const Outcome outcome = watch(world, {.until_s = until_s});
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.err, HasSubstr("0/A: vertex 2 of polygon 0"));
  }
}

TEST(Collide, WhatDoesNotCollideIsLeftOut) {
  const ScratchFolder folder;
  const Json json = collide(write(folder, R"(
    DEF A Switch { whichChoice 1 choice [ Shape { geometry Box {} } Shape { geometry Box { size 1 1 1 } } ] }
    DEF B Transform { translation 1.2 0 0 children Shape { geometry Box { size 1 1 1 } } }
    CollisionInterest { objectPath "A" interests "B" collisionType 1 })"))
                        .json();
  EXPECT_EQ(json["interests"][0]["colliding"], false);
}

TEST(Collide, AWorldWithErrorsOrNoneIsNoWorld) {
  const ScratchFolder folder;
  EXPECT_EQ(collide(write(folder, "Shape { geometry Bix {} }")).exit_code, 1);
  EXPECT_EQ(collide(folder.path() / "none.wrl").exit_code, 2);
}

TEST(Collide, AnInterruptionLeavesPartialResults) {
  const ScratchFolder folder;
  const auto world = write(folder, kMoving);
  int ticks = 0;
  CollideOptions options{.json = true, .at_s = 7.0, .until_s = 1e9, .hz = 4.0};
  options.interrupted = [&ticks] { return ++ticks > 10; };
  const Outcome outcome = watch(world, options);
  EXPECT_EQ(outcome.exit_code, 130);
  EXPECT_THAT(outcome.err, HasSubstr("interrupted after 10 ticks: the results are partial, none is later than 9.25 s"));
  const Json json = outcome.json();
  EXPECT_EQ(json["ticks"], 10);
  EXPECT_EQ(json["partial"], true);
  EXPECT_FALSE(json["events"].empty());
  ticks = 0;
  options.json = false;
  EXPECT_THAT(watch(world, options).out, HasSubstr("partial: 10 ticks; "));
}

TEST(Collide, TimesWithoutTicksAreWrongUse) {
  const ScratchFolder folder;
  const auto world = write(folder, kMoving);
  const Outcome before = watch(world, {.json = true, .at_s = 1.0, .until_s = 0.5});
  EXPECT_EQ(before.exit_code, 2);
  EXPECT_THAT(before.err, HasSubstr("--until 0.5 is before --at 1"));
  EXPECT_EQ(before.json()["good"], false);
  const Outcome rounded = watch(world, {.at_s = 1e12, .until_s = 1e12 + 1.0, .hz = 1e6});
  EXPECT_EQ(rounded.exit_code, 2);
  EXPECT_THAT(rounded.err, HasSubstr("lost in rounding"));
  EXPECT_THAT(watch(world, {.at_s = 1.0, .until_s = 1.0}).out, HasSubstr("1 tick; "));
}

TEST(Collide, BodiesThatWouldAnswerAreNamedOnce) {
  const ScratchFolder folder;
  const auto world = write(folder, R"(
    DEF BALL Transform { velocityVector 1 0 0 collisionResponse CollisionResponse {} children Shape { geometry Box {} } }
    DEF WALL Transform { translation 5 0 0 children Shape { geometry Box {} } }
    CollisionInterest { objectPath "BALL" interests "WALL" collisionType 1 })");
  const Outcome outcome = watch(world, {.json = true, .until_s = 9.0});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.err, HasSubstr("warning: collide moves things through what they meet, also BALL, with"));
  EXPECT_EQ(outcome.err.find("warning"), outcome.err.rfind("warning"));
  EXPECT_EQ(outcome.json()["warnings"].size(), 1u);
  EXPECT_EQ(watch(write(folder, kMoving), {.until_s = 1.0}).err, "");
}

TEST(Collide, ATerminalShowsHowFarItIs) {
  const ScratchFolder folder;
  const auto world = write(folder, kMoving);
  std::ostringstream terminal;
  // The watch goes on until the first line has come, however long that takes.
  CollideOptions options{.until_s = 1e9, .hz = 1e3};
  options.progress = &terminal;
  options.interrupted = [&terminal] { return !terminal.str().empty(); };
  EXPECT_EQ(watch(world, options).exit_code, 130);
  EXPECT_THAT(terminal.str(), HasSubstr(" s of 1000000000.000 s; about "));
  EXPECT_TRUE(terminal.str().ends_with("\r\033[K")) << "the line is gone in the end";
}

// A tilted plate that turns through a ball's box and, later, the ball.
constexpr std::string_view kTurning = R"(
    DEF A Transform { rotation 0 0 1 0.8 children Shape { geometry Box { size 4 0.2 0.2 } } }
    DEF B Transform { translation 1.3 -0.4 0 children Shape { geometry Sphere { radius 0.5 } } }
    DEF T TimeSensor { cycleInterval 4 loop TRUE startTime 0 }
    DEF R OrientationInterpolator { key [ 0 0.5 1 ] keyValue [ 0 0 1 0.8, 0 0 1 -0.9, 0 0 1 0.8 ] }
    ROUTE T.fraction_changed TO R.set_fraction
    ROUTE R.value_changed TO A.set_rotation
    CollisionInterest { objectPath "A" interests "B" collisionType 1 })";

TEST(Collide, ExactEnginesSayTheSameAndSpheresMore) {
  const ScratchFolder folder;
  const auto turning = folder.write("turning.wrl", std::string(kHeader) + std::string(kTurning));
  const auto events_of = [](const std::filesystem::path& of, const std::string& engine) {
    const Outcome outcome = watch(of, {.json = true, .until_s = 9.0, .hz = 20.0, .engine = engine});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.json().contains("engine"), engine != "ours");
    return outcome.json()["events"];
  };
  const Json ours = events_of(turning, "ours");
  EXPECT_GE(ours.size(), 8u);
  for (const char* engine : {"kdop,k=6", "kdop,k=18,threshold=8", "kdop,realign=hull", "quickcd", "obb", "aabb",
                             "i-collide", "rapid-world"}) {
    EXPECT_EQ(events_of(turning, engine), ours) << engine;
  }
  const Json spheres = events_of(turning, "sphere");
  ASSERT_FALSE(spheres.empty());
  EXPECT_LT(spheres[0]["time_s"], ours[0]["time_s"]) << "near is taken for a touch";
  const Outcome once = watch(turning, {.json = true, .at_s = 2.0, .until_s = 2.0, .engine = "obbb"});
  EXPECT_EQ(once.exit_code, 2);
  EXPECT_THAT(once.err, HasSubstr("did you mean obb?"));
  EXPECT_THAT(watch(turning, {.until_s = 0.0, .engine = "sphere"}).err, HasSubstr("is not exact"));
}

// The ticks at which spheres are taken for a touch and the triangles are not are counted one by one.
TEST(Collide, AgainstCountsWrongAnswers) {
  const ScratchFolder folder;
  const auto turning = folder.write("turning.wrl", std::string(kHeader) + std::string(kTurning));
  const auto against = [&](const std::string& engine, const std::string& right, std::optional<double> until_s = 9.0) {
    const Outcome outcome =
        watch(turning, {.json = true, .until_s = until_s, .hz = 20.0, .engine = engine, .against = right});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return outcome.json();
  };
  const Json json = against("sphere", "ours")["against"];
  EXPECT_THAT(keys_of(json), ElementsAre("engine", "questions", "false_touches", "missed", "interests"));
  EXPECT_THAT(json, HasMembers(R"({"engine": "ours", "questions": 181, "missed": 0})"));
  std::uint64_t near_only = 0;
  for (int tick = 0; tick <= 180; ++tick) {
    const double at_s = tick / 20.0;
    const auto says = [&](const std::string& engine) {
      const Outcome once = watch(turning, {.json = true, .at_s = at_s, .engine = engine});
      return once.json()["interests"][0]["colliding"].get<bool>();
    };
    near_only += says("sphere") && !says("ours") ? 1 : 0;
  }
  EXPECT_GT(near_only, 5u);
  EXPECT_EQ(json["false_touches"], near_only);
  ASSERT_EQ(json["interests"].size(), 1u);
  EXPECT_EQ(json["interests"][0], (Json{{"collider", "A"},
                                        {"collidee", "B"},
                                        {"type", "witness"},
                                        {"questions", 181},
                                        {"false_touches", near_only},
                                        {"missed", 0}}));
  for (const char* exact : {"ours", "obb", "kdop", "rapid-world"}) {
    EXPECT_EQ(against(exact, "aabb")["against"]["false_touches"], 0) << exact;
    EXPECT_EQ(against(exact, "aabb")["against"]["missed"], 0) << exact;
  }
  EXPECT_EQ(against("ours", "sphere")["against"]["missed"], near_only) << "the other one is taken to be right";
  EXPECT_THAT(watch(turning, {.until_s = 9.0, .hz = 20.0, .engine = "sphere", .against = "ours"}).out,
              HasSubstr("A - B (witness): " + std::to_string(near_only) +
                        " false touches, 0 missed, of 181 answers\nagainst ours: "));
}

TEST(Collide, AgainstCountsTheAnswersOfOneTime) {
  const ScratchFolder folder;
  // A bar that lies across: its upright cylinder of before does not reach as far as it does.
  const auto fallen = write(folder, R"(
    DEF A Transform { rotation 0 0 1 1.5708 children Shape { geometry Box { size 0.2 6 0.2 } } }
    DEF B Transform { translation 2.5 0 0 children Shape { geometry Box { size 1 1 1 } } }
    DEF C Transform { translation 0 9 0 children Shape { geometry Box { size 1 1 1 } } }
    CollisionInterest { objectPath "A" interests [ "B" "C" ] collisionType 1 })");
  const auto counts = [&](const std::string& engine) {
    const Json json = watch(fallen, {.json = true, .engine = engine, .against = "ours"}).json()["against"];
    return std::tuple(json["questions"].get<int>(), json["false_touches"].get<int>(), json["missed"].get<int>());
  };
  EXPECT_EQ(counts("ours"), std::tuple(2, 0, 0));
  EXPECT_EQ(counts("cylinders"), std::tuple(2, 0, 0));
  EXPECT_EQ(counts("cylinders,axis=model"), std::tuple(2, 0, 1));
  EXPECT_THAT(watch(fallen, {.engine = "cylinders,axis=model", .against = "ours"}).out,
              HasSubstr("A - B (witness): 0 false touches, 1 missed, of 1 answer\n"
                        "against ours: 0 false touches, 1 missed, of 2 answers\n"));
  const Outcome unknown = watch(fallen, {.against = "our"});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("--against: there is no engine our; did you mean ours?"));
}

TEST(Collide, SpaceTimeBoundsPostponePairs) {
  const ScratchFolder folder;
  const auto world = write(folder, kMoving);
  const auto run = [&](const std::string& engine) {
    return watch(world, {.json = true, .until_s = 13.0, .hz = 60.0, .engine = engine}).json();
  };
  const Json bounded = run("sphere"), plain = run("sphere,bounds=none");
  EXPECT_EQ(bounded["events"], plain["events"]);
  EXPECT_FALSE(plain["events"].empty());
  EXPECT_EQ(plain["counters"]["pairs_postponed"], 0);
  const auto count = [](const Json& json, const char* name) { return json["counters"][name].get<std::uint64_t>(); };
  EXPECT_EQ(count(bounded, "pairs_postponed") + count(bounded, "pairs_far"), count(plain, "pairs_far"));
  EXPECT_GT(count(bounded, "pairs_postponed"), count(plain, "pairs_far") / 2);
  EXPECT_THAT(watch(world, {.until_s = 13.0, .engine = "sphere"}).out, HasSubstr(" postponed, "));
}

TEST(Collide, ListsItsEngines) {
  std::ostringstream out;
  EXPECT_EQ(list_engines(true, out), 0);
  const Json list = Json::parse(out.str());
  ASSERT_GE(list.size(), 8u);
  EXPECT_THAT(keys_of(list[0]), ElementsAre("name", "exact", "reference", "about"));
  EXPECT_EQ(list[0]["name"], "ours");
}

}  // namespace peerd::collide_command_test
