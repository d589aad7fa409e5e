#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/config/expectations.hpp"
#include "peerd/measure/run_record.hpp"

namespace peerd::report {

// A number that is not as expected.
struct Failure {
  std::size_t run = 0;           // index
  std::string object, observer;  // empty where the number is the run's
  nlohmann::ordered_json found;  // null: there is no such number, and `why` says so
  std::string why;
};

// What became of an expectation. It holds when it was checked at all and nothing failed.
struct CheckedExpectation {
  config::Expectation expected;
  std::uint64_t values = 0;  // that were compared
  std::vector<Failure> failures;

  [[nodiscard]] bool failed() const { return !failures.empty(); }
  // False: settings laid over the scenario have left no run that it is about, or it is about another mode.
  [[nodiscard]] bool checked() const { return values > 0 || failed(); }
};

// mode: "sim" or "real". `run_rows` are summary.json's runs; `runs` what they were made of, for a part of their time.
[[nodiscard]] std::vector<CheckedExpectation> check_expectations(std::span<const config::Expectation> expectations,
                                                                 const std::string& mode,
                                                                 std::span<const RunRecord> runs,
                                                                 const nlohmann::ordered_json& run_rows);

// "ghost_error_m.mean <= 0.05 of CAR at b, from 8 s".
[[nodiscard]] std::string describe(const config::Expectation& e);

// For summary.json (README: "Expectations").
[[nodiscard]] nlohmann::ordered_json expectations_json(std::span<const CheckedExpectation> checked);

// For the terminal: a line for what holds, a table of what doesn't. "" without expectations; ends with a line feed.
[[nodiscard]] std::string expectations_table(std::span<const CheckedExpectation> checked,
                                             const nlohmann::ordered_json& run_rows);

}  // namespace peerd::report
