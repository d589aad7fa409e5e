#include "peerd/peer/config/events.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/peerd/peer/config/scenario_text.hpp"

namespace peerd::config::events_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kThreePeers = R"(world = "some.wrl"
duration_s = 20
[peer.a]
id = 1
[peer.b]
id = 2
[peer.c]
id = 3
)";

class EventsTest : public testing_support::ScenarioText {
 protected:
  EventsTest() : ScenarioText(kThreePeers) {}
  std::vector<ScenarioEvent> events_of(const std::string& text, std::vector<std::string> sets = {}) {
    return read(text, std::move(sets)).runs.front().events;
  }
};

TEST_F(EventsTest, ComeByTimeThenByName) {
  const auto events = events_of(R"([event]
z-first = { at_s = 2, kind = "kill", peer = "b" }
parted = { at_s = 3, kind = "partition", groups = [["c"]] }
again = { at_s = 9, kind = "heal" }
alike = { at_s = 9, kind = "network", from = "a", latency_ms = 300, loss = 0.5 }
back = { at_s = 10.5, kind = "join", peer = "b" }
)");
  std::vector<std::string> names;
  for (const ScenarioEvent& e : events) names.push_back(e.name);
  ASSERT_THAT(names, ElementsAre("z-first", "parted", "again", "alike", "back"));
  EXPECT_EQ(events[0].kind, EventKind::kKill);
  EXPECT_EQ(events[0].peer, "b");
  EXPECT_THAT(events[1].sides, ElementsAre(0, 0, 1)) << "who is in no group is with the others that are in none";
  EXPECT_EQ(events[3].from, "a");
  LinkSettings link{.latency_ms = 5, .jitter_ms = 7};
  change_link(link, events[3].change);
  EXPECT_EQ(link.latency_ms, 300);
  EXPECT_EQ(link.jitter_ms, 7) << "what an event does not name stays";
  EXPECT_EQ(link.loss, 0.5);
  EXPECT_EQ(events[4].at_s, 10.5);
  EXPECT_TRUE(starts_with(events, "b"));
}

TEST_F(EventsTest, WhoJoinsFirstIsNotThereFromTheStart) {
  const auto events = events_of(
      "[event.late]\nat_s = 5\nkind = \"join\"\npeer = \"c\"\n[event.gone]\nat_s = 9\nkind = \"leave\"\npeer = "
      "\"c\"\n");
  EXPECT_FALSE(starts_with(events, "c"));
  EXPECT_TRUE(starts_with(events, "a"));
  EXPECT_TRUE(peers_change(events));
  EXPECT_THAT(events_of(""), IsEmpty());
}

TEST_F(EventsTest, AreSweptAndSetLikeEverythingElse) {
  const std::string parted = "[event.parted]\nat_s = 3\nkind = \"partition\"\ngroups = [[\"c\"]]\n";
  const Scenario scenario = read(parted + "[sweep]\n\"event.parted.at_s\" = [1, 2]\n");
  ASSERT_EQ(scenario.runs.size(), 2u);
  EXPECT_EQ(scenario.runs[1].events[0].at_s, 2);
  EXPECT_THAT(events_of(parted, {"event.parted.groups=[[\"a\"]]"})[0].sides, ElementsAre(1, 0, 0))
      << "one value, no sweep";
  EXPECT_THAT(events_of(parted, {"event={}"}), IsEmpty());
}

// They are pressed as those of [[peer.NAME.key]] are, and go down among them.
TEST_F(EventsTest, KeysAreHandedToTheirPeers) {
  const Scenario scenario = read(R"([[peer.b.key]]
at_s = 4
key = "ArrowUp"
[event]
strike = { at_s = 3, kind = "key", peer = "b", key = " ", shift = true }
again = { at_s = 5, kind = "key", peer = "b", value = 4115 }
)");
  const RunSettings& run = scenario.runs.front();
  EXPECT_TRUE(starts_with(run.events, "b"));
  EXPECT_FALSE(peers_change(run.events));
  EXPECT_THAT(run.peers[0].keys, IsEmpty());
  ASSERT_EQ(run.peers[1].keys.size(), 3u);
  EXPECT_EQ(run.peers[1].keys[0].at_s, 3);
  EXPECT_EQ(run.peers[1].keys[0].key, *find_key(" ", {.shift = true}));
  EXPECT_EQ(run.peers[1].keys[1].key, *find_key("ArrowUp", {}));
  EXPECT_EQ(run.peers[1].keys[2].key, (KeyEvent{4115, 0}));
}

