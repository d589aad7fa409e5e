#pragma once
#include <algorithm>
#include <cstddef>

#include "core/time.hpp"

namespace peerd::relay {

// Limits the bytes that leave over a link: so many a second, and those of half a second at once. The last quarter of
// that is kept for what matters to all. It has no clock.
class ByteBudget {
 public:
  ByteBudget(double bytes_per_s, HostTime now) : rate_(bytes_per_s), left_(most()), counted_(now) {}

  // Takes that many bytes; false: there are not enough.
  [[nodiscard]] bool take(std::size_t bytes, bool for_all, HostTime now) {
    if (now > counted_) {
      left_ = std::min(most(), left_ + rate_ * to_seconds(now - counted_));
      counted_ = now;
    }
    const auto wanted = static_cast<double>(bytes);
    if (left_ - wanted < (for_all ? 0.0 : most() / 4.0)) return false;
    left_ -= wanted;
    return true;
  }

 private:
  [[nodiscard]] double most() const { return rate_ / 2.0; }

  double rate_;
  double left_;
  HostTime counted_;
};

}  // namespace peerd::relay
