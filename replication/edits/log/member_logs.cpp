#include "replication/edits/log/member_logs.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "core/mixed_bits.hpp"

namespace peerd::replication {
namespace {

std::uint64_t place_of(PeerId peer, AuthorId author, std::uint64_t block) {
  return mixed_bits(mixed_bits(mixed_bits(peer.value) + author.value) + block);
}

}  // namespace

void MemberLogs::set(Logs& logs, const LogLength& log) {
  if (const auto known = logs.lengths.find(log.author); known != logs.lengths.end()) {
    known->second = log.bytes;
  } else if (logs.lengths.size() < kAuthorsMax) {
    logs.lengths.emplace(log.author, log.bytes);
  } else {
    ++ignored_;
  }
}

void MemberLogs::on_lengths(PeerId peer, std::span<const LogLength> logs) {
  const auto member = members_.find(peer);
  if (member == members_.end()) return;
  member->second.has_spoken = true;
  for (const LogLength& log : logs) set(member->second, log);
}

void MemberLogs::at_least(PeerId peer, const LogLength& log) {
  if (length(peer, log.author) < log.bytes) set(members_[peer], log);
}

std::uint64_t MemberLogs::length(PeerId peer, AuthorId author) const {
  const auto member = members_.find(peer);
  if (member == members_.end()) return 0;
  const auto known = member->second.lengths.find(author);
  return known == member->second.lengths.end() ? 0 : known->second;
}

std::size_t MemberLogs::silent() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(members_, [](const auto& member) { return !member.second.has_spoken; }));
}

std::uint64_t MemberLogs::longest(AuthorId author) const {
  std::uint64_t longest = 0;
  for (const auto& [peer, logs] : members_) longest = std::max(longest, length(peer, author));
  return longest;
}

std::size_t MemberLogs::lacking(const LogLength& log) const {
  std::size_t count = 0;
  for (const auto& [peer, logs] : members_) count += length(peer, log.author) < log.bytes ? 1 : 0;
  assert(count <= size());
  return count;
}

std::size_t MemberLogs::rank(PeerId self, const OperationRange& range, std::uint64_t block) const {
  assert(range.from < range.to);
  const auto own = std::pair(place_of(self, range.author, block), self);
  std::size_t before = 0;
  for (const auto& [peer, logs] : members_) {
    const bool holds = length(peer, range.author) >= range.to;
    if (holds && std::pair(place_of(peer, range.author, block), peer) < own) ++before;
  }
  return before;
}

}  // namespace peerd::replication
