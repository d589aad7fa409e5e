#include "replication/wire/loss_meter.hpp"

#include <algorithm>
#include <bit>
#include <cassert>

namespace peerd::replication {
namespace {

constexpr double kDecay = 1.0 / 1000.0;  // the part of the counts that is forgotten with each datagram

}  // namespace

void LossMeter::on_datagram(std::uint32_t number) {
  assert(number > 0);
  if (number > highest_) {
    const std::uint32_t ahead = number - highest_;
    const bool first = highest_ == 0;  // datagrams from before this peer listened were not lost
    if (ahead > kWindow && !first) {
      hole_ = number - kWindow;
    } else if (const std::uint64_t left_out = first ? 0 : ~(seen_ & ~marked_missing_) >> (kWindow - ahead);
               left_out != 0) {
      hole_ = highest_ - (kWindow - ahead) - static_cast<std::uint32_t>(std::countr_zero(left_out));
    }
    seen_ = first ? ~std::uint64_t{0} : ahead < kWindow ? seen_ << ahead | 1 : 1;
    marked_missing_ = ahead < kWindow ? marked_missing_ << ahead : 0;
    highest_ = number;
    const double newly = first ? 1 : std::min(ahead, kWindow);  // a gap counts for no more than the window
    sent_ = sent_ * (1.0 - kDecay) + newly;
    lost_ = lost_ * (1.0 - kDecay) + newly - 1.0;
    assert(lost_ >= 0.0 && lost_ <= sent_);
    return;
  }
  const std::uint32_t behind = highest_ - number;
  if (behind < kWindow && (seen_ >> behind & 1) != 0) {
    ++duplicates_;
    marked_missing_ &= ~(std::uint64_t{1} << behind);
    return;
  }
  ++overtaken_;
  if (behind >= kWindow) return;
  seen_ |= std::uint64_t{1} << behind;
  lost_ = std::max(0.0, lost_ - 1.0);
}

void LossMeter::mark_as_missing(std::uint32_t number) {
  if (number == 0 || number > highest_ || highest_ - number >= kWindow) return;
  marked_missing_ |= std::uint64_t{1} << (highest_ - number);
}

Received LossMeter::received() const {
  const std::uint64_t used = seen_ & ~marked_missing_;
  const auto in_window = static_cast<std::uint32_t>(std::countr_one(used));
  const std::uint32_t run = in_window < kWindow ? in_window : highest_ - hole_;
  return {highest_, std::min({run, highest_, Received::kRunMax}), used};
}

std::uint32_t copies_against(double loss, std::uint32_t most) {
  assert(loss >= 0.0 && loss <= 1.0);
  if (loss < kLossMin) return 1;
  std::uint32_t copies = 1;
  for (double all_lost = loss; all_lost > kAllLostMax && copies < most; all_lost *= loss) ++copies;
  return copies;
}

}  // namespace peerd::replication
