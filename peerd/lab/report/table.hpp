#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "peerd/input/console/columns.hpp"
#include "peerd/lab/measure/run_record.hpp"
#include "peerd/lab/measure/summary.hpp"

namespace peerd::report {

// The paths of the objects with the greatest mean ghost errors, summed over all runs and observers; then of those with
// the most updates; then of the first.
[[nodiscard]] std::vector<std::string> worst_objects(const nlohmann::ordered_json& summary, std::size_t most);

// The path of the object that the table and the figures show: the first of worst_objects(). It is empty if there is
// none.
[[nodiscard]] std::string principal_object(const nlohmann::ordered_json& summary);

// One row for each run, or from three observers on for each run and observer: number, swept keys, updates of the
// principal object, its ghost's errors [m] in the words of `error_text`, and the bytes/s of all peers.
using ErrorText = std::string (*)(double error_m);
[[nodiscard]] std::vector<Column> run_columns(const nlohmann::ordered_json& summary, ErrorText error_text);

// The principal object is marked in lists of objects by this.
inline constexpr std::string_view kPrincipalMark = "*";

// One row for each object that a peer observes, over all runs and observers, in the order of worst_objects(), at most
// `most` of them: the mark, path, owner, updates a run, and the mean of the means, the greatest p99 and the greatest
// maximum of its ghosts' errors [m].
[[nodiscard]] std::vector<Column> object_columns(const nlohmann::ordered_json& summary, std::size_t most,
                                                 ErrorText error_text);

// The worst objects for a terminal, at most 80 columns wide. It is empty where there is but one, which table() shows.
[[nodiscard]] std::string objects_table(const nlohmann::ordered_json& summary);

// The contacts of all runs for a terminal, and those of one run for a page: how many, how many in a second, the deepest
// overlap, the energy. Empty where nothing has met or is in anything else.
[[nodiscard]] std::string contacts_lines(const nlohmann::ordered_json& summary);
[[nodiscard]] std::string contacts_line(const nlohmann::ordered_json& run);

// The summary for a terminal, at most 100 columns wide with two observers: a row for each run; from three observers on,
// for each run and observer; of repeated runs, for each point and observer. Above them are the settings of the network
// that no column shows. It ends with a line feed.
[[nodiscard]] std::string table(const nlohmann::ordered_json& summary);

// The collisions that peers decided otherwise than the truth without latency, summed: a row for each policy, a column
// for each combination of the other swept keys. It is empty where no run was compared, else it ends with a line feed.
[[nodiscard]] std::string wrong_outcomes_table(const nlohmann::ordered_json& summary);

// A sentence without its full stop about tables that have only some of the rows; empty where they have all.
[[nodiscard]] std::string thinned_rows(const measure::ScenarioInfo& info, std::span<const measure::RunRecord> runs);

}  // namespace peerd::report
