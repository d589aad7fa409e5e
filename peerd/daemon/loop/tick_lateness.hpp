#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>

#include "core/time.hpp"

namespace peerd {

// A histogram of how late ticks ran. Of consecutive missed ticks the first counts. Its memory is constant.
class TickLateness {
 public:
  static constexpr Duration kStep = std::chrono::microseconds(100);

  void add(Duration late) {
    const auto step = static_cast<std::size_t>(std::max(Duration{0}, late) / kStep);
    ++counts_[std::min(step, counts_.size() - 1)];
    ++count_;
    most_ = std::max(most_, late);
  }
  // The 99th percentile, rounded up to kStep.
  [[nodiscard]] Duration p99() const {
    std::uint64_t below = 0;
    for (std::size_t i = 0; i + 1 < counts_.size(); ++i) {
      below += counts_[i];
      if (below * 100 >= count_ * 99) return kStep * static_cast<std::int64_t>(i + 1);
    }
    return most_;
  }
  [[nodiscard]] Duration most() const { return most_; }
  // How many ticks ran later than that, which is a multiple of kStep below 0.1 s.
  [[nodiscard]] std::uint64_t later_than(Duration late) const {
    const auto first = counts_.begin() + late / kStep;
    return std::accumulate(first, counts_.end(), std::uint64_t{0});
  }
  [[nodiscard]] std::uint64_t count() const { return count_; }

 private:
  std::array<std::uint64_t, 1001> counts_{};  // the last one counts 0.1 s and more
  std::uint64_t count_ = 0;
  Duration most_{0};
};

}  // namespace peerd
