#include "replication/peer/operation_limits.hpp"

#include <algorithm>
#include <cassert>
#include <iterator>

namespace peerd::replication {
namespace {

// The logs are counted anew after so many bytes of parts, some of which were copies.
constexpr std::uint64_t kCountedEvery_bytes = std::uint64_t{4} << 20;

std::uint64_t bytes_of(const OperationLogs& logs) {
  std::uint64_t sum = 0;
  for (const LogLength& log : logs.lengths()) sum += log.bytes;
  return sum;
}

}  // namespace

OperationLimits::OperationLimits(const OperationLogs& logs, const Membership& members, MemberLimits& limits)
    : logs_(logs), members_(members), limits_(limits), counted_bytes_(bytes_of(logs)) {}

bool OperationLimits::is_too_long(const OperationPart& part) {
  if (part.from > MemberLimits::kLogMax_bytes || part.bytes.size() > MemberLimits::kLogMax_bytes - part.from) {
    return true;
  }
  since_bytes_ += part.bytes.size();
  if (since_bytes_ > kCountedEvery_bytes) {
    counted_bytes_ = bytes_of(logs_);
    since_bytes_ = part.bytes.size();
  }
  return counted_bytes_ + since_bytes_ > MemberLimits::kLogsMax_bytes;
}

bool OperationLimits::admit_author(HostTime now, PeerId sender, AuthorId author) {
  if (logs_.length(author) > 0) return true;
  std::set<AuthorId>& unknown = unknown_[sender];
  if (unknown.contains(author)) return true;
  if (unknown.size() >= kUnknownMax) {
    std::erase_if(unknown, [&](AuthorId each) { return logs_.length(each) > 0; });
    std::erase_if(unknown_, [&](const auto& each) { return each.first != sender && !members_.contains(each.first); });
    if (unknown.size() >= kUnknownMax) {
      limits_.refuse(now, sender, MemberLimit::kAuthors);
      return false;
    }
  }
  unknown.insert(author);
  return true;
}

std::vector<LogLength> OperationLimits::admit(HostTime now, PeerId sender, std::span<const LogLength> lengths) {
  std::vector<LogLength> admitted;
  std::ranges::copy_if(lengths, std::back_inserter(admitted),
                       [&](const LogLength& log) { return admit_author(now, sender, log.author); });
  return admitted;
}

bool OperationLimits::admit(HostTime now, PeerId sender, const OperationPart& part) {
  assert(!part.bytes.empty());
  if (!limits_.take(now, sender, MemberLimit::kOperations, static_cast<double>(part.bytes.size()))) return false;
  if (!admit_author(now, sender, part.author)) return false;
  if (!is_too_long(part)) return true;
  limits_.refuse(now, sender, MemberLimit::kLogLength);
  return false;
}

bool OperationLimits::admit(HostTime now, PeerId sender, std::span<const OperationRange> ranges) {
  return !ranges.empty() && limits_.take(now, sender, MemberLimit::kRequests, static_cast<double>(ranges.size()));
}

bool OperationLimits::has_room(AuthorId author) const {
  return logs_.length(author) + kOperationMax_bytes <= MemberLimits::kLogMax_bytes;
}

void OperationLimits::note_stamp(HostTime now, PeerId sender, SimTime stamp, SimTime session_now) {
  if (stamp > session_now + kStampAheadMax) limits_.refuse(now, sender, MemberLimit::kOperationAhead);
}

}  // namespace peerd::replication
