#include "peerd/lab/measure/statistics/running_statistics.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>

namespace peerd::measure {
namespace {

// The bounds of a class: the middle of both is within kP99Error of either.
constexpr double kClassFactor = (1.0 + RunningStatistics::kP99Error) / (1.0 - RunningStatistics::kP99Error);

// The number of samples from the p99 upwards.
std::uint64_t from_p99(std::uint64_t count) { return count / 100 + 1; }

}  // namespace

RunningStatistics::RunningStatistics(std::uint64_t most_samples) : most_samples_(most_samples) {}

void RunningStatistics::add(double sample) {
  assert(sample >= 0.0);
  assert(count_ < most_samples_);
  ++count_;
  sum_ += sample;
  sum_of_squares_ += sample * sample;
  max_ = std::max(max_, sample);
  if (most_samples_ > kExactSamples) {
    if (sample >= kLeastClass) ++classes_[static_cast<int>(std::ceil(std::log(sample) / std::log(kClassFactor)))];
    if (count_ > kExactSamples) return greatest_ = {}, void();
  }
  if (sample == 0.0) return;
  const std::uint64_t most = from_p99(std::min(most_samples_, kExactSamples));
  if (greatest_.size() == most && sample <= greatest_.front()) return;
  if (greatest_.size() == most) {
    std::ranges::pop_heap(greatest_, std::greater{});
    greatest_.pop_back();
  }
  if (greatest_.empty() && most < 64) greatest_.reserve(most);  // many short series: no room is left over
  greatest_.push_back(sample);
  std::ranges::push_heap(greatest_, std::greater{});
}

double RunningStatistics::p99_of_classes() const {
  std::uint64_t above = from_p99(count_);
  for (auto it = classes_.rbegin(); it != classes_.rend(); ++it) {
    if (it->second >= above) return 2.0 * std::pow(kClassFactor, it->first) / (kClassFactor + 1.0);
    above -= it->second;
  }
  return 0.0;
}

Statistics RunningStatistics::result() const {
  Statistics s{.count = count_};
  if (count_ == 0) return s;
  const auto n = static_cast<double>(count_);
  s.mean = sum_ / n;
  s.rms = std::sqrt(sum_of_squares_ / n);
  s.max = max_;
  s.p99_exact = count_ <= kExactSamples;
  if (!s.p99_exact) {
    s.p99 = p99_of_classes();
    return s;
  }
  std::vector<double> sorted = greatest_;
  std::ranges::sort(sorted, std::greater{});
  const std::uint64_t rank = from_p99(count_);
  s.p99 = rank <= sorted.size() ? sorted[rank - 1] : 0.0;
  return s;
}

}  // namespace peerd::measure
