#include "peerd/net/greeting/source_buckets.hpp"

#include <algorithm>
#include <span>

namespace peerd::net {

SourceBuckets::SourceBuckets(const SipKey& key, const Limits& limits)
    : key_(key), limits_(limits), sources_(kSets * kWays) {
  for (TokenBucket& bucket : all_) bucket = TokenBucket(limits_.of_all);
}

bool SourceBuckets::admits(const boost::asio::ip::address& from, Kind kind, HostTime now) {
  const auto of_kind = static_cast<std::size_t>(kind);
  if (Source* const source = source_of(hash_of(from), now)) {
    source->came = now;
    if (now < source->known_until) return true;
    if (!source->buckets.at(of_kind).take(limits_.of_address, now)) return false;
  }
  return all_.at(of_kind).take(limits_.of_all, now);
}

void SourceBuckets::has_proven(const boost::asio::ip::address& from, HostTime now) {
  if (Source* const source = source_of(hash_of(from), now)) source->known_until = now + limits_.known;
}

// Null: all places for it are taken by known ones.
SourceBuckets::Source* SourceBuckets::source_of(std::uint64_t address, HostTime now) {
  const auto set = std::span(sources_).subspan(address % kSets * kWays, kWays);
  const auto found = std::ranges::find(set, address, &Source::address);
  if (found != set.end()) return &*found;
  // A stranger makes room that has not come for the longest time. Places that nobody has had are such ones.
  const auto order = [&](const Source& source) { return std::pair(now < source.known_until, source.came); };
  Source& oldest = *std::ranges::min_element(set, {}, order);
  if (now < oldest.known_until) return nullptr;
  oldest = {.address = address, .came = now};
  oldest.buckets.fill(TokenBucket(limits_.of_address, now));
  return &oldest;
}

std::uint64_t SourceBuckets::hash_of(const boost::asio::ip::address& address) const {
  const auto hash = [&](const auto& bytes) { return sip_hash(key_, std::as_bytes(std::span(bytes))); };
  return address.is_v4() ? hash(address.to_v4().to_bytes()) : hash(address.to_v6().to_bytes());
}

}  // namespace peerd::net
