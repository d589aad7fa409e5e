#include "peerd/lab/cluster/result_bytes.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <limits>
#include <random>

#include "peerd/lab/measure/summary.hpp"
#include "peerd/lab/report/write.hpp"
#include "tests/must.hpp"
#include "tests/peerd/report_samples.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::cluster::result_bytes_test {

// Every field has a value of its own.
RunResult full_result() {
  RunResult result{measure::samples::zigzag_run(0.1), {"one warning", "another"}};
  measure::RunRecord& run = result.record;
  run.params["network.latency_ms"] = 100;
  run.params["replication.order"] = nlohmann::ordered_json::array({1, 2.5, "x"});
  run.network_settings["network.loss"] = 0.1;
  run.seed = 77;
  run.stopped = true;
  run.peers[1].there_s = {{1.5, 2.5}, {3.25, 9.0}};
  run.scene_paths[ObjectId{3, 9}] = "WALL/SHAPE";
  run.outlines = {{ObjectId{10}, {{1.0, 2.0}, {-0.0, 4.0}}, -1.0, 1.5}, {std::nullopt, {{7.0, 8.0}}, 0.0, 0.5}};
  run.outlines_left_out = 4;
  run.ghost_samples[3].ghost.orientation = Quat(0.5, -0.5, 0.5, 0.5);
  measure::Measured part{
      .from_s = 1.0, .until_s = 2.0, .views = {}, .updates = {}, .datagrams = 8, .datagram_bytes = 900};
  part.views.push_back({PeerId{2}, ObjectId{10}, 3, {4, 0.1, 0.2, 0.3, 0.4, false}, {1, 2, 3, 4, 5, true}, {}, 6.5});
  part.updates[ObjectId{10}] = {5, 155};
  run.measured = measure::RunMeasured{part, false, {part, part}, {{PeerId{1}, {10, 0, 30}}}};
  run.contacts[0].type = CollisionType::kAllPairs;
  run.contacts[0].polygons = {70, {{{ObjectId{1}, 2}, {ObjectId{3}, 4}}}};
  run.events = {{0.5, "push"}};
  run.wrong = measure::WrongOutcomes{9, 1, 2};
  run.interest = measure::InterestRecord{100.0, 1.0, 2.0, 3, 4, 5, {{PeerId{1}, 1.5, 2, 3, 4, 5, 6, 7.5}}};
  run.network = measure::NetworkMeasured{{{PeerId{1}, PeerId{2}, 10, 1, 2, {5.5, 6.5}, 100, 3}}, {0.1}, {0.2, 0.3}};
  run.clocks = {{PeerId{3}, 10, 0.1, 0.2, 0.3, 0.4, 5}};
  run.groups_joined = 12;
  run.worlds_equal = false;
  return result;
}

TEST(RunBytes, AllFieldsComeBack) {
  const std::string bytes = to_bytes(full_result());
  const auto again = must(run_result_from(bytes));
  EXPECT_EQ(to_bytes(again), bytes);
  const measure::RunRecord& run = again.record;
  EXPECT_EQ(again.warnings, (std::vector<std::string>{"one warning", "another"}));
  EXPECT_EQ(run.params.dump(), full_result().record.params.dump());
  EXPECT_EQ(run.seed, 77U);
  EXPECT_TRUE(run.stopped);
  EXPECT_EQ(run.peers[1].there_s[1].second, 9.0);
  EXPECT_EQ(run.scene_paths.at(ObjectId{3, 9}), "WALL/SHAPE");
  EXPECT_EQ(run.ghost_samples[3].ghost.orientation.coeffs(), Quat(0.5, -0.5, 0.5, 0.5).coeffs());
  EXPECT_EQ(run.measured->parts[1].views[0].ghost_error_m.max, 0.4);
  EXPECT_EQ(run.contacts[0].polygons.pairs[0].collidee.polygon, 4U);
  EXPECT_EQ(run.interest->peers[0].groups, 7.5);
  EXPECT_EQ(run.network->links[0].delay_ms, (std::vector{5.5, 6.5}));
  EXPECT_FALSE(run.worlds_equal);
}

// A seeded generator changes one bit of a result; what is still read as one is another result.
TEST(RunBytes, NoBitIsWithoutMeaning) {
  const std::string bytes = to_bytes(full_result());
  std::mt19937_64 random(1);
  int refused = 0;
  for (int i = 0; i < 2000; ++i) {
    std::string other = bytes;
    const std::size_t at = random() % other.size();
    other[at] = static_cast<char>(other[at] ^ (1 << (random() % 8)));
    const auto result = run_result_from(other);
    if (result) {
      EXPECT_EQ(to_bytes(*result), other) << at;
    }
    refused += result ? 0 : 1;
  }
  EXPECT_GT(refused, 0);
}

TEST(RunBytes, APartOfAResultIsRefused) {
  const std::string bytes = to_bytes(full_result());
  for (std::size_t size = 0; size < bytes.size(); size += size < 2000 ? 1 : 97) {
    EXPECT_FALSE(run_result_from(std::string_view(bytes).substr(0, size))) << size;
  }
  EXPECT_FALSE(run_result_from(bytes + '\0'));
}

