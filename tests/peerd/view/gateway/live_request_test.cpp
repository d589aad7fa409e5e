#include "peerd/view/gateway/live_request.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace peerd::gateway::live_request_test {

using nlohmann::json;
using testing::HasSubstr;

template <class Kind>
Kind read(const char* message) {
  const auto request = parse_live_request(message);
  if (!request.what || !std::holds_alternative<Kind>(*request.what)) {
    ADD_FAILURE() << message << ": " << (request.what ? "another kind" : request.what.error());
    return {};
  }
  return std::get<Kind>(*request.what);
}

std::string error(const char* message) {
  const auto request = parse_live_request(message);
  return request.what ? "" : request.what.error();
}

TEST(LiveRequest, OtherRequestsAreTheControlProtocols) {
  EXPECT_EQ(json::parse(read<PlainRequest>(R"({"do":"status","seq":3})").line), (json{{"do", "status"}}));
  EXPECT_EQ(json::parse(read<PlainRequest>(R"({"do":"nonsense","x":[1]})").line),
            (json{{"do", "nonsense"}, {"x", {1}}}));
  EXPECT_EQ(read<PlainRequest>("{\"do\":\"key\",\n\"key\":\"a\"}").line.find('\n'), std::string::npos);
}

TEST(LiveRequest, AWatchSaysWhatItWants) {
  const auto plain = read<WatchRequest>(R"({"do":"watch"})");
  EXPECT_EQ(plain.hz, 20.0);
  EXPECT_EQ(plain.watch.kinds, view::set_of(view::PoseKind::kShown));
  EXPECT_FALSE(plain.watch.near);
  const auto all = read<WatchRequest>(
      R"({"do":"watch","hz":120,"kinds":["truth","ghost"],"near":{"center_m":[1,2,3],"radius_m":4}})");
  EXPECT_EQ(all.hz, 120.0);
  EXPECT_EQ(all.watch.kinds, view::set_of(view::PoseKind::kTruth) | view::set_of(view::PoseKind::kGhost));
  ASSERT_TRUE(all.watch.near);
  EXPECT_EQ(all.watch.near->center_m, Vec3(1, 2, 3));
  EXPECT_EQ(all.watch.near->radius_m, 4.0);
  for (const char* wrong :
       {R"({"do":"watch","hz":0})", R"({"do":"watch","hz":121})", R"({"do":"watch","hz":1e999})",
        R"({"do":"watch","kinds":["all"]})", R"({"do":"watch","kinds":"shown"})", R"({"do":"watch","near":[1]})",
        R"({"do":"watch","near":{"center_m":[1,2,3]}})", R"({"do":"watch","near":{"center_m":[1,2],"radius_m":1}})",
        R"({"do":"watch","near":{"center_m":[1,2,3],"radius_m":0}})", R"({"do":"watch","rate":1})",
        R"({"do":"watch","near":{"center_m":[1,2,3],"radius_m":1,"x":1}})"}) {
    EXPECT_NE(error(wrong), "") << wrong;
  }
}

TEST(LiveRequest, PicksAndInspections) {
  const auto pick = read<PickRequest>(R"({"do":"pick","origin_m":[0,1,2],"direction":[0,0,-1]})");
  EXPECT_EQ(pick.origin, Vec3(0, 1, 2));
  EXPECT_EQ(pick.direction, Vec3(0, 0, -1));
  EXPECT_EQ(read<InspectRequest>(R"({"do":"inspect","node":7})").node, 7U);
  EXPECT_EQ(read<InspectRequest>(R"({"do":"inspect","path":"CAR/0"})").node, std::nullopt);
  EXPECT_EQ(read<InspectRequest>(R"({"do":"inspect","path":"CAR/0"})").path, "CAR/0");
  EXPECT_EQ(read<HierarchyRequest>(R"({"do":"hierarchy","path":"CAR","level":24})").level, 24U);
  EXPECT_EQ(read<HierarchyRequest>(R"({"do":"hierarchy","path":"CAR"})").path, "CAR");
  (void)read<SurroundingsRequest>(R"({"do":"surroundings"})");
  for (const char* wrong :
       {R"({"do":"hierarchy"})", R"({"do":"hierarchy","path":"CAR","level":25})", R"({"do":"surroundings","x":1})",
        R"({"do":"watch","looks":1})", R"({"do":"pick","origin_m":[0,1,2]})", R"({"do":"inspect"})",
        R"({"do":"inspect","node":-1})", R"({"do":"inspect","node":1,"path":"CAR"})", R"({"do":"inspect","path":1})",
        R"({"do":"inspect","node":4294967296})", R"({"do":"unwatch","x":1})"}) {
    EXPECT_NE(error(wrong), "") << wrong;
  }
}

