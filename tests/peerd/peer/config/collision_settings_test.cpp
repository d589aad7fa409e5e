#include "peerd/peer/config/collision_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

namespace peerd::config::collision_settings_test {

using testing::HasSubstr;

struct Read {
  CollisionSettings settings;
  std::optional<InputError> error;
};
Read read(const std::string& text) {
  const toml::table table = toml::parse(text);
  Read out;
  out.settings = read_collision(TomlReader(table, "collision", out.error));
  return out;
}

TEST(CollisionSettings, AreOursUnlessSaidOtherwise) {
  const Read ours = read("");
  EXPECT_FALSE(ours.error);
  EXPECT_TRUE(ours.settings.is_ours());
  EXPECT_EQ(ours.settings.make_detection(60), nullptr);
  EXPECT_TRUE(read("engine = \"ours,\"").settings.is_ours());
  const Read other = read("engine = \"kdop,k=14\"");
  EXPECT_FALSE(other.error);
  EXPECT_FALSE(other.settings.is_ours());
  EXPECT_NE(other.settings.make_detection(60), nullptr);
}

TEST(CollisionSettings, RefuseWhatThereIsNot) {
  EXPECT_THAT(read("engine = \"obbb\"").error.value().text, HasSubstr("collision.engine: there is no engine obbb"));
  EXPECT_THAT(read("engine = \"kdop,k=7\"").error.value().text, HasSubstr("k=7 is none of"));
  EXPECT_THAT(read("engin = \"obb\"").error.value().text, HasSubstr("engin"));
}

// Peers with other engines, or with other ticks at which they ask them, do not meet; ours leaves the hash as it was.
TEST(CollisionSettings, MakeSessionsOfTheirOwn) {
  const CollisionSettings ours, obb{"obb"}, aabb{"aabb"};
  EXPECT_EQ(ours.session_hash(7, 60), 7u);
  EXPECT_EQ(ours.session_hash(7, 50), 7u);
  EXPECT_NE(obb.session_hash(7, 60), 7u);
  EXPECT_EQ(obb.session_hash(7, 60), obb.session_hash(7, 60));
  EXPECT_NE(obb.session_hash(7, 60), obb.session_hash(7, 50));
  EXPECT_NE(obb.session_hash(7, 60), aabb.session_hash(7, 60));
}

}  // namespace peerd::config::collision_settings_test
