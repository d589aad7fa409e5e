#pragma once
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>

namespace peerd::replication {

// Bits in the order in which they are put: bit i of a stream is bit i % 8 (0: the lowest) of byte i / 8, and a field's
// lowest bit comes first. Nothing here allocates.

inline constexpr int kFieldMax_bits = 56;  // of one put() or get(); with 7 bits of a byte begun it fills a word

class BitWriter {
 public:
  // Must hold whatever is put.
  explicit BitWriter(std::span<std::byte> out) : out_(out) {}

  void put(std::uint64_t value, int bits) {
    assert(bits >= 0 && bits <= kFieldMax_bits && value >> bits == 0);
    pending_ |= value << pending_bits_;
    for (pending_bits_ += bits; pending_bits_ >= 8; pending_bits_ -= 8, pending_ >>= 8) put_byte();
  }
  // Fills the last byte with zeros; gives the size in bytes.
  std::size_t finish() {
    if (pending_bits_ > 0) put_byte();
    pending_bits_ = 0;
    return size_;
  }

 private:
  void put_byte() {
    assert(size_ < out_.size());
    out_[size_++] = static_cast<std::byte>(pending_ & 0xFF);
  }

  std::span<std::byte> out_;
  std::size_t size_ = 0;
  std::uint64_t pending_ = 0;
  int pending_bits_ = 0;  // fewer than 8 between two calls
};

// What is read beyond the end is zeros, and good() tells of it: callers may ask once, at the end.
class BitReader {
 public:
  explicit BitReader(std::span<const std::byte> in) : in_(in) {}

  std::uint64_t get(int bits) {
    assert(bits >= 0 && bits <= kFieldMax_bits);
    while (held_bits_ < bits) {
      if (next_ < in_.size()) {
        held_ |= std::to_integer<std::uint64_t>(in_[next_++]) << held_bits_;
      } else {
        good_ = false;
      }
      held_bits_ += 8;
    }
    const std::uint64_t value = held_ & ((std::uint64_t{1} << bits) - 1);
    held_ >>= bits;
    held_bits_ -= bits;
    return value;
  }
  [[nodiscard]] bool good() const { return good_; }
  // Whether what is left of the byte that was begun is zeros, as finish() leaves it.
  [[nodiscard]] bool padded_with_zeros() const { return held_ == 0; }
  // Bytes that were begun.
  [[nodiscard]] std::size_t size_bytes() const { return next_; }

 private:
  std::span<const std::byte> in_;
  std::size_t next_ = 0;
  std::uint64_t held_ = 0;
  int held_bits_ = 0;  // fewer than 8 between two calls
  bool good_ = true;
};

}  // namespace peerd::replication
