#include "peerd/lab/recorded/record_capture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include <nlohmann/json.hpp>

#include "peerd/lab/recorded/stretch_reader.hpp"
#include "tests/must.hpp"
#include "tests/peerd/lab/recorded/recorded_run.hpp"

namespace peerd::recorded::record_capture_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;
using testing_support::SimulatedFolder;
using view::PoseKind;
using view::PoseRow;

const std::string kSnooker = PEERD_SOURCE_DIR "/configs/scenarios/snooker.toml";

std::multiset<std::string> contacts_of(const RecordedView& view) {
  std::multiset<std::string> pairs;
  for (const RecordedEvent& event : view.events) {
    const auto line = nlohmann::json::parse(event.line);
    if (line.at("event") == "contact" && line.at("kind") != "predicted") {
      pairs.insert(line.at("collider").get<std::string>() + ' ' + line.at("collidee").get<std::string>());
    }
  }
  return pairs;
}

// The capture of a simulated peer and the run itself are one and the same peer.
TEST(RecordCapture, HasWhatThePeerOfTheRunHad) {
  const SimulatedFolder folder(kSnooker, "", SimulatedFolder::Captures::kAll);
  const Recording run = must(record_run(must(read_run(folder.run(), 1)), {}));
  for (const RecordedView& view : run.views) {
    SCOPED_TRACE(view.name);
    const Recording capture = must(record_capture({.path = folder.captures() / (view.name + ".pcapng")}, {}));
    EXPECT_THAT(capture.notes, ElementsAre());
    ASSERT_THAT(capture.views, SizeIs(1));
    EXPECT_EQ(capture.views.front().name, view.name);
    EXPECT_EQ(capture.views.front().peer, view.peer);
    EXPECT_FALSE(capture.views.front().stretches.empty());
    EXPECT_EQ(contacts_of(capture.views.front()), contacts_of(view));
  }
}

TEST(RecordCapture, KnowsTheTruthOfOwnObjectsAlone) {
  const SimulatedFolder folder(kSnooker, "", SimulatedFolder::Captures::kAll);
  const Recording recording = must(record_capture({.path = folder.captures() / "a.pcapng"}, {}));
  const RecordedView& view = recording.views.front();
  std::size_t truths = 0;
  for (const Stretch& stretch : view.stretches) {
    read_frames(stretch, [&](double, std::span<const PoseRow> rows) {
      for (const PoseRow& row : rows) {
        if (static_cast<PoseKind>(row.kind) != PoseKind::kTruth || row.owner == 0) continue;
        EXPECT_EQ(row.owner, view.peer.value);
        ++truths;
      }
    });
  }
  EXPECT_GT(truths, 0u);
}

TEST(RecordCapture, SaysWhatIsNoCapture) {
  EXPECT_THAT(record_capture({.path = kSnooker}, {}).error().text, HasSubstr("this is no pcapng file"));
}

}  // namespace peerd::recorded::record_capture_test
