#include "peerd/peer/feed/pose_message.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"

namespace peerd::feed::pose_message_test {

using testing::HasSubstr;

TEST(PoseMessage, HasOnePoseWithAllItsValues) {
  const auto message = must(parse_pose_message(
      R"({"v":1,"do":"pose","object":"CAR","position_m":[1,2.5,-3e1],"orientation_xyzw":[0.1,0.2,0.3,0.9],)"
      R"("time_s":12.5,"velocity_m_s":[4,5,6],"acceleration_m_s2":[7,8,9],"angular_velocity_rad_s":[10,11,12],)"
      R"("jump":true,"reply":false})"));
  ASSERT_EQ(message.poses.size(), 1u);
  EXPECT_FALSE(message.reply);
  const FedPose& p = message.poses[0];
  EXPECT_EQ(p.object, "CAR");
  EXPECT_EQ(p.time_s, 12.5);
  EXPECT_EQ(p.pose.position, Vec3(1, 2.5, -30));
  EXPECT_EQ(p.pose.orientation->coeffs(), Quat(0.9, 0.1, 0.2, 0.3).coeffs()) << "x, y, z, w";
  EXPECT_EQ(p.pose.velocity, Vec3(4, 5, 6));
  EXPECT_EQ(p.pose.acceleration, Vec3(7, 8, 9));
  EXPECT_EQ(p.pose.angular_velocity_body, Vec3(10, 11, 12));
  EXPECT_TRUE(p.pose.jump);
}

TEST(PoseMessage, ItsTimeIsThatOfPosesWithoutTheirOwn) {
  const auto message =
      must(parse_pose_message(R"({"do":"pose","time_s":1,"poses":[{"object":"A","position_m":[0,0,0]},)"
                              R"({"object":"B","position_m":[0,0,0],"time_s":2}]})"));
  EXPECT_TRUE(message.reply);
  ASSERT_EQ(message.poses.size(), 2u);
  EXPECT_EQ(message.poses[0].time_s, 1.0);
  EXPECT_EQ(message.poses[1].time_s, 2.0);
}

TEST(PoseMessage, ValuesThatAreNotGivenAreNone) {
  const auto message = must(parse_pose_message(R"({"do":"pose","object":"A","position_m":[0,0,0]})"));
  const FedPose& p = message.poses.at(0);
  EXPECT_FALSE(p.time_s || p.pose.orientation || p.pose.velocity || p.pose.acceleration ||
               p.pose.angular_velocity_body || p.pose.jump);
}

struct Wrong {
  const char *name, *datagram, *error;
};
class WrongPoseMessage : public testing::TestWithParam<Wrong> {};
TEST_P(WrongPoseMessage, IsOneSentence) {
  EXPECT_THAT(error_of(parse_pose_message(GetParam().datagram)), HasSubstr(GetParam().error));
}
INSTANTIATE_TEST_SUITE_P(
    Table, WrongPoseMessage,
    testing::Values(Wrong{"Empty", "", "not JSON"}, Wrong{"AList", "[]", "no object"},
                    Wrong{"Twice", R"({"do":"pose","do":"pose"})", "\"do\" is given twice"},
                    Wrong{"AnotherVersion", R"({"v":2,"do":"pose","poses":[]})", "version 2 is not spoken here"},
                    Wrong{"AnotherRequest", R"({"do":"leave"})", "by UDP \"do\" must be \"pose\""},
                    Wrong{"NoRequest", R"({"object":"A","position_m":[0,0,0]})", "by UDP \"do\" must be \"pose\""},
                    Wrong{"NoObject", R"({"do":"pose","position_m":[0,0,0]})", "\"object\" is missing"},
                    Wrong{"NoUnit", R"({"do":"pose","object":"A","position":[0,0,0]})",
                          "\"position_m\" is missing; there is a \"position\""},
                    Wrong{"NoPosition", R"({"do":"pose","object":"A"})", "\"position_m\" is missing"},
                    Wrong{"TwoNumbers", R"({"do":"pose","object":"A","position_m":[0,0]})", "list of 3 numbers"},
                    Wrong{"FourNumbers", R"({"do":"pose","object":"A","position_m":[0,0,0,0]})", "of 3 numbers"},
                    Wrong{"Words", R"({"do":"pose","object":"A","position_m":[0,0,"0"]})", "list of 3 numbers"},
                    Wrong{"NaN", R"({"do":"pose","object":"A","position_m":[0,0,NaN]})", "which has no NaN"},
                    Wrong{"BeyondAllMeasure", R"({"do":"pose","object":"A","position_m":[0,0,1e999]})", "no 1e999"},
                    Wrong{"TimeIsAWord", R"({"do":"pose","object":"A","position_m":[0,0,0],"time_s":"now"})",
                          "\"time_s\" must be a number"},
                    Wrong{"PosesAreNoList", R"({"do":"pose","poses":{}})", "\"poses\" must be a list"},
                    Wrong{"PosesAreNumbers", R"({"do":"pose","poses":[1]})", "must be a list of objects"},
                    Wrong{"OnePoseAndMany", R"({"do":"pose","object":"A","poses":[]})", "unknown member \"object\""},
                    Wrong{"MisspeltInAPose", R"({"do":"pose","poses":[{"object":"A","positon_m":[0,0,0]}]})",
                          "number 1: \"position_m\" is missing"},
                    Wrong{"TwiceInAPose", R"({"do":"pose","poses":[{"object":"A","object":"B","position_m":[0,0,0]}]})",
                          "\"object\" is given twice"},
                    Wrong{"Misspelt", R"({"do":"pose","poses":[],"repyl":true})", "did you mean \"reply\"?"},
                    Wrong{"SecondPose", R"({"do":"pose","poses":[{"object":"A","position_m":[0,0,0]},{"object":"B"}]})",
                          "\"poses\" number 2: \"position_m\" is missing"}),
    [](const auto& c) { return std::string(c.param.name); });

}  // namespace peerd::feed::pose_message_test
