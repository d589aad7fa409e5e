#include "peerd/peer/store/unstored_growth.hpp"

#include <cassert>

namespace peerd::store {
namespace {

std::uint64_t size_of(const replication::OperationRange& range) { return range.to - range.from; }

}  // namespace

void UnstoredGrowth::add(const Growth& growth) {
  assert(growth.range.from < growth.range.to && growth.last.author == growth.range.author);
  bytes_ += size_of(growth.range);
  const auto newest = newest_.find(growth.range.author);
  if (newest != newest_.end() && newest->second >= dropped_) {
    Growth& before = entries_[newest->second - dropped_];
    assert(before.range.to == growth.range.from);
    if (size_of(before.range) + size_of(growth.range) <= kGrowthMax_bytes) {
      before.range.to = growth.range.to;
      before.last = growth.last;
      return;
    }
  }
  newest_[growth.range.author] = dropped_ + entries_.size();
  entries_.push_back(growth);
}

std::vector<UnstoredGrowth::Growth> UnstoredGrowth::next_batch() const {
  assert(!empty());
  std::vector<Growth> batch;
  std::uint64_t bytes = 0;
  for (const Growth& growth : entries_) {
    bytes += size_of(growth.range);
    if (!batch.empty() && bytes > kBatchMax_bytes) break;
    batch.push_back(growth);
  }
  return batch;
}

void UnstoredGrowth::drop(std::size_t count) {
  assert(count <= entries_.size());
  for (; count > 0; --count) {
    bytes_ -= size_of(entries_.front().range);
    entries_.pop_front();
    ++dropped_;
  }
}

}  // namespace peerd::store
