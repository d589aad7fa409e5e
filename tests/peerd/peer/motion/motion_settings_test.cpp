#include "peerd/peer/motion/motion_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "tests/must.hpp"

namespace peerd::motion::motion_settings_test {

using testing::HasSubstr;

struct Read {
  MotionSettings motion;
  std::string error;
};
Read read(const std::string& text) {
  const auto table = must(parse_toml(text, "my.toml"));
  std::optional<InputError> error;
  Read out;
  out.motion = read_motion(TomlReader(table, "motion.X", error), "/folder");
  if (error) out.error = error->text;
  return out;
}

TEST(MotionSettings, EachKindIsItsOwn) {
  EXPECT_TRUE(std::holds_alternative<MotionFormula>(read("x = \"t\"").motion.kind));
  EXPECT_TRUE(std::holds_alternative<Waypoints>(read("waypoints = [[0, 0, 0, 0]]").motion.kind));
  const Read track = read("track = \"way.csv\"\nloop = true");
  ASSERT_TRUE(std::holds_alternative<Track>(track.motion.kind));
  EXPECT_EQ(std::get<Track>(track.motion.kind).file, "/folder/way.csv") << "from the scenario's folder";
  EXPECT_TRUE(std::get<Track>(track.motion.kind).loop);
  EXPECT_TRUE(std::holds_alternative<WalkSettings>(read("walk = {within_m = [-9, -9, 9, 9]}").motion.kind));
  EXPECT_TRUE(std::holds_alternative<DriveSettings>(read("drive = {}").motion.kind));
  EXPECT_TRUE(std::holds_alternative<FlockSettings>(read("flock = {within_m = [0, 0, 0, 9, 9, 9]}").motion.kind));
  EXPECT_TRUE(std::holds_alternative<ExternalProgram>(read("outside = true").motion.kind));
  EXPECT_TRUE(std::holds_alternative<replication::Launch>(read("physics = {}").motion.kind));
}

TEST(MotionSettings, WhatLooksAheadByDefault) {
  EXPECT_TRUE(read("drive = {}").motion.face_forward);
  EXPECT_FALSE(read("drive = {}\nface_forward = false").motion.face_forward);
  EXPECT_FALSE(read("waypoints = [[0, 0, 0, 0]]").motion.face_forward);
}

TEST(MotionSettings, SeedsAndTheTimeBeforeTheStart) {
  EXPECT_FALSE(read("drive = {}").motion.seed);
  EXPECT_EQ(read("drive = {seed = 9}").motion.seed, 9u);
  EXPECT_FALSE(read("drive = {}").motion.hold_before_start);
  EXPECT_TRUE(read("drive = {}\nbefore_start = \"hold\"").motion.hold_before_start);
}

TEST(MotionSettings, TwoKindsOrAWrongOneAreRefusedAtTheirPlace) {
  EXPECT_THAT(read("waypoints = [[0, 0, 0, 0]]\ndrive = {}").error, HasSubstr("my.toml:"));
  EXPECT_THAT(read("outside = true\nx = \"t\"").error, HasSubstr("motion.X.x"));
  EXPECT_THAT(read("walk = {within_m = [0, 0, 1, 1]}").error, HasSubstr("my.toml:1:"));
  EXPECT_THAT(read("fly = {}").error, HasSubstr("unknown key motion.X.fly"));
}

}  // namespace peerd::motion::motion_settings_test
