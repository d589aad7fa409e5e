#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/time.hpp"
#include "peerd/net/os/token_bucket.hpp"

namespace peerd {

// Lines that differ only in their numbers are of one kind: their text with "#" for each number.
[[nodiscard]] std::string kind_of_line(std::string_view text);

// Lets through a number of lines of each kind at once and then so many a second, and counts the lines that it leaves
// out (a token bucket for each kind). It reads no clock.
class LineLimiter {
 public:
  using Limits = net::TokenRate;  // in lines
  static constexpr Limits kLimits{100.0, 1.0};
  // Lines of one kind that were left out since the last report.
  struct LeftOut {
    std::string kind;
    std::uint64_t lines = 0;
  };

  explicit LineLimiter(Limits limits) : limits_(limits) {}
  // The next lines count by these.
  void limit(Limits limits) { limits_ = limits; }

  // Whether the line goes out. `now` does not run backwards.
  [[nodiscard]] bool admits(HostTime now, std::string_view text);
  // Takes what was left out, of each kind whose first line since its last report is kReportAfter old, or of all kinds.
  [[nodiscard]] std::vector<LeftOut> take_left_out(HostTime now);
  [[nodiscard]] std::vector<LeftOut> take_all_left_out();

  static constexpr Duration kReportAfter = std::chrono::seconds(10);
  // The kinds that are told apart; where there are more, the others count as one.
  static constexpr std::size_t kKindsMax = 1000;

 private:
  struct Kind {
    net::TokenBucket bucket;
    std::uint64_t left_out = 0;
    HostTime since{};  // of the first line left out
  };
  Kind& kind_of(HostTime now, std::string_view text);

  Limits limits_;
  std::map<std::string, Kind> kinds_;  // by kind_of_line()
};

}  // namespace peerd
