#include "peerd/lab/live/measuring.hpp"

#include <algorithm>
#include <charconv>
#include <limits>

#include "peerd/lab/measure/expectations.hpp"

namespace peerd {

Result<std::optional<std::size_t>> read_samples(const std::string& text) {
  if (text == "all") return std::nullopt;
  if (text == "none") return 0;
  std::size_t rows = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), rows);
  if (error != std::errc{} || end != text.data() + text.size()) {
    return std::unexpected(InputError{"error: --samples: \"" + text + "\" is not all, none or a number of rows"});
  }
  return rows;
}

Measuring measuring_of(const config::Scenario& scenario, std::size_t run, std::optional<std::size_t> csv_rows) {
  const auto share = [&](std::size_t most) {
    if (!csv_rows) return std::numeric_limits<std::size_t>::max();
    return std::max<std::size_t>(1, std::max(most, *csv_rows) / scenario.runs.size());
  };
  const measure::RowLimits all;
  return {.limits = {share(all.samples), share(all.updates), share(all.datagrams)},
          .parts = measure::measured_parts(scenario.expectations, run, scenario.runs[run].duration_s)};
}

}  // namespace peerd
