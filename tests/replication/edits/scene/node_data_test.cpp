#include "replication/edits/scene/node_data.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace peerd::replication::node_data_test {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr NodeId kCar{3}, kBall{4, 7};

void set(NodeData& data, NodeId node, const std::string& key, const std::string& value) {
  const auto done = data.set(node, key, value);
  EXPECT_TRUE(done) << done.error();
}

TEST(NodeData, HasWhatWasSetLast) {
  NodeData data;
  set(data, kCar, "colour", "red");
  set(data, kCar, "colour", "blue");
  set(data, kCar, "a", "");
  set(data, kBall, "colour", "white");
  ASSERT_NE(data.find(kCar, "colour"), nullptr);
  EXPECT_EQ(*data.find(kCar, "colour"), "blue");
  EXPECT_THAT(data.keys(kCar), ElementsAre("a", "colour"));
  EXPECT_EQ(data.bytes(), std::string("colourbluea"
                                      "colourwhite")
                              .size());
  data.remove(kCar, "colour");
  data.remove(kCar, "none");
  EXPECT_EQ(data.find(kCar, "colour"), nullptr);
  data.keep([](NodeId node) { return node == kCar; });
  EXPECT_EQ(data.find(kBall, "colour"), nullptr);
  data.remove(kCar, "a");
  EXPECT_TRUE(data.empty());
  EXPECT_EQ(data.bytes(), 0u);
}

TEST(NodeData, HasNoMoreThanItsLimits) {
  NodeData keys, all;
  for (std::size_t i = 0; i < NodeData::kKeysOfNodeMax; ++i) set(keys, kCar, std::to_string(i), "");
  const auto one_more = keys.set(kCar, "one more", "");
  ASSERT_FALSE(one_more);
  EXPECT_THAT(one_more.error(), HasSubstr("256 keys"));
  set(keys, kCar, "0", "another value");
  set(keys, kBall, "one more", "");

  const std::string value(NodeData::kValueMax_bytes, 'v');
  std::uint32_t count = 0;
  std::expected<void, std::string> last;
  for (; last && count < 2000; ++count) last = all.set(NodeId{count}, "k", value);
  ASSERT_FALSE(last);
  EXPECT_THAT(last.error(), HasSubstr("may have 16777216"));
  EXPECT_LE(all.bytes(), NodeData::kMax_bytes);
  EXPECT_GT(all.bytes() + value.size() + 1, NodeData::kMax_bytes);
  set(all, NodeId{0}, "k", value);  // in place of itself
}

// Changes, made at the one, make the other of it.
TEST(NodeData, ChangesLeadFromOneToTheOther) {
  std::mt19937_64 random(1);
  const auto draw = [&] {
    NodeData data;
    for (auto i = random() % 20; i > 0; --i) {
      set(data, NodeId{static_cast<std::uint32_t>(random() % 4)}, std::to_string(random() % 5),
          std::to_string(random() % 3));
    }
    return data;
  };
  std::size_t changes = 0;
  for (int k = 0; k < 300; ++k) {
    NodeData before = draw();
    const NodeData after = draw();
    const auto all = after.changes_since(before);
    changes += all.size();
    for (const NodeData::Change& each : all) {
      each.value ? set(before, each.node, each.key, *each.value) : before.remove(each.node, each.key);
    }
    EXPECT_TRUE(after.changes_since(before).empty());
    EXPECT_EQ(before.bytes(), after.bytes());
  }
  EXPECT_GT(changes, 300u);
}

}  // namespace peerd::replication::node_data_test
