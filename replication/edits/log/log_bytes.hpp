#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace peerd::replication {

// The bytes of a log, from the first on. Old ones are kept packed (zstd), in blocks of kBlock_bytes.
class LogBytes {
 public:
  static constexpr std::size_t kBlock_bytes = std::size_t{4} << 10;

  // A few blocks that were unpacked last, of any logs: so reading one operation after another of several logs unpacks
  // each block once.
  class Unpacked {
   public:
    // The bytes of that block, until the next call.
    [[nodiscard]] std::span<const std::byte> operator()(std::span<const std::byte> frame);

   private:
    static constexpr std::size_t kBlocks = 8;
    struct Entry {
      const std::byte* frame = nullptr;  // which outlives this
      std::vector<std::byte> bytes;
    };
    std::array<Entry, kBlocks> entries_;  // the last used first
  };

  [[nodiscard]] std::uint64_t size() const { return packed_size() + last_.size(); }
  [[nodiscard]] bool empty() const { return size() == 0; }
  void append(std::span<const std::byte> bytes);
  // Bytes before `final` do not change any more: of these all but the last block and what follows it may be packed.
  void pack(std::uint64_t final);
  // Drops the bytes behind the first `size` ones, which are final.
  void cut(std::uint64_t size);
  // The bytes from there to the end, none of which is final.
  [[nodiscard]] std::span<const std::byte> rest(std::uint64_t from) const;
  // A copy of bytes [from, to).
  [[nodiscard]] std::vector<std::byte> copy(std::uint64_t from, std::uint64_t to, Unpacked& unpacked) const;

 private:
  struct Frame {
    std::unique_ptr<std::byte[]> bytes;
    std::uint32_t size = 0;
  };
  [[nodiscard]] std::uint64_t packed_size() const { return frames_.size() * kBlock_bytes; }

  std::vector<Frame> frames_;    // each of a block
  std::vector<std::byte> last_;  // behind these blocks
};

}  // namespace peerd::replication
