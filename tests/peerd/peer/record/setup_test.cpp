#include "peerd/peer/record/setup.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include <nlohmann/json.hpp>

#include "tests/must.hpp"
#include "tests/peerd/peer/record/some_setup.hpp"

namespace peerd::record::setup_test {

using nlohmann::json;
using testing::HasSubstr;

TEST(CaptureSetup, IsReadAsItWasWritten) {
  record::Setup s = some_setup();
  s.reading.collide = "a,b*";
  s.reading.unit = "mm";
  s.reading.up = "z";
  const auto read = must(setup_from(to_text(s)));
  EXPECT_EQ(read.reading.collide, "a,b*");
  EXPECT_EQ(read.reading.unit, "mm");
  EXPECT_EQ(read.reading.up, "z");
  EXPECT_EQ(read.peer, s.peer);
  EXPECT_EQ(read.configuration, s.configuration);
  EXPECT_EQ(read.file, s.file);
  EXPECT_EQ(read.world, s.world);
  EXPECT_EQ(read.world_hash, s.world_hash) << "all 64 bits";
  EXPECT_TRUE(read.reading.inlines_when_needed);
  EXPECT_EQ(read.reading.expansion, 7U);
  EXPECT_TRUE(read.options.late);
  EXPECT_EQ(read.options.incarnation, s.options.incarnation);
  EXPECT_EQ(read.options.wait_for, s.options.wait_for);
  EXPECT_EQ(read.options.start_lead, s.options.start_lead);
  EXPECT_EQ(read.options.clock_offset, s.options.clock_offset);
  EXPECT_FALSE(read.options.keep_log);
  EXPECT_EQ(read.options.sample_hz, 50u);
  EXPECT_EQ(read.groups.base, s.groups.base);
  EXPECT_EQ(read.groups.port, s.groups.port);
  EXPECT_EQ(read.groups.pool, s.groups.pool);
  EXPECT_EQ(read.groups.offset, s.groups.offset);
}

TEST(CaptureSetup, SaysHowItsDatagramsAre) {
  using Datagrams = record::Setup::Datagrams;
  for (const Datagrams each : {Datagrams::kOpen, Datagrams::kOpened, Datagrams::kSealed}) {
    record::Setup s = some_setup();
    s.datagrams = each;
    EXPECT_EQ(setup_from(to_text(s)).value().datagrams, each);
  }
}

TEST(CaptureSetup, WithoutAnOffsetTheGroupsBeginAtTheBase) {
  json text = json::parse(to_text(some_setup()));
  text["groups"].erase("offset");
  EXPECT_EQ(setup_from(text.dump()).value().groups.offset, 0u);
}

TEST(CaptureSetup, APathThatIsNoUtf8IsStillText) {
  record::Setup s = some_setup();
  s.world = "/\xFF.wrl";
  EXPECT_EQ(setup_from(to_text(s)).value().world, "/\uFFFD.wrl");
}

const std::set<std::string> kNewer{"late",    "watches", "datagrams", "expansion", "world_name",
                                   "lenient", "collide", "unit",      "up"};
TEST(CaptureSetup, EveryMemberIsNeededButThoseThatOlderCapturesLack) {
  const json whole = json::parse(to_text(some_setup()));
  for (const auto& [name, value] : whole.items()) {
    json text = whole;
    text.erase(name);
    const auto read = setup_from(text.dump());
    const bool is_newer = kNewer.contains(name);
    ASSERT_EQ(read.has_value(), is_newer) << name;
    if (is_newer) continue;
    EXPECT_THAT(read.error(), HasSubstr("'" + name + "'"));
  }
}

TEST(CaptureSetup, WrongValuesAreOneSentence) {
  const auto error = [](const char* pointer, const json& value) {
    json text = json::parse(to_text(some_setup()));
    text[json::json_pointer(pointer)] = value;
    const auto read = setup_from(text.dump());
    return read ? std::string() : read.error();
  };
  EXPECT_EQ(error("/format", 2), "what is recorded is of format 2, and this program reads 1");
  EXPECT_EQ(error("/sample_hz", 0), "sample_hz is 0");
  EXPECT_THAT(error("/groups/base", "192.0.2.1"), HasSubstr("is not a multicast address"));
  EXPECT_THAT(error("/groups/port", 0), HasSubstr("port 0"));
  EXPECT_THAT(error("/datagrams", "shut"), HasSubstr("what this program does not know"));
  EXPECT_THAT(error("/peer", 1), HasSubstr("can't be read"));
  EXPECT_THAT(setup_from("rubbish").error(), HasSubstr("can't be read"));
}

}  // namespace peerd::record::setup_test
