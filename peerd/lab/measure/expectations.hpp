#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/lab/measure/meter.hpp"
#include "peerd/lab/measure/run_record.hpp"
#include "peerd/peer/config/expectations.hpp"

namespace peerd::measure {

// A number that is not as expected.
struct Failure {
  std::size_t run = 0;           // index of the run
  std::string object, observer;  // empty: the number is of the whole run
  nlohmann::ordered_json found;  // null: there is no such number, and `why` says the reason
  std::string why;
};

// An expectation and the result of its check. It holds when it was checked and nothing failed.
struct CheckedExpectation {
  config::Expectation expected;
  std::uint64_t values = 0;  // number of values that were compared
  std::vector<Failure> failures;

  [[nodiscard]] bool failed() const { return !failures.empty(); }
  // Whether any number was compared. It was not where settings over the scenario have left no run to check, or where it
  // is about the other mode.
  [[nodiscard]] bool checked() const { return values > 0 || failed(); }
};

// The parts of a run that expectations are about, which a RunMeter must be given. `run` is the run's index.
[[nodiscard]] std::vector<TimeSpan> measured_parts(std::span<const config::Expectation> expectations, std::size_t run,
                                                   double duration_s);

// Checks all expectations. `mode` is "sim" or "real". `run_rows` are the runs of summary.json, and `runs` the records
// that they were made of, for checks of a part of a run.
[[nodiscard]] std::vector<CheckedExpectation> check_expectations(std::span<const config::Expectation> expectations,
                                                                 const std::string& mode,
                                                                 std::span<const RunRecord> runs,
                                                                 const nlohmann::ordered_json& run_rows);

// The expectation in words: "ghost_error_m.mean <= 0.05 of CAR at b, from 8 s".
[[nodiscard]] std::string describe(const config::Expectation& e);

// The part `expectations` of summary.json (docs/reference/measures.md, "Expectations").
[[nodiscard]] nlohmann::ordered_json expectations_json(std::span<const CheckedExpectation> checked);

// A text for the terminal: one line for the expectations that hold and a table of those that do not. It is empty
// without expectations, else it ends with a line feed.
[[nodiscard]] std::string expectations_table(std::span<const CheckedExpectation> checked,
                                             const nlohmann::ordered_json& run_rows);

}  // namespace peerd::measure
