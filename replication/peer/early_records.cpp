#include "replication/peer/early_records.hpp"

#include <utility>

namespace peerd::replication {

bool EarlyRecords::add(EarlyRecord record) {
  if (waiting_.size() >= kOfAllMax) return false;
  std::size_t& of_sender = of_sender_[record.sender];
  if (of_sender >= kOfSenderMax) return false;
  ++of_sender;
  waiting_.emplace(std::pair(record.at, record.record.index()), std::move(record));
  return true;
}

std::optional<EarlyRecord> EarlyRecords::take_until(SimTime t) {
  if (waiting_.empty() || waiting_.begin()->first.first > t) return std::nullopt;
  EarlyRecord first = std::move(waiting_.extract(waiting_.begin()).mapped());
  const auto of_sender = of_sender_.find(first.sender);
  if (--of_sender->second == 0) of_sender_.erase(of_sender);
  return first;
}

void EarlyRecords::clear() {
  waiting_.clear();
  of_sender_.clear();
}

}  // namespace peerd::replication
