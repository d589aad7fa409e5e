#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace peerd::report {

// A number of summary.json that can be asked for by name, such as ghost_error_m.mean.
struct Measure {
  std::string_view name;  // dotted, from the run or from the row of `objects`
  bool of_view = false;   // of what one observer made of one object, not of the run
  bool error = false;     // nothing where a view has no samples
  bool window = true;     // there is one of a part of the run
  bool yes_or_no = false;
};

// All of them but those of `counters`, whose names come with what is counted.
[[nodiscard]] std::span<const Measure> measures();
// By name; counters.NAME always is one.
[[nodiscard]] std::optional<Measure> find_measure(std::string_view name);

}  // namespace peerd::report
