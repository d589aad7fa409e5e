#pragma once
#include <algorithm>
#include <cstdint>

#include "core/time.hpp"

namespace peerd::net {

// Times as they are handed to a peer, which must not run backwards: the later of each and the last one.
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
  // How many were earlier than one before, and by how much at most.
  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] Duration most() const { return most_; }

 private:
  HostTime last_ = HostTime::min();
  std::uint64_t count_ = 0;
  Duration most_{0};
};

}  // namespace peerd::net
