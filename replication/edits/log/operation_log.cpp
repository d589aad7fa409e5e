#include "replication/edits/log/operation_log.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

namespace peerd::replication {
namespace {

// Whether two runs of bytes, of which each begins at an offset, differ where both have bytes.
bool differ(std::uint64_t a_from, std::span<const std::byte> a, std::uint64_t b_from, std::span<const std::byte> b) {
  const std::uint64_t from = std::max(a_from, b_from), to = std::min(a_from + a.size(), b_from + b.size());
  if (from >= to) return false;
  return !std::ranges::equal(a.subspan(from - a_from, to - from), b.subspan(from - b_from, to - from));
}

}  // namespace

const OperationLogs::Log* OperationLogs::find(AuthorId author) const {
  const auto at = logs_.find(author);
  return at == logs_.end() ? nullptr : &at->second;
}

void OperationLogs::note_whole(Log& log, const Operation& operation, std::size_t size_bytes) {
  if (log.marks.empty() || log.whole - log.marks.back().from >= kMark_bytes) {
    log.marks.push_back({operation.id.number, log.whole});
  }
  log.whole += size_bytes;
  log.last_number = operation.id.number;
  log.last_stamp = operation.stamp;
}

std::expected<void, const char*> OperationLogs::append(const Operation& operation) {
  assert(own_ != kNoAuthor && operation.id.author == own_);
  if (const char* const why = signer_ == nullptr ? nullptr : signer_->why_not_write()) return std::unexpected(why);
  Log& log = logs_[own_];
  std::vector<std::byte> bytes =
      signer_ == nullptr ? encode(operation) : encode_unsigned(operation, log.signatures.key_of_next(*signer_));
  const auto readable = decode_operation(own_, bytes);
  if (!readable) {
    if (log.bytes.empty()) logs_.erase(own_);
    return std::unexpected(readable.error());
  }
  assert(readable->has_value() && (*readable)->size_bytes == bytes.size());
  if (log.unreadable != nullptr) return std::unexpected(log.unreadable);
  if (log.whole != log.bytes.size()) return std::unexpected("log_cut_short");  // by the store
  assert(log.ahead.empty());
  assert(operation.id.number == log.last_number + 1);
  assert(log.last_number == 0 || operation.stamp > log.last_stamp);
  if (signer_ != nullptr) log.signatures.sign(*signer_, own_, bytes);
  log.bytes.append(bytes);
  note_whole(log, operation, bytes.size());
  log.bytes.pack(log.whole);
  return {};
}

std::expected<std::vector<Operation>, const char*> OperationLogs::receive(const OperationPart& part) {
  if (part.author == own_ && part.from + part.bytes.size() > length(own_)) return std::unexpected("own_log");
  return take(part);
}

std::expected<std::vector<Operation>, const char*> OperationLogs::restore(const OperationPart& part) {
  return take(part);
}

std::expected<std::vector<Operation>, const char*> OperationLogs::take(const OperationPart& part) {
  assert(part.author != kNoAuthor && part.author.value <= kAuthorMax && !part.bytes.empty());
  if (!logs_.contains(part.author) && logs_.size() >= kAuthorsMax) return std::unexpected("too_many_authors");
  Log& log = logs_[part.author];
  if (log.unreadable != nullptr) return std::unexpected(log.unreadable);
  const char* wrong = differs(log, part) ? "forked_log" : nullptr;
  if (wrong == nullptr && part.from > log.bytes.size()) wrong = keep_ahead(log, part);
  if (log.bytes.empty() && log.ahead.empty() && (part.from > 0 || wrong != nullptr)) logs_.erase(part.author);
  if (wrong != nullptr) return std::unexpected(wrong);
  const std::uint64_t held = length(part.author);
  if (part.from > held || part.from + part.bytes.size() <= held) return std::vector<Operation>{};
  join(log, part);
  Reading read = read_on(part.author, log);
  if (log.bytes.empty() && log.unreadable == nullptr) logs_.erase(part.author);
  if (read.operations.empty() && read.wrong != nullptr) return std::unexpected(read.wrong);
  return std::move(read.operations);
}

// Nobody knows which one of two different runs behind a gap is right: both are dropped, and asked for again.
bool OperationLogs::differs(Log& log, const OperationPart& part) {
  const std::uint64_t end = std::min<std::uint64_t>(part.from + part.bytes.size(), log.bytes.size());
  bool found = part.from < end && differ(part.from, log.bytes.copy(part.from, end, unpacked_), part.from, part.bytes);
  auto run = log.ahead.upper_bound(part.from);
  if (run != log.ahead.begin()) --run;
  while (run != log.ahead.end() && run->first < part.from + part.bytes.size()) {
    const auto here = run++;
    if (!differ(here->first, here->second, part.from, part.bytes)) continue;
    found = true;
    drop_ahead(log, here);
  }
  // Signed operations that are whole are right: what is not yet may be the wrong bytes of the two.
  if (found && signer_ != nullptr) drop_behind_whole(log);
  return found;
}

void OperationLogs::drop_behind_whole(Log& log) {
  log.bytes.cut(log.whole);
  while (!log.ahead.empty()) drop_ahead(log, log.ahead.begin());
}

void OperationLogs::drop_ahead(Log& log, Runs::iterator run) {
  const std::size_t size = run->second.size() + kAheadRun_bytes;
  assert(log.ahead_bytes >= size && ahead_bytes_ >= size);
  log.ahead_bytes -= size;
  ahead_bytes_ -= size;
  log.ahead.erase(run);
}

// Keeps those bytes of the part that no run has yet.
const char* OperationLogs::keep_ahead(Log& log, const OperationPart& part) {
  const std::uint64_t end = part.from + part.bytes.size();
  for (std::uint64_t from = part.from; from < end;) {
    const auto next = log.ahead.upper_bound(from);
    if (next != log.ahead.begin()) {
      const auto& [begin, run] = *std::prev(next);
      if (from < begin + run.size()) {
        from = begin + run.size();
        continue;
      }
    }
    const std::uint64_t to = next == log.ahead.end() ? end : std::min(end, next->first);
    const std::size_t size = to - from + kAheadRun_bytes;
    if (log.ahead_bytes + size > kAheadOfOneMax_bytes || ahead_bytes_ + size > kAheadMax_bytes) {
      return "operations_ahead";
    }
    const auto bytes = std::span(part.bytes).subspan(from - part.from, to - from);
    log.ahead.emplace(from, std::vector<std::byte>(bytes.begin(), bytes.end()));
    log.ahead_bytes += size;
    ahead_bytes_ += size;
    from = to;
  }
  return nullptr;
}

// Appends a part that begins within what is held or at its end, and the runs that no gap divides from it any more.
void OperationLogs::join(Log& log, const OperationPart& part) {
  assert(part.from <= log.bytes.size());
  const auto append_from = [&](std::uint64_t from, const std::vector<std::byte>& bytes) {
    if (from + bytes.size() <= log.bytes.size()) return;
    const auto is_new = std::span(bytes).subspan(log.bytes.size() - from);
    log.bytes.append(is_new);
  };
  append_from(part.from, part.bytes);
  while (!log.ahead.empty() && log.ahead.begin()->first <= log.bytes.size()) {
    append_from(log.ahead.begin()->first, log.ahead.begin()->second);
    drop_ahead(log, log.ahead.begin());
  }
}

OperationLogs::Reading OperationLogs::read_on(AuthorId author, Log& log) {
  Reading read;
  std::size_t checked = log.bytes.size();
  if (signer_ != nullptr) {
    const SignedLog::Checked signatures = log.signatures.check(*signer_, author, log.bytes.rest(log.whole));
    read.wrong = signatures.wrong;
    checked = log.whole + signatures.bytes;
  }
  while (log.whole < checked) {
    auto next = decode_operation(author, log.bytes.rest(log.whole));
    if (next && !*next) break;
    if (!next) {
      log.unreadable = next.error();
    } else if ((*next)->operation.id.number != log.last_number + 1) {
      log.unreadable = "operation_number";
    } else if (log.last_number != 0 && (*next)->operation.stamp <= log.last_stamp) {
      log.unreadable = "operation_stamp";
    }
    if (log.unreadable != nullptr) {
      read.wrong = log.unreadable;
      break;
    }
    Operation& operation = (*next)->operation;
    note_whole(log, operation, (*next)->size_bytes);
    read.operations.push_back(std::move(operation));
  }
  if (read.wrong != nullptr) drop_behind_whole(log);
  assert(log.whole <= log.bytes.size());
  log.bytes.pack(log.whole);
  return read;
}

std::vector<LogLength> OperationLogs::lengths() const {
  std::vector<LogLength> lengths;
  lengths.reserve(logs_.size());
  for (const auto& [author, log] : logs_) {
    if (!log.bytes.empty()) lengths.push_back({author, log.bytes.size()});
  }
  return lengths;
}

std::uint64_t OperationLogs::length(AuthorId author) const {
  const Log* log = find(author);
  return log == nullptr ? 0 : log->bytes.size();
}

std::uint64_t OperationLogs::whole(AuthorId author) const {
  const Log* log = find(author);
  return log == nullptr ? 0 : log->whole;
}

OperationId OperationLogs::last(AuthorId author) const {
  const Log* log = find(author);
  return {author, log == nullptr ? 0 : log->last_number};
}

SimTime OperationLogs::last_stamp(AuthorId author) const {
  const Log* log = find(author);
  return log == nullptr ? SimTime{} : log->last_stamp;
}

std::uint64_t OperationLogs::held_bytes(const OperationRange& range) const {
  assert(range.from <= range.to);
  const std::uint64_t end = std::min(range.to, length(range.author));
  return range.from < end ? end - range.from : 0;
}

std::vector<std::byte> OperationLogs::bytes(const OperationRange& range) const {
  const std::uint64_t held = held_bytes(range);
  if (held == 0) return {};
  return find(range.author)->bytes.copy(range.from, range.from + held, unpacked_);
}

std::vector<std::byte> OperationLogs::key(AuthorId author) const {
  const Log* const log = find(author);
  if (log == nullptr || log->whole == 0) return {};
  const std::uint64_t end = log->marks.size() > 1 ? log->marks[1].from : log->whole;
  const auto first = bytes({author, 0, end});
  const auto read = signed_operation(first);
  assert(read && *read);  // it has been decoded
  return (*read)->signature.empty() ? std::vector<std::byte>{} : key_in(**read);
}

Operation OperationLogs::operation(OperationId id) const {
  const Log* log = find(id.author);
  assert(log != nullptr && id.number > 0 && id.number <= log->last_number);
  const auto after = std::ranges::upper_bound(log->marks, id.number, {}, &Mark::number);
  assert(after != log->marks.begin());
  const auto [first, from] = *std::prev(after);
  const auto bytes = log->bytes.copy(from, after == log->marks.end() ? log->whole : after->from, unpacked_);
  std::span<const std::byte> rest = bytes;
  for (std::uint32_t number = first; number < id.number; ++number) rest = rest.subspan(operation_size_bytes(rest));
  auto found = decode_operation(id.author, rest);
  assert(found && *found && (*found)->operation.id == id);  // it was read when it came
  return std::move((*found)->operation);
}

std::vector<OperationRange> OperationLogs::missing(std::span<const LogLength> of_another, std::size_t most) const {
  std::vector<OperationRange> ranges;
  for (const auto& [author, end] : of_another) {
    const Log* log = find(author);
    if (author == own_ || (log != nullptr && log->unreadable != nullptr)) continue;
    std::uint64_t from = log == nullptr ? 0 : log->bytes.size();
    auto run = log == nullptr ? Runs::const_iterator{} : log->ahead.begin();
    while (from < end && ranges.size() < most) {
      const bool behind_run = log != nullptr && run != log->ahead.end() && run->first < end;
      const std::uint64_t to = behind_run ? run->first : end;
      if (from < to) ranges.push_back({author, from, to});
      if (!behind_run) break;
      from = to + run->second.size();
      ++run;
    }
  }
  return ranges;
}

const char* OperationLogs::unreadable(AuthorId author) const {
  const Log* log = find(author);
  return log == nullptr ? nullptr : log->unreadable;
}

}  // namespace peerd::replication
