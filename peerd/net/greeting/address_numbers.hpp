#pragma once
#include <boost/asio/ip/udp.hpp>
#include <cstdint>

#include "core/time.hpp"
#include "peerd/net/greeting/sip_hash.hpp"

namespace peerd::net {

namespace asio = boost::asio;

inline constexpr int kAddressNumberBits = 48;

// The numbers by which addresses are verified: a process sends one to an address, and only who receives there can echo
// it. Each is a keyed hash of the address and of a period, so that the number of one address reveals nothing about
// those of others, and a recorded greeting is worth nothing after two periods. Sans-IO.
class AddressNumbers {
 public:
  // `key` is secret and of this process alone: whoever knows it can forge echoes.
  explicit AddressNumbers(const SipKey& key, Duration period = std::chrono::seconds(30));

  // To be called at least once in a period.
  void advance(HostTime now) { period_ = now.time_since_epoch() / length_; }

  // A public number of this process, which may have several addresses.
  [[nodiscard]] std::uint32_t instance() const { return instance_; }
  // The number that the receiver at `at` must echo; never 0.
  [[nodiscard]] std::uint64_t number_for(const asio::ip::udp::endpoint& at) const { return number_for(at, period_); }
  // Whether it is the number of that address in this period or in the one before.
  [[nodiscard]] bool is_number_for(const asio::ip::udp::endpoint& at, std::uint64_t number) const;

 private:
  [[nodiscard]] std::uint64_t number_for(const asio::ip::udp::endpoint& at, std::int64_t period) const;

  SipKey key_;
  Duration length_;
  std::uint32_t instance_;
  std::int64_t period_ = 0;
};

}  // namespace peerd::net
