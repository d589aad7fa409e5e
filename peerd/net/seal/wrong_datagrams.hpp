#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "peerd/net/greeting/sip_hash.hpp"

namespace peerd::seal {

// Remembers the last datagrams whose signatures were wrong, so that one that is sent over and over is checked once. A
// hash under a key of this process stands for a datagram: nobody can make another one that counts as wrong.
class WrongDatagrams {
 public:
  static constexpr std::size_t kKept = 1024;

  explicit WrongDatagrams(const net::SipKey& key) : key_(key) {}

  void note(std::span<const std::byte> datagram) {
    const std::uint64_t hash = hash_of(datagram);
    kept_[hash % kKept] = hash;
    is_empty_ = false;
  }
  [[nodiscard]] bool contains(std::span<const std::byte> datagram) const {
    if (is_empty_) return false;  // among honest peers nothing is hashed
    const std::uint64_t hash = hash_of(datagram);
    return kept_[hash % kKept] == hash;
  }

 private:
  [[nodiscard]] std::uint64_t hash_of(std::span<const std::byte> datagram) const {
    return net::sip_hash(key_, datagram) | 1;  // 0 is an empty place
  }

  net::SipKey key_;
  std::array<std::uint64_t, kKept> kept_{};
  bool is_empty_ = true;
};

}  // namespace peerd::seal
