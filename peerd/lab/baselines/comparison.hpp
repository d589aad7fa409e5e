#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "peerd/lab/baselines/responsiveness.hpp"
#include "peerd/lab/measure/run_record.hpp"

namespace peerd::baselines {

// Compared says what one system costs on a scenario, and how wrong it is. Errors are of views of
// objects that move, each view weighted alike.
struct Compared {
  std::string system;
  double simulated_s = 0.0, cpu_s = 0.0;  // of the simulation of all its computers together
  double bytes_per_s = 0.0, datagrams_per_s = 0.0;
  double shown_error_m = 0.0, worst_p99_m = 0.0;  // of what observers show, from the truth of the same instant
  double view_difference_m = 0.0;                 // between what an observer and the owner see
  // Medians over the views, and over keys and views. None: nothing moves, or no key moves anything.
  std::optional<double> own_delay_ms{}, others_delay_ms{}, key_to_own_ms{}, key_to_others_ms{};
  std::uint64_t outcomes = 0, missing = 0, spurious = 0;  // of collisions, against the run without latency
  std::uint64_t disagreed = 0;                            // statements of peers that differ from the decision
};
[[nodiscard]] Compared compared(const std::string& system, const measure::RunRecord& record, double cpu_s,
                                std::span<const KeyMove> keys);

// A row for each system.
[[nodiscard]] std::string table(std::span<const Compared> systems);
[[nodiscard]] nlohmann::ordered_json to_json(std::span<const Compared> systems);
// compare.html: bars of bytes, error and delay, and the table.
[[nodiscard]] std::string page(const std::string& title, std::span<const Compared> systems);

}  // namespace peerd::baselines
