#include "replication/early_records.hpp"

#include <algorithm>
#include <utility>

namespace peerd::replication {

bool EarlyRecords::add(EarlyRecord record) {
  if (waiting_.size() >= kMax) return false;
  const auto later = [](const EarlyRecord& a, const EarlyRecord& b) {
    return std::pair(a.at, a.record.index()) > std::pair(b.at, b.record.index());
  };
  waiting_.insert(std::ranges::lower_bound(waiting_, record, later), std::move(record));
  return true;
}

std::optional<EarlyRecord> EarlyRecords::take_until(SimTime t) {
  if (waiting_.empty() || waiting_.back().at > t) return std::nullopt;
  EarlyRecord first = std::move(waiting_.back());
  waiting_.pop_back();
  return first;
}

}  // namespace peerd::replication
