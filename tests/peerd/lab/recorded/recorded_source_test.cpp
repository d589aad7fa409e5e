#include "peerd/lab/recorded/recorded_source.hpp"

#include <gtest/gtest.h>

#include <string>

#include <nlohmann/json.hpp>

#include "peerd/input/compression.hpp"

namespace peerd::recorded::recorded_source_test {

using nlohmann::json;

Recording small_recording() {
  RecordedView view{.peer = PeerId{7}, .name = "a", .scenes = {}, .stretches = {}, .events = {}, .errors = {}};
  view.scenes.push_back({.revision = 3, .from_s = 0, .glb = compress("a scene"), .why_not = "", .size_bytes = 7});
  view.stretches.push_back({.from_s = 0, .until_s = 2, .revision = 3, .frames = compress("frames"), .size_bytes = 6});
  view.events.push_back({1.5, R"({"event":"joined"})"});
  view.errors.mean_m = {0.5F};
  view.errors.largest_m = {2.0F};
  view.errors.of_object[ObjectId{9}] = {1.0F};
  Recording recording{.name = "w", .end_s = 2};
  recording.views.push_back(std::move(view));
  recording.peers.emplace_back(PeerId{7}, "a");
  return recording;
}

std::string file(RecordedSource& source, const std::string& name) {
  const auto found = source.recorded_file(name);
  return found ? *found->bytes : "none";
}

TEST(RecordedSource, HasItsFilesByName) {
  RecordedSource source(small_recording());
  EXPECT_EQ(file(source, "0/scene-3"), "a scene");
  EXPECT_EQ(file(source, "0/poses-0"), "frames");
  EXPECT_EQ(file(source, "0/events"), R"([[1.5,{"event":"joined"}]])");
  EXPECT_EQ(file(source, "0/errors").size(), 2 * sizeof(float));
  EXPECT_EQ(file(source, "0/errors-9").size(), sizeof(float));
  const json contents = json::parse(file(source, "")).at("recording");
  EXPECT_EQ(contents.at("kind"), "run");
  EXPECT_EQ(contents.at("views").at(0).at("stretches"), json::parse("[[0.0,2.0,3]]"));
}

TEST(RecordedSource, HasNothingElse) {
  RecordedSource source(small_recording());
  for (const char* const name :
       {"0", "0/", "1/events", "0/poses-1", "0/poses-", "0/poses--1", "0/poses-0x0", "0/scene-1", "0/errors-8",
        "x/events", "/events", "0/../0/events", "0/events/", "0/poses-99999999999999999999"}) {
    EXPECT_EQ(file(source, name), "none") << name;
  }
}

TEST(RecordedSource, RefusesWhatNeedsAPeer) {
  RecordedSource source(small_recording());
  for (const std::string& reply : {source.ask(R"({"do":"status"})").line, source.ask(R"({"do":"leave"})").line,
                                   source.pick(Vec3::Zero(), Vec3::UnitX()), source.inspect(0)}) {
    EXPECT_EQ(json::parse(reply).at("ok"), false);
    EXPECT_EQ(json::parse(reply).at("error"), "this is a recording: there is no peer that could do that");
  }
}

}  // namespace peerd::recorded::recorded_source_test
