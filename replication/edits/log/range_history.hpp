#pragma once
#include <cstddef>
#include <deque>
#include <vector>

#include "core/time.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::replication {

// Takes the bytes of `what` out of ascending ranges.
void subtract(const OperationRange& what, std::vector<OperationRange>& from);

// Ranges of logs that peers have sent or asked for lately, so that nobody does so again.
class RangeHistory {
 public:
  // The times of two calls do not descend.
  void note(HostTime at, const OperationRange& range);
  void forget_before(HostTime time);
  // The bytes of these ranges that have not been noted since then.
  [[nodiscard]] std::vector<OperationRange> without(std::vector<OperationRange> ranges, HostTime since) const;
  [[nodiscard]] std::size_t size() const { return entries_.size(); }

 private:
  // More entries are forgotten early, which costs bytes and no more.
  static constexpr std::size_t kMost = 4096;
  struct Entry {
    OperationRange range;
    HostTime at{};
  };
  std::deque<Entry> entries_;  // ascending in time
};

}  // namespace peerd::replication
