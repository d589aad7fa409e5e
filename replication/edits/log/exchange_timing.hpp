#pragma once
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <random>

#include "core/time.hpp"

namespace peerd::replication {

// The waiting times of the exchange of operations, all of them multiples of the delay d: how long it takes until others
// have received what one peer sends, and act on it. Times before which a peer asks or answers are random or a peer's
// own, so that most often one does it and the others receive that in time (SRM: Floyd et al. 1997).
class ExchangeTiming {
 public:
  // A shorter delay than that cannot be distinguished from the ticks at which peers send.
  static constexpr Duration kDelayMin = std::chrono::milliseconds(5);
  // What has come later than that was held up, as by a host that did not run, and others do not wait so long for each
  // other. Where all is so late, they ask and answer more often than need be.
  static constexpr Duration kDelayMax = std::chrono::milliseconds(600);
  // The longest time after which a peer asks again for what is still missing, and of an answer.
  static constexpr Duration kAgainMax = std::chrono::seconds(2);
  static constexpr std::size_t kRanksMax = 8;

  explicit ExchangeTiming(std::uint64_t seed) : random_(seed) {}
  void set_delay(Duration delay) { delay_ = std::clamp(delay, kDelayMin, kDelayMax); }

  // Until the first question; so many other members may ask the same. What has only been overtaken arrives before.
  [[nodiscard]] Duration ask_after(std::size_t others) {
    return delay_ + uniform(static_cast<std::int64_t>(std::clamp<std::size_t>(others, 1, kRanksMax)) * delay_);
  }
  // Until the question is asked again, for the n-th time (from 0): twice as long each time, and never less than an
  // answer of the second holder takes.
  [[nodiscard]] Duration ask_again_after(std::uint32_t n) {
    const Duration base = 5 * delay_;
    Duration wait = base;
    for (; n > 0 && wait < kAgainMax; --n) wait *= 2;
    return std::max(std::min(wait, kAgainMax), base) + uniform(delay_);
  }
  // Until a holder of that rank answers: later than the author's answer would arrive, and those of lower ranks. Among
  // `silent` other members, which may hold it too, the rank is not known.
  [[nodiscard]] Duration answer_after(std::size_t rank, std::size_t silent) {
    const auto random = static_cast<std::int64_t>(std::clamp<std::size_t>(silent, 1, kRanksMax)) * delay_;
    return static_cast<std::int64_t>(2 * (1 + std::min(rank, kRanksMax))) * delay_ + uniform(random);
  }
  // A question that arrives so soon after a part was sent may have crossed it. Whoever wants to ask later than that
  // has received the first question.
  [[nodiscard]] Duration crossing() const { return delay_; }
  // Ranges that somebody asked for need not be asked for again within that time.
  [[nodiscard]] Duration asked_for() const { return 5 * delay_; }

 private:
  [[nodiscard]] Duration uniform(Duration below) {
    assert(below > Duration{0});
    return Duration{static_cast<std::int64_t>(random_() % static_cast<std::uint64_t>(below.count()))};
  }

  std::mt19937_64 random_;
  Duration delay_ = kDelayMin;
};

}  // namespace peerd::replication
