#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace peerd::config {

// A number of summary.json that can be addressed by name, such as ghost_error_m.mean.
struct Measure {
  std::string_view name;  // dotted name in a run or in a row of `objects`
  bool of_view = false;   // one number for each observer and object, not one of the run
  bool error = false;     // has no value where a view has no samples
  bool window = true;     // can be computed for a part of the run
  bool yes_or_no = false;
};

// All measures except `counters`, whose names depend on what is counted.
[[nodiscard]] std::span<const Measure> measures();
// Finds a measure by its name. counters.NAME always is one.
[[nodiscard]] std::optional<Measure> find_measure(std::string_view name);

}  // namespace peerd::config
