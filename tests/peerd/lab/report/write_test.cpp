#include "peerd/lab/report/write.hpp"

#include <gmock/gmock.h>

#include <fstream>
#include <set>

#include "tests/must.hpp"
#include "tests/peerd/report_samples.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::report::write_test {

namespace fs = std::filesystem;
using testing_support::text_of;

const measure::ScenarioInfo kInfo{"zigzag", "sim", 7, {}};

class WriteReport : public testing::Test {
 protected:
  [[nodiscard]] std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(dir_)) names.insert(entry.path().filename().string());
    return names;
  }

  testing_support::ScratchFolder folder_;
  const fs::path dir_ = folder_ / "report";
};

TEST_F(WriteReport, WritesEverythingAndTheSameAgain) {
  const std::vector<measure::RunRecord> runs = measure::samples::zigzag_sweep();
  ASSERT_TRUE(write_report(dir_ / "deep" / "first", kInfo, runs).has_value());
  ASSERT_TRUE(write_report(dir_ / "deep" / "second", kInfo, runs).has_value());
  const fs::path first = dir_ / "deep" / "first";
  std::size_t count = 0;
  for (const auto& entry : fs::directory_iterator(first)) {
    ++count;
    EXPECT_EQ(text_of(entry.path()), text_of(dir_ / "deep" / "second" / entry.path().filename())) << entry.path();
    EXPECT_GT(fs::file_size(entry.path()), 100u);
  }
  EXPECT_EQ(count, 5u);
  EXPECT_EQ(nlohmann::ordered_json::parse(text_of(first / "summary.json")), measure::summarise(kInfo, runs));
}

TEST_F(WriteReport, RemovesThePicturesOfEarlierVersionsAndNothingElse) {
  fs::create_directories(dir_);
  for (const char* name : {"run-004.svg", "timeline-1000.svg", "overview.svg", "pareto.svg", "multiples.svg",
                           "plan.svg", "run-004-mine.svg", "notes.txt"})
    std::ofstream(dir_ / name) << "old";
  ASSERT_TRUE(write_report(dir_, kInfo, measure::samples::zigzag_sweep()).has_value());
  EXPECT_THAT(files(), testing::UnorderedElementsAre("summary.json", "errors.csv", "traffic.csv", "collisions.csv",
                                                     "report.html", "run-004-mine.svg", "notes.txt"));
}

TEST_F(WriteReport, SaysWhichFileItCannotWrite) {
  fs::create_directories(dir_ / "errors.csv");  // a folder where a file should go
  const std::vector<measure::RunRecord> runs{measure::samples::zigzag_run(0.1)};
  EXPECT_THAT(error_of(write_report(dir_, kInfo, runs)), testing::HasSubstr("errors.csv"));
}

TEST_F(WriteReport, AFileInPlaceOfTheFolderIsAnError) {
  std::ofstream(dir_.string()) << "in the way";
  EXPECT_THAT(error_of(write_report(dir_, kInfo, {})), testing::HasSubstr(dir_.filename().string()));
}

TEST_F(WriteReport, NamesThatAreNotUtf8AreWrittenAnyway) {
  measure::RunRecord run = measure::samples::zigzag_run(0.1);
  run.objects[0].path = "CAR\xff";
  ASSERT_TRUE(write_report(dir_, kInfo, {&run, 1}).has_value());
  EXPECT_TRUE(nlohmann::json::accept(text_of(dir_ / "summary.json")));
}

}  // namespace peerd::report::write_test
