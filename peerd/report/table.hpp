#pragma once
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/measure/columns.hpp"

namespace peerd::report {

// The object that the table and the pictures are about: the one with the greatest mean ghost error, summed over all
// runs and observers; then the most updates; then the first. "" if there is none.
[[nodiscard]] std::string principal_object(const nlohmann::ordered_json& summary);

// A row a run, or from three observers on a run and an observer: number, swept keys, updates of the principal object,
// its ghost's errors [m] in the words of `error_text`, bytes/s of everybody.
using ErrorText = std::string (*)(double error_m);
[[nodiscard]] std::vector<Column> run_columns(const nlohmann::ordered_json& summary, ErrorText error_text);

// The summary for a terminal, a row a run, at most 100 columns wide with two observers; from three observers on a row
// is a run and an observer. Of runs that were repeated, a row is a point and an observer. Ends with a line feed.
[[nodiscard]] std::string table(const nlohmann::ordered_json& summary);

// Collisions that peers decided wrongly against the truth without latency, summed: a row for each policy, a column for
// each combination of the other swept keys. "" where no run was compared. Ends with a line feed.
[[nodiscard]] std::string wrong_outcomes_table(const nlohmann::ordered_json& summary);

}  // namespace peerd::report
