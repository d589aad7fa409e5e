#include "replication/edits/log/operation_sender.hpp"

#include <algorithm>
#include <cassert>
#include <tuple>

#include "replication/wire/operation_lists.hpp"

namespace peerd::replication {
namespace {

// A part of fewer bytes goes to the next datagram, unless it is the rest of its range.
constexpr std::uint64_t kPartMin_bytes = 64;
// Enough for the header of any part, and such a part.
constexpr std::size_t kSmallRoom_bytes = 128;

bool meet(const OperationRange& a, const OperationRange& b) {
  return a.author == b.author && a.from < b.to && b.from < a.to;
}

}  // namespace

void OperationSender::wait_for(const Waiting& waiting) {
  assert(waiting.range.from < waiting.range.to);
  const bool has_place = waiting_.size() < kWaitingMax;
  if (has_place && !(waiting.answers && rare_.take(RareBranch::kAnswerHasNoPlace))) {
    waiting_.push_back(waiting);
  } else {
    ++dropped_;
  }
}

void OperationSender::on_append(HostTime now, const OperationRange& range, std::uint32_t copies) {
  assert(range.author == own_ && copies >= 1);
  if (range.to - range.from > kCopied_bytes) copies = 1;
  // Operations that are made in one go share datagrams.
  for (Waiting& w : waiting_) {
    const bool begun = w.range.from != w.begin;
    if (w.answers || begun || w.range.to != range.from || w.more_copies != copies - 1 || w.due > now) continue;
    if (copies > 1 && range.to - w.begin > kCopied_bytes) continue;
    w.range.to = range.to;
    return;
  }
  wait_for({range, now, range.from, copies - 1, false});
}

void OperationSender::on_request(HostTime now, const OperationRange& range) {
  const std::uint64_t held = logs_.held_bytes(range);
  if (held == 0) return;
  std::vector<OperationRange> wanted{{range.author, range.from, range.from + held}};
  for (const Waiting& w : waiting_) subtract(w.range, wanted);
  wanted = sent_.without(std::move(wanted), now - timing_.crossing());
  for (const OperationRange& rest : wanted) {
    for (std::uint64_t from = rest.from; from < rest.to;) {
      const std::uint64_t block = from / kBlock_bytes;
      const OperationRange part{rest.author, from, std::min(rest.to, (block + 1) * kBlock_bytes)};
      const bool is_own = part.author == own_;
      const Duration wait =
          is_own ? Duration{0} : timing_.answer_after(members_.rank(self_, part, block), members_.silent());
      wait_for({part, now + wait, part.from, 0, true});
      from = part.to;
    }
  }
}

// An answer of another peer stands for the whole block: it has begun to send it. Of two that have both begun the one
// with the lower id goes on. What is lost is asked for again.
void OperationSender::on_part(HostTime now, PeerId from, const OperationRange& range) {
  sent_.note(now, range);
  const std::size_t were = waiting_.size();
  std::erase_if(waiting_, [&](const Waiting& w) {
    if (!w.answers || !meet({w.range.author, w.begin, w.range.to}, range)) return false;
    const bool begun = w.range.from != w.begin;
    return !begun || (from < self_ && w.range.author != own_);
  });
  cancelled_ += were - waiting_.size();
}

std::vector<OperationSender::Waiting>::iterator OperationSender::first_due(HostTime now) {
  const auto order = [](const Waiting& w) { return std::tuple(w.due, w.range); };
  const auto first = std::ranges::min_element(waiting_, {}, order);
  return first == waiting_.end() || first->due > now ? waiting_.end() : first;
}

std::vector<OperationPart> OperationSender::due(HostTime now) {
  sent_.forget_before(now - timing_.crossing());
  std::vector<OperationPart> parts;
  std::size_t room = rare_.take(RareBranch::kSmallPart) ? kSmallRoom_bytes : kOperationsMax_bytes;
  while (parts.size() < kOperationPartsMax) {
    const auto next = first_due(now);
    if (next == waiting_.end()) break;
    const std::uint64_t held = logs_.held_bytes(next->range);
    if (held == 0) {  // the log turned out to be unreadable
      waiting_.erase(next);
      continue;
    }
    const std::uint64_t header = part_header_bytes(next->range), left = next->range.to - next->range.from;
    if (room < header + std::min(left, kPartMin_bytes)) break;
    const std::size_t size = std::min<std::size_t>(held, room - header);
    const OperationRange sent{next->range.author, next->range.from, next->range.from + size};
    parts.push_back({sent.author, sent.from, logs_.bytes(sent)});
    room -= part_header_bytes(sent) + size;
    sent_.note(now, sent);
    next->range.from = sent.to;
    if (next->range.from < next->range.to) continue;
    if (next->more_copies == 0) {
      waiting_.erase(next);
    } else {
      *next = {{next->range.author, next->begin, next->range.to},
               now + kBetweenCopies,
               next->begin,
               next->more_copies - 1,
               false};
    }
  }
  return parts;
}

std::optional<HostTime> OperationSender::next_deadline() const {
  if (waiting_.empty()) return std::nullopt;
  return std::ranges::min(waiting_, {}, &Waiting::due).due;
}

}  // namespace peerd::replication
