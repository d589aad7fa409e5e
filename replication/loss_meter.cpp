#include "replication/loss_meter.hpp"

#include <algorithm>

namespace peerd::replication {
namespace {

constexpr double kForgets = 1.0 / 1000.0;  // of what was counted, with each datagram
constexpr std::uint32_t kWindow = 64;      // later than by so many, a datagram stays lost; no gap counts for more

}  // namespace

void LossMeter::on_datagram(std::uint32_t number) {
  if (number > highest_) {
    const std::uint32_t ahead = number - highest_;
    const bool first = highest_ == 0;  // what went before this peer listened is no loss
    seen_ = first ? ~std::uint64_t{0} : ahead < kWindow ? seen_ << ahead | 1 : 1;
    if (!first) missing_ += ahead - 1;
    highest_ = number;
    const double newly = first ? 1 : std::min(ahead, kWindow);
    sent_ = sent_ * (1.0 - kForgets) + newly;
    lost_ = lost_ * (1.0 - kForgets) + newly - 1.0;
    return;
  }
  const std::uint32_t behind = highest_ - number;
  if (behind < kWindow && (seen_ >> behind & 1) != 0) {
    ++duplicates_;
    return;
  }
  ++overtaken_;
  if (behind >= kWindow) return;
  seen_ |= std::uint64_t{1} << behind;
  lost_ = std::max(0.0, lost_ - 1.0);
}

std::uint32_t copies_against(double loss, std::uint32_t most) {
  if (loss < kLossMin) return 1;
  std::uint32_t copies = 1;
  for (double all_lost = loss; all_lost > kAllLostMax && copies < most; all_lost *= loss) ++copies;
  return copies;
}

}  // namespace peerd::replication
