#include "peerd/lab/live/live_events.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"

namespace peerd::live_events_test {

using config::EventKind, config::ScenarioEvent;
using testing::HasSubstr;

ScenarioEvent event(EventKind kind, const char* peer, double at_s = 1.0) {
  ScenarioEvent e;
  e.name = "e";
  e.at_s = at_s;
  e.kind = kind;
  e.peer = peer;
  return e;
}

TEST(LiveEvents, RealProcessesJoinLeaveAndAreKilled) {
  EXPECT_FALSE(why_not_live({event(EventKind::kJoin, "a", 1), event(EventKind::kLeave, "a", 2),
                             event(EventKind::kKill, "b", 3), event(EventKind::kKey, "c", 3)}));
}

TEST(LiveEvents, TheNetworkIsNotTheirs) {
  for (const EventKind kind : {EventKind::kPartition, EventKind::kHeal, EventKind::kNetwork}) {
    const auto why = must(why_not_live({event(kind, "")}));
    EXPECT_EQ(why.exit_code, 2);
    EXPECT_THAT(why.text, HasSubstr("error: event.e: " + std::string(to_string(kind)) + " is for a simulated network"));
  }
}

TEST(LiveEvents, ARealPeerDoesNotComeBack) {
  const auto why = must(why_not_live({event(EventKind::kLeave, "a", 1), event(EventKind::kJoin, "a", 2)}));
  EXPECT_THAT(why.text, HasSubstr("does not come back"));
  EXPECT_TRUE(why_not_live(
      {event(EventKind::kJoin, "a", 1), event(EventKind::kLeave, "a", 2), event(EventKind::kJoin, "a", 3)}));
}

TEST(LiveEvents, AskAPeerOnlyWhereAProcessIsConcerned) {
  const auto none = must(LiveEvents::make({event(EventKind::kKey, "a")}));
  EXPECT_TRUE(none.control().empty()) << "each peer presses its own keys";
  std::filesystem::path folder;
  {
    auto some = must(LiveEvents::make({event(EventKind::kLeave, "a", 0.0)}));
    folder = some.control().parent_path();
    EXPECT_TRUE(std::filesystem::is_directory(folder));
    EXPECT_EQ(some.take_due(), nullptr) << "no peer answers, so nobody knows when the motions began";
    const LiveEvents moved = std::move(some);
    EXPECT_EQ(moved.control().parent_path(), folder);
  }
  EXPECT_FALSE(std::filesystem::exists(folder)) << "it goes with its object";
}

}  // namespace peerd::live_events_test
