#include "peerd/net/snapshot/snapshot_message.hpp"

#include <algorithm>
#include <utility>

#include "peerd/input/compression.hpp"
#include "peerd/input/printable.hpp"
#include "proto/snapshot.pb.h"

namespace peerd::snapshot {
namespace {

using replication::AuthorId;
using replication::LogLength;

// The longest name or sentence that is taken from another peer.
constexpr std::size_t kSentenceMax_bytes = 255;

void put(const std::vector<LogLength>& logs, proto::SnapshotLogs& out) {
  for (const LogLength& log : logs) {
    out.add_authors(log.author.value);
    out.add_lengths(log.bytes);
  }
}

std::expected<std::vector<LogLength>, std::string> logs_of(const proto::SnapshotLogs& in) {
  if (in.authors_size() != in.lengths_size()) return std::unexpected("its logs have no lengths");
  std::vector<LogLength> logs;
  for (int i = 0; i < in.authors_size(); ++i) {
    const AuthorId author{in.authors(i)};
    const bool ascends = logs.empty() || logs.back().author < author;
    if (author == replication::kNoAuthor || author.value > replication::kAuthorMax || !ascends || in.lengths(i) == 0) {
      return std::unexpected("its logs are not those of ascending authors");
    }
    logs.push_back({author, in.lengths(i)});
  }
  return logs;
}

template <class... Cases>
struct Visitor : Cases... {
  using Cases::operator()...;
};

}  // namespace

std::string encode(const Request& request) {
  proto::SnapshotRequest out;
  out.set_session(request.session);
  std::visit(Visitor{[&](const OfferRequest&) { out.set_offer(true); },
                     [&](const PartRequest& part) {
                       proto::SnapshotRange& range = *out.mutable_range();
                       range.set_author(part.range.author.value);
                       range.set_from(part.range.from);
                       range.set_to(part.range.to);
                     },
                     [&](const DigestRequest& asked) { put(asked.logs, *out.mutable_digests_of()); }},
             request.what);
  return out.SerializeAsString();
}

std::string encode(const Reply& reply) {
  proto::SnapshotReply out;
  std::visit(Visitor{[&](const Refusal& refusal) { out.set_refusal(refusal.why); },
                     [&](const Offer& offer) {
                       proto::SnapshotOffer& o = *out.mutable_offer();
                       o.set_protocol(offer.protocol);
                       o.set_session(offer.session);
                       o.set_world(offer.world);
                       o.set_settings(offer.settings);
                       o.set_genesis(offer.genesis);
                       o.set_archive_bytes(offer.archive_bytes);
                       o.set_archive_digest(offer.archive_digest);
                       put(offer.logs, *o.mutable_logs());
                       o.set_line(offer.line);
                     },
                     [&](const Part& part) { out.set_chunk(compress(part.bytes)); },
                     [&](const Digests& all) {
                       proto::SnapshotDigests& digests = *out.mutable_digests();
                       for (const std::uint64_t each : all.digests) digests.add_digests(each);
                     }},
             reply);
  return out.SerializeAsString();
}

std::expected<Request, std::string> decode_request(std::string_view bytes) {
  proto::SnapshotRequest in;
  if (bytes.size() > kRequestMax_bytes || !in.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return std::unexpected("it is no request");
  }
  Request request{.session = in.session(), .what = OfferRequest{}};
  switch (in.what_case()) {
    case proto::SnapshotRequest::kOffer:
      return request;
    case proto::SnapshotRequest::kRange: {
      const proto::SnapshotRange& range = in.range();
      const bool fits = range.author() <= replication::kAuthorMax && range.from() < range.to() &&
                        range.to() - range.from() <= kPartMax_bytes;
      if (!fits) return std::unexpected("it asks for no part of a log");
      request.what = PartRequest{{AuthorId{range.author()}, range.from(), range.to()}};
      return request;
    }
    case proto::SnapshotRequest::kDigestsOf: {
      auto logs = logs_of(in.digests_of());
      if (!logs) return std::unexpected(logs.error());
      request.what = DigestRequest{*std::move(logs)};
      return request;
    }
    case proto::SnapshotRequest::WHAT_NOT_SET:
      break;
  }
  return std::unexpected("it asks for nothing that this version knows");
}

std::expected<Reply, std::string> decode_reply(std::string_view bytes) {
  proto::SnapshotReply in;
  if (bytes.size() > kReplyMax_bytes || !in.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    return std::unexpected("it is no reply");
  }
  switch (in.what_case()) {
    case proto::SnapshotReply::kRefusal:
      return Refusal{printable(in.refusal(), kSentenceMax_bytes)};
    case proto::SnapshotReply::kOffer: {
      const proto::SnapshotOffer& o = in.offer();
      auto logs = logs_of(o.logs());
      if (!logs) return std::unexpected(logs.error());
      return Offer{o.protocol(),       o.session(),      printable(o.world(), kSentenceMax_bytes),
                   o.settings(),       o.genesis(),      o.archive_bytes(),
                   o.archive_digest(), *std::move(logs), o.line()};
    }
    case proto::SnapshotReply::kChunk: {
      auto part = decompress(in.chunk(), kPartMax_bytes);
      if (!part) return std::unexpected(part.error());
      return Part{*std::move(part)};
    }
    case proto::SnapshotReply::kDigests:
      return Digests{{in.digests().digests().begin(), in.digests().digests().end()}};
    case proto::SnapshotReply::WHAT_NOT_SET:
      break;
  }
  return std::unexpected("it says nothing that this version knows");
}

Digester::Digester(std::uint64_t bytes) : hash_(14695981039346656037u ^ bytes) {}

void Digester::add(std::string_view bytes) {
  constexpr std::uint64_t kPrime = 1099511628211u;
  while (!bytes.empty()) {
    std::uint64_t word = 0;
    const std::size_t size = std::min(bytes.size(), kWord_bytes);
    for (std::size_t i = 0; i < size; ++i) word |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
    bytes.remove_prefix(size);
    hash_ = (hash_ ^ word) * kPrime;
    hash_ ^= hash_ >> 32;  // a product carries nothing downwards
  }
}

std::uint64_t digest(std::string_view bytes) {
  Digester digester(bytes.size());
  digester.add(bytes);
  return digester.value();
}

}  // namespace peerd::snapshot
