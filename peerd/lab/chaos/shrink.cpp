#include "peerd/lab/chaos/shrink.hpp"

#include <algorithm>
#include <cassert>
#include <vector>

namespace peerd::chaos {
namespace {

constexpr std::size_t kPeersLeast = 2;

class Shrinker {
 public:
  Shrinker(std::uint64_t seed, const ChaosLimits& limits, const std::function<bool(const ChaosLimits&)>& fails,
           std::size_t runs_max)
      : seed_(seed), best_{limits, 0}, fails_(fails), runs_max_(runs_max) {}

  Shrunk all() {
    shorten();
    drop_peers();
    drop(&ChaosLimits::without_faults, &numbers_of_faults);
    drop(&ChaosLimits::without_edits, &numbers_of_edits);
    return best_;
  }

 private:
  // Takes the smaller run where it still fails.
  bool take(const ChaosLimits& smaller) {
    if (best_.runs == runs_max_) return false;
    ++best_.runs;
    if (!fails_(smaller)) return false;
    best_.limits = smaller;
    return true;
  }

  // A run of another length has its faults and edits at other times.
  void shorten() {
    for (const double part : {0.25, 0.5}) {
      ChaosLimits smaller = best_.limits;
      smaller.seconds = std::max(smaller.seconds * part, ChaosLimits::kSecondsMin);
      if (smaller.seconds < best_.limits.seconds && take(smaller)) return;
    }
  }

  void drop_peers() {
    for (std::size_t peers = draw_plan(seed_, best_.limits).peers.size(); peers > kPeersLeast; --peers) {
      ChaosLimits smaller = best_.limits;
      smaller.peers = peers - 1;
      if (!take(smaller)) return;
    }
  }

  static std::vector<std::uint32_t> numbers_of_faults(const ChaosPlan& plan) {
    std::vector<std::uint32_t> numbers;
    for (const Fault& fault : plan.faults) numbers.push_back(fault.number);
    return numbers;
  }
  static std::vector<std::uint32_t> numbers_of_edits(const ChaosPlan& plan) {
    std::vector<std::uint32_t> numbers;
    for (const PlannedEdit& edit : plan.edits) numbers.push_back(edit.number);
    return numbers;
  }

  // Leaves out halves, then quarters, down to single ones (after Zeller and Hildebrandt 2002).
  void drop(std::set<std::uint32_t> ChaosLimits::*without, std::vector<std::uint32_t> (*numbers_of)(const ChaosPlan&)) {
    std::size_t size = numbers_of(draw_plan(seed_, best_.limits)).size();
    for (; size > 0; size /= 2) {
      const std::vector<std::uint32_t> numbers = numbers_of(draw_plan(seed_, best_.limits));
      for (std::size_t from = 0; from < numbers.size(); from += size) {
        ChaosLimits smaller = best_.limits;
        const std::size_t to = std::min(numbers.size(), from + size);
        for (std::size_t i = from; i < to; ++i) (smaller.*without).insert(numbers[i]);
        take(smaller);
      }
    }
  }

  std::uint64_t seed_;
  Shrunk best_;
  const std::function<bool(const ChaosLimits&)>& fails_;
  std::size_t runs_max_;
};

}  // namespace

Shrunk shrink(std::uint64_t seed, const ChaosLimits& limits, const std::function<bool(const ChaosLimits&)>& fails,
              std::size_t runs_max) {
  assert(fails);
  return Shrinker(seed, limits, fails, runs_max).all();
}

}  // namespace peerd::chaos