struct Bad {
  const char* name;
  const char* event;  // line 10 is its first key
  const char *where, *sentence;
};
class EventRefusal : public EventsTest, public testing::WithParamInterface<Bad> {};
TEST_P(EventRefusal, SaysWhereAndWhat) {
  expect_refused(std::string("[event.e]\n") + GetParam().event, GetParam().where, GetParam().sentence);
}
INSTANTIATE_TEST_SUITE_P(
    Table, EventRefusal,
    testing::Values(
        Bad{"NoTime", "kind = \"heal\"", "9:", "event.e.at_s is missing"},
        Bad{"AfterTheEnd", "at_s = 21\nkind = \"heal\"", "10:8: ", "the run is over by then"},
        Bad{"NoSuchKind", "at_s = 1\nkind = \"split\"", "11:8: ", "must be one of \"join\", \"leave\", \"kill\""},
        Bad{"NoSuchPeer", "at_s = 1\nkind = \"kill\"\npeer = \"aa\"", "12:8: ", "did you mean \"a\"?"},
        Bad{"PeerOfAPartition", "at_s = 1\nkind = \"partition\"\ngroups = [[\"a\"]]\npeer = \"a\"",
            "13:1: ", "unknown key event.e.peer"},
        Bad{"JoinsTwice", "at_s = 1\nkind = \"join\"\npeer = \"b\"\n[event.f]\nat_s = 2\nkind = \"join\"\npeer = \"b\"",
            "13:", "\"b\" is there already"},
        Bad{"LeavesTwice",
            "at_s = 1\nkind = \"leave\"\npeer = \"b\"\n[event.f]\nat_s = 2\nkind = \"kill\"\npeer = \"b\"",
            "13:", "\"b\" is not there then"},
        Bad{"KeyOfWhoHasLeft",
            "at_s = 1\nkind = \"leave\"\npeer = \"b\"\n[event.f]\nat_s = 2\nkind = \"key\"\npeer = \"b\"\nkey = \"w\"",
            "13:", "\"b\" is not there then"},
        Bad{"NoKey", "at_s = 1\nkind = \"key\"\npeer = \"b\"", "9:", "give either a key's name or its value"},
        Bad{"NoSuchKey", "at_s = 1\nkind = \"key\"\npeer = \"b\"\nkey = \"ArowUp\"", "13:7: ", "event.e.key: "},
        Bad{"NothingToHeal", "at_s = 1\nkind = \"heal\"", "9:", "there is no partition then"},
        Bad{"NobodyIsParted", "at_s = 1\nkind = \"partition\"\ngroups = [[\"a\", \"b\", \"c\"]]",
            "12:10: ", "nothing is parted"},
        Bad{"InTwoGroups", "at_s = 1\nkind = \"partition\"\ngroups = [[\"a\", \"b\"], [\"a\"]]",
            "12:10: ", "\"a\" is in two of them"},
        Bad{"GroupsAreWords", "at_s = 1\nkind = \"partition\"\ngroups = [\"a\"]",
            "12:10: ", "a list of lists of strings"},
        Bad{"NothingChanges", "at_s = 1\nkind = \"network\"", "9:", "say what changes"},
        Bad{"LossAboveOne", "at_s = 1\nkind = \"network\"\nloss = 2", "12:8: ", "event.e.loss = 2 is out of range"}),
    [](const auto& c) { return std::string(c.param.name); });

TEST_F(EventsTest, SomebodyIsThereFromTheStart) {
  std::string all;
  for (const char* peer : {"a", "b", "c"}) {
    all += std::string("[event.") + peer + "]\nat_s = 1\nkind = \"join\"\npeer = \"" + peer + "\"\n";
  }
  EXPECT_THAT(error(all), HasSubstr("somebody must be there from the start"));
}

TEST_F(EventsTest, EditsAreTheirPeersOwn) {
  folder.write("wall.wrl", "#VRML V2.0 utf8\nDEF WALL Transform { }\n");
  const Scenario scenario = read(R"([event]
later = { at_s = 5, kind = "set", peer = "b", path = "WALL", field = "scale", value = "2 1 1" }
first = { at_s = 2, kind = "add", peer = "b", file = "wall.wrl", under = "HOUSE" }
)");
  const auto& edits = scenario.runs.front().peers[1].edits;
  ASSERT_EQ(edits.size(), 2u);
  EXPECT_EQ(edits[0].at_s, 2.0);
  EXPECT_EQ(edits[0].edit.kind, SceneEdit::Kind::kAdd);
  EXPECT_EQ(edits[0].edit.under, "HOUSE");
  EXPECT_THAT(edits[0].edit.text, HasSubstr("DEF WALL"));
  EXPECT_EQ(edits[1].edit.kind, SceneEdit::Kind::kSet);
  EXPECT_EQ(edits[1].edit.value, "2 1 1");
}

TEST_F(EventsTest, AnEditSaysWhatAndWhere) {
  const auto error_of = [&](const std::string& keys) {
    const auto scenario = result("[event.e]\nat_s = 1\npeer = \"a\"\n" + keys);
    return scenario ? std::string() : scenario.error().text;
  };
  EXPECT_THAT(error_of("kind = \"add\"\n"), HasSubstr("give either a text or its file"));
  EXPECT_THAT(error_of("kind = \"add\"\nfile = \"none.wrl\"\n"), HasSubstr("none.wrl"));
  EXPECT_THAT(error_of("kind = \"set\"\npath = \"A\"\n"), HasSubstr("field"));
  EXPECT_THAT(error_of("kind = \"remove\"\n"), HasSubstr("path"));
  EXPECT_THAT(error_of("kind = \"remove\"\npath = \"A\"\nvalue = \"1\"\n"), HasSubstr("value"));
  EXPECT_THAT(error_of("kind = \"data\"\npath = \"A\"\n"), HasSubstr("key"));
  EXPECT_THAT(error_of("kind = \"data\"\npath = \"A\"\nkey = \"k\"\n"), HasSubstr("either a value or remove"));
  EXPECT_THAT(error_of("kind = \"data\"\npath = \"A\"\nkey = \"k\"\nvalue = \"1\"\nremove = true\n"),
              HasSubstr("either a value or remove"));
  EXPECT_EQ(error_of("kind = \"data\"\npath = \"A\"\nkey = \"k\"\nremove = true\n"), "");
  EXPECT_THAT(error_of("kind = \"send\"\ntopic = \"chat\"\n"), HasSubstr("text"));
  EXPECT_EQ(error_of("kind = \"send\"\ntopic = \"chat\"\ntext = \"hello\"\n"), "");
}

}  // namespace peerd::config::events_test
