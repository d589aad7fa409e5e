#pragma once
#include <cstddef>
#include <optional>
#include <string>

#include "peerd/input/input_error.hpp"
#include "peerd/lab/live/run_assembler.hpp"
#include "peerd/peer/config/scenario.hpp"

namespace peerd {

// The value of --samples: "all" (none), "none" (0) or the most rows of a CSV file.
[[nodiscard]] Result<std::optional<std::size_t>> read_samples(const std::string& text);

// What is kept and measured of one run of a scenario. All runs together keep a bounded number of rows, but for those
// that the CSV files are to have.
[[nodiscard]] Measuring measuring_of(const config::Scenario& scenario, std::size_t run,
                                     std::optional<std::size_t> csv_rows);

}  // namespace peerd
