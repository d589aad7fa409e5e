#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "peerd/lab/measure/statistics/statistics.hpp"

namespace peerd::measure {

// The statistics of samples that come one by one and are not kept. Samples are at least 0.
//
// Mean, rms and max are those of statistics(), to the bit. So is the p99 of up to kExactSamples samples: the sample of
// rank ceil(0.99 n) is the one of rank floor(n / 100) + 1 from the top, so that a hundredth of the samples suffices.
// Beyond that, samples are counted in classes whose bounds grow by a constant factor (Masson et al., *DDSketch*, VLDB
// 2019), and the p99 is within kP99Error of itself, or 0 below kLeastClass.
class RunningStatistics {
 public:
  static constexpr std::uint64_t kExactSamples = 1'000'000;
  static constexpr double kP99Error = 0.005;    // relative
  static constexpr double kLeastClass = 1e-12;  // smaller samples count as 0 in classes

  // `most_samples`: no more than these will come.
  explicit RunningStatistics(std::uint64_t most_samples);

  void add(double sample);
  [[nodiscard]] Statistics result() const;

 private:
  [[nodiscard]] double p99_of_classes() const;

  std::uint64_t most_samples_;
  std::uint64_t count_ = 0;
  double sum_ = 0.0, sum_of_squares_ = 0.0, max_ = 0.0;
  std::vector<double> greatest_;               // a heap, the least in front; samples of 0 are left out
  std::map<int, std::uint64_t> classes_ = {};  // by the exponent of the upper bound; only where the samples may be many
};

}  // namespace peerd::measure
