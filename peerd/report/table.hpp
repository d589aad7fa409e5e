#pragma once
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "peerd/measure/columns.hpp"

namespace peerd::report {

// The path of the object that the table and the pictures show: the one with the greatest mean ghost error, summed over
// all runs and observers; then the one with the most updates; then the first. It is empty if there is none.
[[nodiscard]] std::string principal_object(const nlohmann::ordered_json& summary);

// One row for each run, or from three observers on for each run and observer: number, swept keys, updates of the
// principal object, its ghost's errors [m] in the words of `error_text`, and the bytes/s of all peers.
using ErrorText = std::string (*)(double error_m);
[[nodiscard]] std::vector<Column> run_columns(const nlohmann::ordered_json& summary, ErrorText error_text);

// The summary for a terminal, at most 100 columns wide with two observers: a row for each run; from three observers on,
// for each run and observer; of repeated runs, for each point and observer. It ends with a line feed.
[[nodiscard]] std::string table(const nlohmann::ordered_json& summary);

// The collisions that peers decided otherwise than the truth without latency, summed: a row for each policy, a column
// for each combination of the other swept keys. It is empty where no run was compared, else it ends with a line feed.
[[nodiscard]] std::string wrong_outcomes_table(const nlohmann::ordered_json& summary);

}  // namespace peerd::report
