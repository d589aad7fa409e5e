#include "peerd/lab/recorded/record_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <tuple>

#include <nlohmann/json.hpp>

#include "peerd/lab/recorded/stretch_reader.hpp"
#include "tests/must.hpp"
#include "tests/peerd/lab/recorded/recorded_run.hpp"

namespace peerd::recorded::record_run_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;
using testing_support::SimulatedFolder;
using testing_support::text_of;
using view::PoseKind;
using view::PoseRow;

const std::string kScenarios = PEERD_SOURCE_DIR "/configs/scenarios/";
const std::string kOneRun =
    "--set 'replication.approach=\"dr+rcp+acpt\"' --set replication.order=2 --set network.latency_ms=100";

// The distances of ghosts from truths that the report has, by observer, object and instant [ms].
std::map<std::tuple<std::string, std::string, long>, double> errors_in(const std::filesystem::path& csv) {
  std::map<std::tuple<std::string, std::string, long>, double> errors;
  std::ifstream file(csv);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::vector<std::string> cells;
    std::stringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    errors[{cells.at(2), cells.at(3), std::lround(1e3 * std::stod(cells.at(1)))}] = std::stod(cells.at(13));
  }
  return errors;
}

TEST(RecordRun, HasTheErrorsThatTheReportHas) {
  const SimulatedFolder folder(kScenarios + "eq47.toml", kOneRun);
  const Recording recording = must(record_run(must(read_run(folder.run(), 1)), {}));
  EXPECT_THAT(recording.notes, ElementsAre()) << "it is the run of the report";
  ASSERT_THAT(recording.views, SizeIs(3));
  EXPECT_DOUBLE_EQ(recording.end_s, 15.0);

  const auto reported = errors_in(folder.run() / "errors.csv");
  int compared = 0;
  double largest_m = 0;
  for (const RecordedView& view : recording.views) {
    const auto& nodes = view.scenes.front().nodes;
    for (const Stretch& stretch : view.stretches) {
      std::map<std::uint32_t, Vec3> truths, ghosts;
      read_frames(stretch, [&](double t_s, std::span<const PoseRow> rows) {
        for (const PoseRow& row : rows) {
          auto& places = static_cast<PoseKind>(row.kind) == PoseKind::kTruth ? truths : ghosts;
          if (static_cast<PoseKind>(row.kind) != PoseKind::kShown) {
            places[row.node] = {row.position[0], row.position[1], row.position[2]};
          }
        }
        for (const auto& [node, ghost] : ghosts) {
          const auto row = reported.find({view.name, nodes.at(node).path, std::lround(1e3 * t_s)});
          if (row == reported.end() || !truths.contains(node)) continue;  // the report has those of others alone
          // A datagram of the very instant may be in the one and not yet in the other: that is a step, and rare.
          const double error_m = (truths.at(node) - ghost).norm();
          if (std::abs(error_m - row->second) < 1e-5) ++compared;
          largest_m = std::max(largest_m, error_m);
        }
      });
    }
  }
  EXPECT_GT(largest_m, 0.5) << "the car's ghosts are wrong";
  EXPECT_GT(compared, 3'500) << "of 4 + 2 x 1 ghosts of others, 450 instants each but those of a report alone";
}

TEST(RecordRun, FollowsTheSceneOverEdits) {
  const SimulatedFolder folder(kScenarios + "edits.toml");
  const Recording recording = must(record_run(must(read_run(folder.run(), 1)), {}));
  EXPECT_THAT(recording.notes, ElementsAre());
  for (const RecordedView& view : recording.views) {
    EXPECT_GT(view.scenes.size(), 1u) << "objects come and go";
    for (const Stretch& stretch : view.stretches) {
      std::uint32_t nodes = 0;
      for (const SceneRevision& scene : view.scenes) {
        if (scene.revision == stretch.revision) nodes = static_cast<std::uint32_t>(scene.nodes.size());
      }
      read_frames(stretch, [&](double, std::span<const PoseRow> rows) {
        for (const PoseRow& row : rows) EXPECT_LT(row.node, nodes);
      });
    }
  }
}

TEST(RecordRun, LeavesOutWhatDoesNotFit) {
  const SimulatedFolder folder(kScenarios + "eq47.toml", kOneRun);
  const Recording recording = must(record_run(must(read_run(folder.run(), 1)), {.most_bytes = 50'000}));
  EXPECT_LT(recording.end_s, 15.0);
  EXPECT_GT(recording.end_s, 0.0);
  EXPECT_LT(size_bytes(recording), 100'000u);
  ASSERT_THAT(recording.notes, SizeIs(1));
  EXPECT_THAT(recording.notes.front(), HasSubstr("--memory allows more"));
}

TEST(RecordRun, IsNotTheReportWhereThatIsOfAnotherRun) {
  const SimulatedFolder folder(kScenarios + "eq47.toml", kOneRun);
  auto summary = nlohmann::json::parse(text_of(folder.run() / "summary.json"));
  summary["runs"][0]["traffic"]["packets"] = 1;
  std::ofstream(folder.run() / "summary.json") << summary;
  const Recording recording = must(record_run(must(read_run(folder.run(), 1)), {}));
  ASSERT_THAT(recording.notes, SizeIs(1));
  EXPECT_THAT(recording.notes.front(), HasSubstr("is not what the report says"));
}

TEST(RecordRun, SaysWhatAFolderIsThatItCannotShow) {
  const SimulatedFolder folder(kScenarios + "eq47.toml", kOneRun);
  EXPECT_THAT(read_run(folder.run().parent_path(), 1).error().text, HasSubstr("it has no summary.json"));
  EXPECT_THAT(read_run(folder.run(), 2).error().text, HasSubstr("it has runs 1 to 1"));
  const std::string rerun = text_of(folder.run() / record::kRerunFile);
  std::ofstream(folder.run() / record::kRerunFile) << rerun.substr(0, rerun.size() / 2);
  EXPECT_THAT(read_run(folder.run(), 1).error().text, HasSubstr("can't be read"));
  std::filesystem::remove(folder.run() / record::kRerunFile);
  EXPECT_THAT(read_run(folder.run(), 1).error().text, HasSubstr("an older peerd"));
  auto summary = nlohmann::json::parse(text_of(folder.run() / "summary.json"));
  summary["mode"] = "real";
  std::ofstream(folder.run() / "summary.json") << summary;
  EXPECT_THAT(read_run(folder.run(), 1).error().text, HasSubstr("real processes"));
}

}  // namespace peerd::recorded::record_run_test
