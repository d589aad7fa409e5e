#include "peerd/peer/feed/pose_feeds.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/reader.hpp"

namespace peerd::feed::pose_feeds_test {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF A Transform { translation 1 2 3 children Shape { geometry Box { } } }
DEF B Transform { children Shape { geometry Box { } } }
DEF C Transform { children Shape { geometry Box { } } }
)";
constexpr HostTime kNow{1000s};
constexpr Duration kWallBehind = 3s;  // from Unix time to host time

struct PoseFeedsTest : testing::Test {
  Outcome push(std::vector<FedPose> poses) { return feeds.push(kNow, kWallBehind, poses); }
  std::vector<std::string> notices() {
    std::vector<std::string> all;
    while (const auto notice = feeds.poll_notice()) {
      all.push_back(std::to_string(static_cast<int>(notice->kind)) + (notice->again ? " again " : " ") + notice->what);
    }
    return all;
  }
  std::map<std::string, std::uint64_t> counters() {
    std::map<std::string, std::uint64_t> all;
    feeds.count(all);
    return all;
  }

  Scene scene = read_world(kWorld).scene.value();
  ObjectId a = *scene.find("A"), b = *scene.find("B"), c = *scene.find("C");
  PoseFeeds feeds{{{{"B", b}, {"A", a}}, 500ms}, scene};
};

TEST_F(PoseFeedsTest, KnowTheirObjectsByPathAndById) {
  EXPECT_THAT(feeds.objects(), ElementsAre(a, b));
  EXPECT_TRUE(feeds.feeds(a) && feeds.feeds(b));
  EXPECT_FALSE(feeds.feeds(c));
  EXPECT_EQ(feeds.find("B"), b);
  EXPECT_EQ(feeds.find("C"), std::nullopt);
  EXPECT_EQ(feeds.sample(a, kNow).position, Vec3(1, 2, 3)) << "before its first pose, as in the file";
}

TEST_F(PoseFeedsTest, UnixTimesBecomeHostTimes) {
  const Outcome outcome = push({{"A", 996.5, {.position = {0, 0, 0}}}, {"A", 997.0, {.position = {1, 0, 0}}}});
  EXPECT_EQ(outcome.taken, 2u);
  EXPECT_EQ(feeds.sample(a, kNow - 500ms).position, Vec3(0, 0, 0));
  EXPECT_EQ(feeds.sample(a, kNow).position, Vec3(1, 0, 0));
  EXPECT_EQ(push({{"A", 998.0, {}}}).refused.at(0).why, Refusal::kTooFarAhead) << "1 s ahead of the host's time";
}

TEST_F(PoseFeedsTest, EachPoseIsTakenOrCountedWithItsReason) {
  const Outcome outcome = push({{"A", {}, {}},
                                {"C", {}, {}},
                                {"C", {}, {}},
                                {"B", -1.0, {}},
                                {"B", 9.1e9, {}},
                                {"B", {}, {.position = {2e9, 0, 0}}}});
  EXPECT_EQ(outcome.taken, 1u);
  std::vector<std::pair<std::string, Refusal>> refused;
  for (const auto& [object, why] : outcome.refused) refused.emplace_back(object, why);
  EXPECT_THAT(refused, ElementsAre(std::pair("C", Refusal::kObject), std::pair("C", Refusal::kObject),
                                   std::pair("B", Refusal::kTime), std::pair("B", Refusal::kTime),
                                   std::pair("B", Refusal::kPosition)));
  const auto n = counters();
  EXPECT_EQ(n.at("poses_taken"), 1u);
  EXPECT_EQ(n.at("poses_refused"), 5u);
  EXPECT_EQ(n.at("poses_refused_object"), 2u);
  EXPECT_EQ(n.at("poses_refused_time"), 2u);
  EXPECT_EQ(n.at("poses_refused_position"), 1u);
  EXPECT_FALSE(n.contains("poses_refused_spin")) << "no pose had that reason";
  EXPECT_EQ(n.at("pose_messages_refused"), 0u);
  const auto lines = notices();
  ASSERT_EQ(lines.size(), 3u) << "one for each kind of refusal";
  EXPECT_THAT(lines[0], HasSubstr("C is not used: no object of that name"));
}

TEST_F(PoseFeedsTest, TheFirstMessageThatIsNotUnderstoodIsANotice) {
  feeds.refuse_message("bad\n\xFF" + std::string(200, 'x'));
  feeds.refuse_message("worse");
  EXPECT_THAT(notices(), ElementsAre("4 bad??" + std::string(155, 'x')));
  EXPECT_EQ(counters().at("pose_messages_refused"), 2u);
}

TEST_F(PoseFeedsTest, WithoutObjectsThereAreNoCounters) {
  PoseFeeds none({}, scene);
  std::map<std::string, std::uint64_t> all;
  none.count(all);
  EXPECT_TRUE(all.empty());
}

TEST_F(PoseFeedsTest, ObjectsComeAndGo) {
  feeds.add("HAND/C", c, {Vec3(7, 8, 9), Quat::Identity()});
  EXPECT_THAT(feeds.objects(), ElementsAre(a, b, c));
  EXPECT_FALSE(feeds.begun(c));
  EXPECT_EQ(feeds.sample(c, kNow).position, Vec3(7, 8, 9));
  EXPECT_EQ(push({{"HAND/C", {}, {.position = {1, 1, 1}}}, {"B", {}, {.position = {2, 2, 2}}}}).taken, 2u);
  EXPECT_TRUE(feeds.begun(c));
  feeds.remove(a);
  EXPECT_THAT(feeds.objects(), ElementsAre(b, c));
  EXPECT_EQ(feeds.find("A"), std::nullopt);
  EXPECT_EQ(feeds.sample(c, kNow).position, Vec3(1, 1, 1)) << "the others stay as they are";
  EXPECT_EQ(feeds.sample(b, kNow).position, Vec3(2, 2, 2));
  EXPECT_EQ(push({{"A", {}, {}}}).refused.at(0).why, Refusal::kObject);
  feeds.remove(b);
  feeds.remove(c);
  EXPECT_EQ(counters()["poses_taken"], 2u) << "what has been counted stays";
}

}  // namespace peerd::feed::pose_feeds_test
