#pragma once
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "peerd/peer/config/scenario.hpp"
#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::testing_support {

// Scenarios as a test writes them into my.toml.
class ScenarioText : public testing::Test {
 protected:
  // `begin` stands before each text.
  explicit ScenarioText(std::string begin = "") : begin_(std::move(begin)) {}
  Result<config::Scenario> result(const std::string& text, std::vector<std::string> sets = {}) {
    request.file = folder.write("my.toml", begin_ + text);
    request.sets = std::move(sets);
    return config::read_scenario(request);
  }
  config::Scenario read(const std::string& text, std::vector<std::string> sets = {}) {
    return must(result(text, std::move(sets)));
  }
  std::string error(const std::string& text, std::vector<std::string> sets = {}) {
    const auto scenario = result(text, std::move(sets));
    if (scenario) {
      ADD_FAILURE() << "accepted";
      return "";
    }
    EXPECT_EQ(scenario.error().exit_code, 2);
    EXPECT_EQ(scenario.error().text.find('\n'), std::string::npos) << scenario.error().text;
    return scenario.error().text;
  }
  // `where`: what follows the name of the file and a colon.
  void expect_refused(const std::string& text, std::string_view where, const char* sentence) {
    const std::string found = error(text);
    EXPECT_THAT(found, testing::StartsWith((folder / "my.toml").string() + ":" + std::string(where)));
    EXPECT_THAT(found, testing::HasSubstr(sentence));
  }

  ScratchFolder folder;
  config::ScenarioRequest request;

 private:
  std::string begin_;
};

}  // namespace peerd::testing_support