TEST(RunBytes, AnUnknownKindOfContactIsRefused) {
  RunResult result = full_result();
  result.record.contacts[0].type = static_cast<CollisionType>(3);
  EXPECT_FALSE(run_result_from(to_bytes(result)));
}

TEST(RunBytes, DoublesComeBackBitForBit) {
  const double signalling = std::bit_cast<double>(0x7ff0'0000'0000'0001U);
  const double payload = std::bit_cast<double>(0xfff8'1234'5678'9abcU);
  RunResult result;
  for (const double x : {0.0, -0.0, 0.1, 5e-324, std::numeric_limits<double>::max(),
                         -std::numeric_limits<double>::infinity(), signalling, payload}) {
    result.record.duration_s = x;
    const auto again = must(run_result_from(to_bytes(result)));
    EXPECT_EQ(std::bit_cast<std::uint64_t>(again.record.duration_s), std::bit_cast<std::uint64_t>(x));
  }
}

// The first value of a result is the JSON of its settings, behind the number of its bytes.
std::string with_json(const std::string& text) {
  RunResult result;
  const std::string bytes = to_bytes(result);
  std::string size(8, '\0');
  for (int i = 0; i < 8; ++i) size[static_cast<std::size_t>(i)] = static_cast<char>(text.size() >> (8 * i));
  return size + text + bytes.substr(8 + std::string("null").size());
}
std::string nested(int depth) {
  const auto brackets = static_cast<std::size_t>(depth);
  return std::string(brackets, '[') + std::string(brackets, ']');
}

TEST(RunBytes, JsonThatIsNeverWrittenIsRefused) {
  for (const char* text : {"null", "[1,2.5,\"x\",-0.0,18446744073709551615]", "{\"z\":1,\"a\":{\"k\":-5}}"}) {
    EXPECT_TRUE(run_result_from(with_json(text))) << text;
  }
  for (const char* text : {"", " null", "{", "[1, 2]", "{\"a\":1,\"a\":1}", "nan", "<discarded>", "\"\xff\""}) {
    EXPECT_FALSE(run_result_from(with_json(text))) << text;
  }
  EXPECT_TRUE(run_result_from(with_json(nested(16))));
  EXPECT_FALSE(run_result_from(with_json(nested(18))));
  EXPECT_FALSE(run_result_from(with_json(nested(1'000'000))));
}

TEST(RunBytes, ACountBeyondTheBytesIsRefusedBeforeAnythingIsMade) {
  std::string bytes = to_bytes(full_result());
  bytes[7] = 1;  // of the settings' text
  EXPECT_FALSE(run_result_from(bytes));
}

TEST(RunBytes, TheReportIsTheSame) {
  const testing_support::ScratchFolder folder;
  RunResult result = full_result();
  result.record.stopped = false;
  const auto again = must(run_result_from(to_bytes(result)));
  measure::ScenarioInfo info{.name = "s", .mode = "sim", .warnings = {}};
  ASSERT_TRUE(report::write_report(folder / "a", info, std::vector{result.record, result.record}));
  ASSERT_TRUE(report::write_report(folder / "b", info, std::vector{again.record, again.record}));
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "a")) {
    const auto name = entry.path().filename().string();
    EXPECT_EQ(testing_support::text_of(folder / ("b/" + name)), testing_support::text_of(entry.path())) << name;
    ++files;
  }
  EXPECT_EQ(files, 5);
}

chaos::ChaosReport full_report() {
  return {.seed = 1,
          .violations = {"a", "b"},
          .trace_hash = 0xfedc'ba98'7654'3210U,
          .peers = 2,
          .lives = 3,
          .faults = 4,
          .edits = 5,
          .operations = 6,
          .held = 7,
          .datagrams = 8,
          .damaged = 9,
          .one_world_after_s = 0.1,
          .branches = {{"x", 1}, {"y", 2}}};
}

TEST(ChaosBytes, AllFieldsComeBack) {
  const std::string bytes = to_bytes(full_report());
  const auto again = must(chaos_report_from(bytes));
  EXPECT_EQ(to_bytes(again), bytes);
  EXPECT_EQ(again.violations, full_report().violations);
  EXPECT_EQ(again.trace_hash, full_report().trace_hash);
  EXPECT_EQ(again.one_world_after_s, 0.1);
  EXPECT_EQ(again.branches, full_report().branches);
  EXPECT_EQ(again.damaged, 9U);
}

// The counts of rare branches are a map, whose keys ascend.
TEST(ChaosBytes, AKeyTwiceIsRefused) {
  std::string bytes = to_bytes(full_report());
  for (const char key : {'x', 'w'}) {
    bytes[bytes.rfind('y')] = key;
    EXPECT_FALSE(chaos_report_from(bytes)) << key;
    bytes = to_bytes(full_report());
  }
}

}  // namespace peerd::cluster::result_bytes_test