TEST(LiveRequest, WalksAndAvatars) {
  const auto usual = read<WalkRequest>(R"({"do":"walk","eye_m":[0,1,2],"by_m":[1,0,0]})");
  EXPECT_EQ(usual.stride.eye, Vec3(0, 1, 2));
  EXPECT_EQ(usual.stride.by, Vec3(1, 0, 0));
  EXPECT_TRUE(usual.stride.falls);
  EXPECT_EQ(usual.size.height_m, 1.6);
  EXPECT_EQ(usual.except, "");
  const auto all = read<WalkRequest>(
      R"({"do":"walk","eye_m":[0,1,2],"by_m":[1,0,0],"falls":false,"fall_m_s":2,"for_s":0.5,"radius_m":1,"height_m":3,)"
      R"("step_m":0.5,"except":"ME"})");
  EXPECT_FALSE(all.stride.falls);
  EXPECT_EQ(all.stride.fall_m_s, 2.0);
  EXPECT_EQ(all.stride.for_s, 0.5);
  EXPECT_EQ(all.size.radius_m, 1.0);
  EXPECT_EQ(all.size.step_m, 0.5);
  EXPECT_EQ(all.except, "ME");
  EXPECT_EQ(read<AvatarRequest>(R"({"do":"avatar","path":"ME"})").path, "ME");
  EXPECT_EQ(read<AvatarRequest>(R"({"do":"avatar"})").path, "");
  for (const char* wrong : {R"({"do":"walk","eye_m":[0,1,2]})", R"({"do":"walk","by_m":[0,1,2]})",
                            R"({"do":"walk","eye_m":[0,1,2],"by_m":[1001,0,0]})",
                            R"({"do":"walk","eye_m":[0,1,2],"by_m":[1,0,0],"for_s":2})",
                            R"({"do":"walk","eye_m":[0,1,2],"by_m":[1,0,0],"radius_m":-1})",
                            R"({"do":"walk","eye_m":[0,1,2],"by_m":[1,0,0],"x":1})", R"({"do":"avatar","path":1})"}) {
    EXPECT_NE(error(wrong), "") << wrong;
  }
}

TEST(LiveRequest, RepliesRepeatTheNumber) {
  const auto request = parse_live_request(R"({"do":"unwatch","seq":9007199254740991})");
  EXPECT_EQ(with_sequence(R"({"v":1,"ok":true})", request.sequence), R"({"seq":9007199254740991,"v":1,"ok":true})");
  EXPECT_EQ(with_sequence(R"({"v":1})", std::nullopt), R"({"v":1})");
  const auto refused = parse_live_request(R"({"do":"watch","hz":1e9,"seq":4})");
  EXPECT_FALSE(refused.what);
  EXPECT_EQ(refused.sequence, 4);
  for (const char* wrong : {R"({"do":"unwatch","seq":-1})", R"({"do":"unwatch","seq":1.5})",
                            R"({"do":"unwatch","seq":"1"})", R"({"do":"unwatch","seq":9007199254740992})"}) {
    EXPECT_THAT(error(wrong), HasSubstr("\"seq\"")) << wrong;
  }
}

TEST(LiveRequest, WhatIsNoObjectIsRefused) {
  for (const char* wrong : {"", "null", "[]", "{", "\"token\"", R"({"do":"token"})", R"({"do":"token","token":1})",
                            R"({"do":"token","token":"a","token":"b"})", R"({"v":2,"do":"unwatch"})", "\xff"}) {
    EXPECT_NE(error(wrong), "") << wrong;
  }
}

}  // namespace peerd::gateway::live_request_test
