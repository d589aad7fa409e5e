#include "replication/edits/log/operation_requests.hpp"

#include <algorithm>
#include <cassert>

#include "replication/wire/operation_lists.hpp"

namespace peerd::replication {

// The first gaps of a log, as far as the window and a question have room for them.
std::vector<OperationRange> OperationRequests::gaps(AuthorId author) const {
  const LogLength target{author, members_.longest(author)};
  std::vector<OperationRange> ranges = logs_.missing({&target, 1}, kRangesOfOneMax);
  std::uint64_t left = kWindow_bytes;
  std::size_t count = 0;
  for (; count < ranges.size() && left > 0; ++count) {
    OperationRange& range = ranges[count];
    range.to = std::min(range.to, range.from + left);
    left -= range.to - range.from;
  }
  ranges.resize(count);
  return ranges;
}

void OperationRequests::on_length(HostTime now, const LogLength& log) {
  if (missing_.contains(log.author) || logs_.missing({&log, 1}, 1).empty()) return;
  missing_[log.author] = {now + timing_.ask_after(members_.lacking(log)), 0, logs_.length(log.author), 0};
}

void OperationRequests::on_part(HostTime now, AuthorId author) {
  const auto at = missing_.find(author);
  if (at == missing_.end()) return;
  if (gaps(author).empty()) {
    missing_.erase(at);
    return;
  }
  Missing& missing = at->second;
  const std::uint64_t length = logs_.length(author);
  if (length <= missing.length) return;  // a gap waits for what it waited for
  missing.length = length;
  const bool whole_window = missing.asked > 0 && length >= missing.window_end;
  missing.asked = 0;
  missing.due = now + (whole_window ? timing_.ask_after(1) : timing_.ask_again_after(0));
}

void OperationRequests::on_requests(HostTime now, std::span<const OperationRange> ranges) {
  for (const OperationRange& range : ranges) {
    if (missing_.contains(range.author)) asked_.note(now, range);
  }
}

std::vector<OperationRange> OperationRequests::due(HostTime now) {
  asked_.forget_before(now - timing_.asked_for());
  std::vector<OperationRange> ask;
  for (auto at = missing_.begin(); at != missing_.end();) {
    auto& [author, missing] = *at;
    if (missing.due > now) {
      ++at;
      continue;
    }
    const std::vector<OperationRange> gaps_here = gaps(author);
    if (gaps_here.empty()) {
      at = missing_.erase(at);
      continue;
    }
    ++at;
    const std::vector<OperationRange> left = asked_.without(gaps_here, now - timing_.asked_for());
    if (ask.size() + left.size() > kOperationRangesMax) continue;  // with the next tick
    missing.due = now + timing_.ask_again_after(missing.asked++);
    missing.window_end = gaps_here.back().to;
    if (left.empty()) ++suppressed_;
    ask.insert(ask.end(), left.begin(), left.end());
  }
  for (const OperationRange& range : ask) asked_.note(now, range);
  assert(ask.size() <= kOperationRangesMax);
  return ask;
}

std::optional<HostTime> OperationRequests::next_deadline() const {
  std::optional<HostTime> next;
  for (const auto& [author, missing] : missing_) next = std::min(next.value_or(missing.due), missing.due);
  return next;
}

}  // namespace peerd::replication
