#pragma once
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "core/time.hpp"
#include "peerd/net/greeting/sip_hash.hpp"

namespace peerd::seal {

// Remembers the last datagrams whose signatures were wrong, so that one that is sent over and over is checked once. A
// hash under a key of this process stands for a datagram: nobody can make another one that counts as wrong. A datagram
// that falls into the place of another one takes it, so that some of the last kKept may be unknown. It has no clock.
class WrongDatagrams {
 public:
  static constexpr std::size_t kKept = 1024;
  // So long after the last wrong datagram all are forgotten. Nothing is hashed while none is remembered.
  static constexpr Duration kKeptFor = std::chrono::minutes(1);

  explicit WrongDatagrams(const net::SipKey& key) : key_(key) {}

  void note(std::span<const std::byte> datagram, HostTime now) {
    if (!are_there(now)) kept_.fill(0);
    const std::uint64_t hash = hash_of(datagram);
    kept_[place_of(hash)] = hash;
    noted_ = now;
  }
  // Whether any is remembered. Among honest peers none is.
  [[nodiscard]] bool are_there(HostTime now) const { return noted_ && now - *noted_ <= kKeptFor; }
  [[nodiscard]] bool contains(std::span<const std::byte> datagram, HostTime now) const {
    if (!are_there(now)) return false;
    const std::uint64_t hash = hash_of(datagram);
    return kept_[place_of(hash)] == hash;
  }

 private:
  [[nodiscard]] std::uint64_t hash_of(std::span<const std::byte> datagram) const {
    return net::sip_hash(key_, datagram) | 1;  // 0 is an empty place
  }
  // The lowest bit is the same in all hashes.
  [[nodiscard]] static std::size_t place_of(std::uint64_t hash) { return (hash >> 1) % kKept; }

  net::SipKey key_;
  std::array<std::uint64_t, kKept> kept_{};
  std::optional<HostTime> noted_{};  // the last one
};

}  // namespace peerd::seal
