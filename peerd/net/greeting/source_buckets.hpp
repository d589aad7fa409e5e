#pragma once
#include <array>
#include <boost/asio/ip/address.hpp>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/time.hpp"
#include "peerd/net/greeting/sip_hash.hpp"
#include "peerd/net/os/token_bucket.hpp"

namespace peerd::net {

// Limits the work that datagrams of strangers cause, by token buckets: one for each address that they come from, and
// one for all. Whoever sends something authentic is no stranger for a while, and then pays nothing. It has no clock,
// and its memory does not grow: where more addresses come than it has room for, those of strangers make room.
class SourceBuckets {
 public:
  // Each kind has tokens of its own, so that a flood of one leaves another through.
  enum class Kind : std::uint8_t { kDatagram, kAnnouncement };

  struct Limits {  // in datagrams
    TokenRate of_address{1'000.0, 5'000.0}, of_all{4'000.0, 20'000.0};
    Duration known = std::chrono::seconds(10);  // so long after something authentic
  };

  // The key is secret, so that nobody can choose addresses that fall into one place.
  explicit SourceBuckets(const SipKey& key, const Limits& limits);

  // Whether a datagram may be looked at; it pays for that.
  [[nodiscard]] bool admits(const boost::asio::ip::address& from, Kind kind, HostTime now);
  // Something authentic came from there.
  void has_proven(const boost::asio::ip::address& from, HostTime now);

 private:
  static constexpr std::size_t kKinds = 2;
  static constexpr std::size_t kWays = 8, kSets = 256;

  struct Source {
    std::uint64_t address = 0;  // its hash
    HostTime known_until{}, came{};
    std::array<TokenBucket, kKinds> buckets{};
  };

  [[nodiscard]] Source* source_of(std::uint64_t address, HostTime now);
  [[nodiscard]] std::uint64_t hash_of(const boost::asio::ip::address& address) const;

  SipKey key_;
  Limits limits_;
  std::array<TokenBucket, kKinds> all_{};
  std::vector<Source> sources_;  // kSets of kWays each
};

}  // namespace peerd::net
