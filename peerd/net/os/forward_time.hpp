#pragma once
#include <algorithm>
#include <cstdint>

#include "core/time.hpp"

namespace peerd::net {

// Makes a row of times monotonic, as a peer demands: each result is the later of the argument and the last result.
class ForwardTime {
 public:
  HostTime operator()(HostTime at) {
    if (at < last_) {
      ++count_;
      most_ = std::max(most_, last_ - at);
    }
    last_ = std::max(last_, at);
    return last_;
  }
  // The number of arguments that were earlier than one before them, and the greatest such difference.
  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] Duration most() const { return most_; }

 private:
  HostTime last_ = HostTime::min();
  std::uint64_t count_ = 0;
  Duration most_{0};
};

}  // namespace peerd::net
