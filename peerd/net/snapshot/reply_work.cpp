#include "peerd/net/snapshot/reply_work.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <variant>
#include <vector>

#include "replication/wire/codec.hpp"

namespace peerd::snapshot {
namespace {

using replication::LogLength;
using replication::OperationRange;

std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<LogLength> whole_logs(const replication::OperationLogs& logs, SimTime latest) {
  std::vector<LogLength> whole;
  for (const LogLength& log : logs.lengths()) {
    if (const std::uint64_t bytes = logs.whole(log.author); bytes > 0 && logs.last_stamp(log.author) <= latest)
      whole.push_back({log.author, bytes});
  }
  return whole;
}

Reply part_of(const OperationRange& range, const SnapshotContent& content) {
  std::string_view bytes;
  std::vector<std::byte> of_log;
  if (range.author != replication::kNoAuthor) {
    of_log = content.logs().bytes(range);
    bytes = as_text(of_log);
  } else if (range.from < content.archive.size()) {
    bytes = content.archive.substr(range.from, range.to - range.from);
  }
  if (bytes.size() != range.to - range.from) return Refusal{"this peer does not hold that"};
  return Part{std::string(bytes)};
}

Offer offer_of(const SnapshotContent& content) {
  return {.protocol = replication::kProtocolVersion,
          .session = content.session,
          .world = content.world,
          .settings = content.settings,
          .genesis = content.genesis,
          .archive_bytes = content.archive.size(),
          .archive_digest = content.archive_digest,
          .logs = whole_logs(content.logs(), content.latest_stamp()),
          .line = content.line()};
}

}  // namespace

ReplyWork::ReplyWork(std::string_view request, const SnapshotContent& content) : content_(&content) {
  auto decoded = decode_request(request);
  if (!decoded) {
    refused_ = Refusal{decoded.error()};
  } else if (decoded->session != 0 && decoded->session != content.session) {
    refused_ = Refusal{"this peer is in another world"};
  } else {
    request_ = *std::move(decoded);
  }
}

std::optional<Reply> ReplyWork::step() {
  if (refused_) return *std::move(refused_);
  if (const auto* const part = std::get_if<PartRequest>(&request_.what)) return part_of(part->range, *content_);
  const auto* const asked = std::get_if<DigestRequest>(&request_.what);
  if (asked == nullptr) return offer_of(*content_);
  if (!add_digests(*asked)) return std::nullopt;
  return std::move(digests_);
}

// Goes on with the digests. Returns whether all are made.
bool ReplyWork::add_digests(const DigestRequest& asked) {
  const replication::OperationLogs& logs = content_->logs();
  std::size_t left_bytes = kStep_bytes;
  for (std::size_t left = kStepLogs; left > 0 && left_bytes > 0; --left) {
    if (digests_.digests.size() == asked.logs.size()) return true;
    const LogLength& log = asked.logs[digests_.digests.size()];
    if (logs.length(log.author) < log.bytes) {
      digests_.digests.push_back(0);
      continue;
    }
    if (!digester_) {
      digester_.emplace(log.bytes);
      digested_ = 0;
    }
    // Whole words, of which the last slice alone may end with less.
    const std::uint64_t end = std::min(log.bytes, digested_ + std::max(left_bytes, Digester::kWord_bytes) /
                                                                  Digester::kWord_bytes * Digester::kWord_bytes);
    const auto bytes = logs.bytes({log.author, digested_, end});
    const bool is_cut = bytes.size() != end - digested_;  // since the last step
    digester_->add(as_text(bytes));
    digested_ = end;
    left_bytes -= std::min(left_bytes, bytes.size());
    if (!is_cut && end < log.bytes) return false;
    digests_.digests.push_back(is_cut ? 0 : digester_->value());
    digester_.reset();
  }
  return digests_.digests.size() == asked.logs.size();
}

Reply reply_to(std::string_view request, const SnapshotContent& content) {
  ReplyWork work(request, content);
  auto reply = work.step();
  while (!reply) reply = work.step();
  return *std::move(reply);
}

}  // namespace peerd::snapshot
