#pragma once
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>

#include "peerd/lab/chaos/chaos_run.hpp"

namespace peerd::cluster {

// The findings of a run of one seed. The bytes begin with the number of their format (kChaosFormat).
inline constexpr std::uint32_t kChaosFormat = 1;
[[nodiscard]] std::string to_bytes(const chaos::ChaosReport& report);
// Parses hostile input; the error is one sentence.
[[nodiscard]] std::expected<chaos::ChaosReport, std::string> chaos_report_from(std::string_view bytes);

}  // namespace peerd::cluster
