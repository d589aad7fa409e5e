#include "replication/edits/log/range_history.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::replication {

void subtract(const OperationRange& what, std::vector<OperationRange>& from) {
  assert(what.from <= what.to);
  std::vector<OperationRange> left;
  left.reserve(from.size() + 1);
  for (const OperationRange& range : from) {
    assert(range.from < range.to);
    if (range.author != what.author || range.to <= what.from || what.to <= range.from) {
      left.push_back(range);
      continue;
    }
    if (range.from < what.from) left.push_back({range.author, range.from, what.from});
    if (what.to < range.to) left.push_back({range.author, what.to, range.to});
  }
  from = std::move(left);
}

// Parts that go out together and follow each other become one entry.
void RangeHistory::note(HostTime at, const OperationRange& range) {
  assert(entries_.empty() || entries_.back().at <= at);
  if (!entries_.empty()) {
    Entry& last = entries_.back();
    if (last.at == at && last.range.author == range.author && last.range.to == range.from) {
      last.range.to = range.to;
      return;
    }
  }
  if (entries_.size() == kMost) entries_.pop_front();
  entries_.push_back({range, at});
}

void RangeHistory::forget_before(HostTime time) {
  while (!entries_.empty() && entries_.front().at < time) entries_.pop_front();
}

std::vector<OperationRange> RangeHistory::without(std::vector<OperationRange> ranges, HostTime since) const {
  for (auto entry = entries_.rbegin(); entry != entries_.rend() && entry->at >= since && !ranges.empty(); ++entry) {
    subtract(entry->range, ranges);
  }
  return ranges;
}

}  // namespace peerd::replication
