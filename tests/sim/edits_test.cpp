// configs/scenarios/edits.toml: the scene changes while it runs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::edits_test {

using namespace testing_support;
using testing::DoubleNear;
using testing::ElementsAre;

const std::string kEdits = PEERD_SOURCE_DIR "/configs/scenarios/edits.toml";

TEST(Edits, TheBallMeetsWhatIsThereAtTheTime) {
  for (const char* seed : {"1", "2", "3"}) {
    const Ran ran = run_scenario(kEdits, {"seed=" + std::string(seed)}).front();
    std::vector<double> times;
    std::vector<std::string> met;
    for (const auto& row : ran.contacts(PeerId{1}, "owner")) {
      times.push_back(row.t_s);
      met.push_back(ran.record.scene_paths.at(row.collidee));
    }
    constexpr double kRounding_s = 1e-8;
    EXPECT_THAT(times, ElementsAre(DoubleNear(3.25, kRounding_s), DoubleNear(7.0, kRounding_s),
                                   DoubleNear(9.75, kRounding_s), DoubleNear(12.5, kRounding_s)));
    EXPECT_THAT(met, ElementsAre("WALL", "LEFT", "WALL", "LEFT"));
    EXPECT_LT(ran.view("b", "BALL")["ghost_error_m"]["max"].get<double>(), 0.05);
    for (const auto& sample : ran.record.ghost_samples) {
      if (sample.observer != PeerId{3} || sample.t_s < 6.0) continue;  // c has joined by then
      EXPECT_LT((sample.ghost.position - sample.truth.position).norm(), 0.05) << sample.t_s;
    }
    EXPECT_EQ(ran.summary["counters"]["operations"], 3);
    EXPECT_EQ(ran.summary["counters"]["scene_changes"], 9);
  }
}

// As events: b takes back that the wall is nearer, so that the ball meets it where it was; it says what it does, at a
// node and to all.
TEST(Edits, UndoDataAndMessagesAreEvents) {
  const std::string undo = "event.b-undo.", redo = "event.c-redo.", data = "event.d-data.", send = "event.e-send.";
  const Ran ran =
      run_scenario(kEdits, {undo + "at_s=8", undo + "kind=undo", undo + "peer=b", redo + "at_s=11", redo + "kind=redo",
                            redo + "peer=b", data + "at_s=9", data + "kind=data", data + "peer=a", data + "path=WALL",
                            data + "key=who", data + "value=b", send + "at_s=9.5", send + "kind=send", send + "peer=a",
                            send + "topic=chat", send + "text=hello"})
          .front();
  std::vector<double> times;
  for (const auto& row : ran.contacts(PeerId{1}, "owner")) times.push_back(row.t_s);
  constexpr double kRounding_s = 1e-8;
  EXPECT_THAT(times, ElementsAre(DoubleNear(3.25, kRounding_s), DoubleNear(7.0, kRounding_s),
                                 DoubleNear(10.75, kRounding_s), DoubleNear(14.5, kRounding_s)));
  EXPECT_EQ(ran.summary["counters"]["operations"], 7);
  EXPECT_EQ(ran.summary["counters"]["scene_changes"], 15) << "data and messages are none";
}

}  // namespace peerd::sim::edits_test
