#include "replication/edits/log/operation_exchange.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "replication/wire/loss_meter.hpp"
#include "replication/wire/operation_lists.hpp"

namespace peerd::replication {

OperationExchange::OperationExchange(const OperationLogs& logs, PeerId self, AuthorId own, std::uint64_t seed,
                                     Rate rate, RareBranches rare)
    : logs_(logs),
      own_(own),
      rate_(rate),
      rare_(std::move(rare)),
      timing_(seed),
      requests_(logs_, members_, timing_),
      sender_(logs_, members_, timing_, self, own, rare_),
      tokens_(rate.burst_bytes),
      own_length_(logs.length(own)),
      has_news_(!logs.lengths().empty()) {
  assert(self != kNobody && rate.bytes_per_s > 0.0 && rate.burst_bytes > 0.0);
}

void OperationExchange::set_link(Duration delay, double loss) {
  assert(loss >= 0.0 && loss <= 1.0);
  timing_.set_delay(delay);
  loss_ = loss;
}

void OperationExchange::on_joined(PeerId peer) { members_.on_joined(peer); }

void OperationExchange::on_lost(PeerId peer) {
  members_.on_lost(peer);
  if (members_.empty()) sender_.clear();
}

void OperationExchange::on_append(HostTime now, OperationId id) {
  const std::uint64_t length = logs_.length(own_);
  assert(id.author == own_ && id == logs_.last(own_) && length > own_length_);
  unheld_.push_back({id, length});
  if (!members_.empty()) {
    sender_.on_append(now, {own_, own_length_, length}, copies_against(loss_, kCopiesMax));
  }
  own_length_ = length;
  has_news_ = true;
}

void OperationExchange::on_lengths(HostTime now, PeerId from, std::span<const LogLength> logs) {
  members_.on_lengths(from, logs);
  for (const LogLength& log : logs) {
    if (log.author == own_) note_held(log.bytes);
    requests_.on_length(now, log);
  }
}

void OperationExchange::on_requests(HostTime now, PeerId from, std::span<const OperationRange> ranges) {
  assert(from != kNobody);
  requests_.on_requests(now, ranges);
  for (const OperationRange& range : ranges) sender_.on_request(now, range);
}

void OperationExchange::on_part(HostTime now, PeerId from, const OperationPart& part) {
  assert(!part.bytes.empty());
  const OperationRange range{part.author, part.from, part.from + part.bytes.size()};
  members_.at_least(from, {range.author, range.to});
  if (range.author == own_) note_held(range.to);
  sender_.on_part(now, from, range);
  requests_.on_part(now, range.author);
  requests_.on_length(now, {range.author, range.to});
  const auto published = published_.find(range.author);
  if (logs_.length(range.author) != (published == published_.end() ? 0 : published->second)) has_news_ = true;
}

void OperationExchange::note_held(std::uint64_t length) {
  for (; !unheld_.empty() && unheld_.front().end <= length; unheld_.pop_front()) {
    newly_held_.push_back(unheld_.front().id);
  }
}

void OperationExchange::refill(HostTime now) {
  assert(!filled_ || *filled_ <= now);
  if (filled_) tokens_ = std::min(rate_.burst_bytes, tokens_ + rate_.bytes_per_s * to_seconds(now - *filled_));
  filled_ = now;
}

void OperationExchange::spend(const OperationMessage& message) {
  for (const OperationPart& part : message.operations) {
    const OperationRange range{part.author, part.from, part.from + part.bytes.size()};
    tokens_ -= static_cast<double>(part_header_bytes(range) + part.bytes.size());
    ++counters_.parts_out;
    counters_.part_bytes_out += part.bytes.size();
  }
  for (const OperationRange& range : message.operation_requests) {
    tokens_ -= static_cast<double>(encoded_size_bytes(range));
    ++counters_.ranges_requested;
  }
  ++counters_.messages_out;
}

std::vector<OperationMessage> OperationExchange::on_tick(HostTime now) {
  refill(now);
  std::vector<OperationMessage> messages;
  if (members_.empty() || rare_.take(RareBranch::kExchangeWaits)) return messages;
  while (tokens_ > 0.0) {  // questions first: they are small
    OperationMessage message{{}, requests_.due(now)};
    if (message.operation_requests.empty()) message.operations = sender_.due(now);
    if (message.operations.empty() && message.operation_requests.empty()) break;
    spend(message);
    messages.push_back(std::move(message));
  }
  return messages;
}

std::optional<HostTime> OperationExchange::next_deadline() const {
  if (members_.empty()) return std::nullopt;
  std::optional<HostTime> next = sender_.next_deadline();
  if (const auto asks = requests_.next_deadline()) next = std::min(next.value_or(*asks), *asks);
  if (next && filled_ && tokens_ <= 0.0) {
    const HostTime allowed = *filled_ + from_seconds(-tokens_ / rate_.bytes_per_s) + Duration{1};
    next = std::max(*next, allowed);
  }
  return next;
}

std::vector<OperationId> OperationExchange::newly_held() { return std::exchange(newly_held_, {}); }

std::vector<LogLength> OperationExchange::lengths_for_hello(std::size_t room_bytes) {
  const std::vector<LogLength> all = logs_.lengths();
  std::vector<LogLength> chosen;
  std::size_t room = room_bytes - std::min(room_bytes, kOperationListHeader_bytes);
  bool left_out = false;
  const auto choose = [&](const LogLength& log) {
    const std::size_t size = encoded_size_bytes(kNoAuthor, log);  // behind another author it takes no more
    if (size > room || chosen.size() == kLogLengthsMax) return false;
    room -= size;
    chosen.push_back(log);
    published_[log.author] = log.bytes;
    return true;
  };
  std::vector<LogLength> unchanged;
  for (const LogLength& log : all) {
    const auto published = published_.find(log.author);
    if (published != published_.end() && published->second == log.bytes) {
      unchanged.push_back(log);
    } else if (!choose(log)) {
      left_out = true;
    }
  }
  const auto first = last_published_ ? std::ranges::upper_bound(unchanged, *last_published_, {}, &LogLength::author)
                                     : unchanged.begin();
  std::ranges::rotate(unchanged, first);
  for (const LogLength& log : unchanged) {
    if (!choose(log)) break;
    last_published_ = log.author;
  }
  has_news_ = left_out;
  std::ranges::sort(chosen);
  return chosen;
}

OperationExchange::Counters OperationExchange::counters() const {
  Counters counters = counters_;
  counters.requests_suppressed = requests_.suppressed();
  counters.answers_cancelled = sender_.cancelled();
  counters.answers_dropped = sender_.dropped();
  return counters;
}

}  // namespace peerd::replication
