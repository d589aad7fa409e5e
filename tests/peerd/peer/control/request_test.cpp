#include "peerd/peer/control/request.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/must.hpp"

namespace peerd::control::request_test {

using testing::HasSubstr;

KeyEvent key_of(std::string_view line) {
  const auto request = parse_request(line);
  if (!request || !std::holds_alternative<KeyRequest>(*request)) {
    ADD_FAILURE() << (request ? "another request" : request.error());
    return {};
  }
  return std::get<KeyRequest>(*request).key;
}

TEST(Request, AKeyByNameOrNumber) {
  EXPECT_EQ(key_of(R"({"do":"key","key":"ArrowUp"})"), (KeyEvent{0x1013, 0}));
  EXPECT_EQ(key_of(R"({"do":"key","key":"a","shift":true,"alt":true,"control":false})"), (KeyEvent{0x41, 0x500}));
  EXPECT_EQ(key_of(R"({"v":1,"do":"key","value":4115,"state":256})"), (KeyEvent{4115, 256}));
  EXPECT_EQ(key_of(R"( {"do" : "key", "value" : 4115} )"
                   "\r"),
            (KeyEvent{4115, 0}));
}

TEST(Request, Viewpoints) {
  const auto look = std::get<ViewpointRequest>(*parse_request(
      R"({"do":"viewpoint","object":"ME","position_m":[0,1,2],"orientation_xyzw":[0,1,0,0],"field_of_view_rad":1,"aspect":2})"));
  EXPECT_EQ(look.path, "ME");
  ASSERT_TRUE(look.viewpoint);
  EXPECT_EQ(look.viewpoint->pose.position, Vec3(0, 1, 2));
  EXPECT_EQ(look.viewpoint->pose.orientation.coeffs(), Quat(0, 0, 1, 0).coeffs());
  EXPECT_EQ(look.viewpoint->field_of_view, 1.0);
  EXPECT_EQ(look.viewpoint->aspect, 2.0);
  const auto usual = *parse_request(R"({"do":"viewpoint"})");
  EXPECT_FALSE(std::get<ViewpointRequest>(usual).viewpoint) << "as the configuration says";
  EXPECT_TRUE(changes_something(usual));
  for (const char* wrong :
       {R"({"do":"viewpoint","position_m":[0,2e9,0]})", R"({"do":"viewpoint","position_m":[0,1,2],"aspect":0})",
        R"({"do":"viewpoint","aspect":1})", R"({"do":"viewpoint","position_m":[0,1,2],"field_of_view_rad":3.2})",
        R"({"do":"viewpoint","position_m":[0,1,2],"orientation_xyzw":[0,0,0,0]})"}) {
    EXPECT_FALSE(parse_request(wrong)) << wrong;
  }
}

TEST(Request, TheOthers) {
  EXPECT_TRUE(std::holds_alternative<StatusRequest>(*parse_request(R"({"do":"status"})")));
  EXPECT_EQ(std::get<PeersRequest>(*parse_request(R"({"do":"peers","from":3})")).from, 3u);
  EXPECT_TRUE(std::holds_alternative<ViewerRequest>(*parse_request(R"({"do":"viewer"})")));
  EXPECT_TRUE(std::holds_alternative<LeaveRequest>(*parse_request(R"({"do":"leave"})")));
  const auto objects = std::get<ObjectsRequest>(*parse_request(R"({"do":"objects","from":7,"count":2})"));
  EXPECT_EQ(objects.from, 7u);
  EXPECT_EQ(objects.count, 2u);
  EXPECT_EQ(std::get<ObjectsRequest>(*parse_request(R"({"do":"objects"})")).count, kObjectsMax);
}

TEST(Request, SubscribesToKinds) {
  const auto some = std::get<SubscribeRequest>(*parse_request(R"({"do":"subscribe","to":["data","peers","data"]})"));
  EventKinds expected;
  expected.add(EventKind::kData);
  expected.add(EventKind::kPeers);
  EXPECT_EQ(some.kinds, expected);
  EXPECT_FALSE(some.kinds.contains(EventKind::kEdits));
  EXPECT_EQ(std::get<SubscribeRequest>(*parse_request(R"({"do":"subscribe"})")).kinds, EventKinds::all());
  EXPECT_TRUE(std::get<SubscribeRequest>(*parse_request(R"({"do":"subscribe","to":[]})")).kinds.empty());
  EXPECT_THAT(parse_request(R"({"do":"subscribe","to":["date"]})").error(), HasSubstr("\"date\""));
  EXPECT_THAT(parse_request(R"({"do":"subscribe","to":"data"})").error(), HasSubstr("must be a list of strings"));
}

TEST(Request, DataAreReadSetAndRemoved) {
  EXPECT_EQ(std::get<DataRequest>(*parse_request(R"({"do":"data","path":"A","key":"k"})")).key, "k");
  EXPECT_FALSE(std::get<DataRequest>(*parse_request(R"({"do":"data","path":"A"})")).key);
  const auto set = std::get<EditRequest>(*parse_request(R"({"do":"data","path":"A","key":"k","value":""})")).edit;
  EXPECT_EQ(set.kind, config::SceneEdit::Kind::kData);
  EXPECT_FALSE(set.removes);
  EXPECT_TRUE(
      std::get<EditRequest>(*parse_request(R"({"do":"data","path":"A","key":"k","remove":true})")).edit.removes);
  EXPECT_THAT(parse_request(R"({"do":"data","path":"A","key":"k","value":"1","remove":true})").error(),
              HasSubstr("exclude"));
  EXPECT_THAT(parse_request(R"({"do":"data","path":"A","value":"1"})").error(), HasSubstr("key"));
  EXPECT_THAT(parse_request(R"({"do":"send","topic":"chat"})").error(), HasSubstr("text"));
}

// tests/peerd/peer/feed/pose_message_test.cpp has all that poses may hold.
TEST(Request, PosesAreThoseOfAMessage) {
  const auto request = std::get<PoseRequest>(
      *parse_request(R"({"do":"pose","reply":false,"poses":[{"object":"A","position_m":[0,0,0]}]})"));
  ASSERT_EQ(request.poses.size(), 1u);
  EXPECT_EQ(request.poses[0].object, "A");
  EXPECT_FALSE(request.reply);
  EXPECT_TRUE(std::get<PoseRequest>(*parse_request(R"({"do":"pose","poses":[]})")).poses.empty());
}

struct Wrong {
  const char *name, *line, *error;
};
class WrongRequest : public testing::TestWithParam<Wrong> {};
TEST_P(WrongRequest, IsOneSentence) {
  EXPECT_THAT(error_of(parse_request(GetParam().line)), HasSubstr(GetParam().error));
}
INSTANTIATE_TEST_SUITE_P(
    Table, WrongRequest,
    testing::Values(Wrong{"Empty", "", "not JSON"}, Wrong{"Words", "status", "not JSON"},
                    Wrong{"TwoObjects", "{} {}", "not JSON"}, Wrong{"Bytes", "{\"do\":\"\xff\"}", "not JSON"},
                    Wrong{"AList", "[1]", "no object"}, Wrong{"ANumber", "1", "no object"},
                    Wrong{"Nothing", "{}", "\"do\" must be one of"},
                    Wrong{"Unknown", R"({"do":"fly"})", "\"do\" must be one of"},
                    Wrong{"NoString", R"({"do":1})", "\"do\" must be"},
                    Wrong{"AnotherVersion", R"({"v":2,"do":"status"})", "version 2 is not spoken here"},
                    Wrong{"NoVersion", R"({"v":"1","do":"status"})", "\"v\" must be a whole number"},
                    Wrong{"UnknownKey", R"({"do":"key","key":"ArowUp"})", "did you mean \"ArrowUp\"?"},
                    Wrong{"NoKey", R"({"do":"key"})", "must say which key"},
                    Wrong{"BothKeys", R"({"do":"key","key":"a","value":65})", "must say which key"},
                    Wrong{"KeyIsANumber", R"({"do":"key","key":65})", "\"key\" must be a string"},
                    Wrong{"StateOfAName", R"({"do":"key","key":"a","state":1})", "\"state\" belongs to \"value\""},
                    Wrong{"ShiftOfAValue", R"({"do":"key","value":65,"shift":true})", "modifiers in \"state\""},
                    Wrong{"ShiftIsNoBool", R"({"do":"key","key":"a","shift":1})", "\"shift\" must be true or false"},
                    Wrong{"Misspelt", R"({"do":"key","key":"a","shfit":true})", "did you mean \"shift\"?"},
                    Wrong{"AMemberTooMany", R"({"do":"status","key":"a"})", "unknown member \"key\""},
                    Wrong{"Fraction", R"({"do":"key","value":65.5})", "\"value\" must be a whole number"},
                    Wrong{"Negative", R"({"do":"key","value":-1})", "\"value\" must be a whole number"},
                    Wrong{"Huge", R"({"do":"key","value":18446744073709551615})", "\"value\" must be a whole number"},
                    Wrong{"TooManyObjects", R"({"do":"objects","count":257})", "from 1 to 256"},
                    Wrong{"Twice", R"({"do":"status","do":"leave"})", "\"do\" is given twice"},
                    Wrong{"TwiceTheSame", R"({"do":"key","key":"a","shift":true,"shift":true})",
                          "\"shift\" is given twice"},
                    Wrong{"PoseOfNothing", R"({"do":"pose","position_m":[0,0,0]})", "\"object\" is missing"},
                    Wrong{"NoObjects", R"({"do":"objects","count":0})", "from 1 to 256"}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(Request, NestedToTheLimitIsRefused) {
  for (const char* bracket : {"[", "{\"a\":"}) {
    std::string line;
    while (line.size() < kLineMax_bytes) line += bracket;
    EXPECT_FALSE(parse_request(line));
  }
  EXPECT_FALSE(parse_request(std::string(kLineMax_bytes / 2, '[') + std::string(kLineMax_bytes / 2, ']')));
}

TEST(Request, AnyBytesAreRefusedOrUnderstood) {
  std::mt19937_64 random(3);
  const std::string real = R"({"v":1,"do":"key","value":4115,"state":256})";
  for (int i = 0; i < 20'000; ++i) {
    std::string line = real;
    for (int changes = 0; changes < 4; ++changes) line[random() % line.size()] = static_cast<char>(random());
    (void)parse_request(line);
  }
}

}  // namespace peerd::control::request_test
