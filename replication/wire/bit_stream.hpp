#pragma once
#include <algorithm>
#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace peerd::replication {

// Streams of bits in the order in which they are put: bit i of a stream is bit i % 8 (0: the lowest) of byte i / 8,
// and the lowest bit of a field comes first. Nothing here allocates. Bytes are moved eight at a time.

inline constexpr int kFieldMax_bits = 56;  // the most bits of one put() or get()

namespace detail {
inline constexpr int kWord_bits = 64, kWord_bytes = 8;
static_assert(kFieldMax_bits <= kWord_bits - 8);
// The word with its lowest byte first in memory, whatever the processor. The function is its own inverse.
inline std::uint64_t lowest_first(std::uint64_t word) {
  return std::endian::native == std::endian::little ? word : std::byteswap(word);
}
}  // namespace detail

class BitWriter {
 public:
  // `out` must have room for everything that is put.
  explicit BitWriter(std::span<std::byte> out) : out_(out) {}

  void put(std::uint64_t value, int bits) {
    assert(bits >= 0 && bits <= kFieldMax_bits && value >> bits == 0);
    pending_ |= value << pending_bits_;
    pending_bits_ += bits;
    if (pending_bits_ < detail::kWord_bits) return;
    put_bytes(detail::kWord_bytes);
    pending_bits_ -= detail::kWord_bits;
    pending_ = value >> (bits - pending_bits_);  // the bits that had no room any more
  }
  // Fills the last byte with zeros and returns the size in bytes.
  std::size_t finish() {
    assert(pending_bits_ < detail::kWord_bits);
    if (pending_bits_ > 0) put_bytes(static_cast<std::size_t>(pending_bits_ + 7) / 8);
    pending_ = 0;
    pending_bits_ = 0;
    return size_;
  }

 private:
  void put_bytes(std::size_t count) {
    assert(count <= out_.size() - size_);
    const std::uint64_t word = detail::lowest_first(pending_);
    std::memcpy(out_.data() + size_, &word, count);
    size_ += count;
  }

  std::span<std::byte> out_;
  std::size_t size_ = 0;
  std::uint64_t pending_ = 0;
  int pending_bits_ = 0;  // fewer than a word's between two calls
};

// Reads zeros beyond the end, which good() reports: callers may ask once, at the end.
class BitReader {
 public:
  explicit BitReader(std::span<const std::byte> in) : in_(in) {}

  std::uint64_t get(int bits) {
    assert(bits >= 0 && bits <= kFieldMax_bits);
    std::uint64_t value = held_;
    if (bits <= held_bits_) {
      held_ >>= bits;
      held_bits_ -= bits;
    } else {
      const int more = bits - held_bits_;
      const std::uint64_t next = next_word();
      value |= next << held_bits_;
      held_ = next >> more;
      held_bits_ = detail::kWord_bits - more;
    }
    return value & ((std::uint64_t{1} << bits) - 1);
  }
  [[nodiscard]] bool good() const { return size_bytes() <= in_.size(); }
  // Whether the rest of the last byte read from is zeros, as finish() leaves it.
  [[nodiscard]] bool padded_with_zeros() const { return (held_ & ((1u << held_bits_ % 8) - 1)) == 0; }
  // The number of bytes of which a bit has been read.
  [[nodiscard]] std::size_t size_bytes() const { return fetched_bytes_ - static_cast<std::size_t>(held_bits_ / 8); }

 private:
  std::uint64_t next_word() {
    std::uint64_t word = 0;
    const std::size_t left = in_.size() - std::min(in_.size(), fetched_bytes_);
    if (left >= detail::kWord_bytes) {
      std::memcpy(&word, in_.data() + fetched_bytes_, detail::kWord_bytes);
    } else if (left > 0) {
      std::memcpy(&word, in_.data() + fetched_bytes_, left);
    }
    fetched_bytes_ += detail::kWord_bytes;
    return detail::lowest_first(word);
  }

  std::span<const std::byte> in_;
  std::size_t fetched_bytes_ = 0;  // counts bytes beyond the end, too
  std::uint64_t held_ = 0;
  int held_bits_ = 0;  // fewer than a word's between two calls
};

}  // namespace peerd::replication
