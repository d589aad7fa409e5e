#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/time.hpp"

namespace peerd::seal {

// A boot's key seals, and every member has it: a tag alone does not say that the boot's own process has sent a
// datagram. So each announcement, which is signed, has a Checkpoint: prints of the datagrams that its process has sent
// of late, by a salt that nobody knew when they were sent. What was heard and has another print, nobody has sent.
struct Checkpoint {
  static constexpr std::size_t kPrints_bytes = 32;
  std::uint64_t salt = 0;
  std::uint32_t covers = 0;  // so many counters, the last of which is the count of datagrams that were sent by then
  std::array<std::uint8_t, kPrints_bytes> prints{};
};

inline constexpr std::size_t kDatagramTag_bytes = 16;
using Tag = std::span<const std::uint8_t, kDatagramTag_bytes>;

// The datagrams of a boot, by their counters, with what a print is made of.
struct NumberedTag {
  std::uint64_t counter = 0;
  std::uint64_t tag = 0;  // half of it
};
[[nodiscard]] NumberedTag numbered(std::uint64_t counter, Tag tag);

// The datagrams that this process has sent.
class SentDatagrams {
 public:
  static constexpr std::size_t kKept = 16'384;  // the last of them

  void note(std::uint64_t counter, Tag tag);
  // The prints of what was sent since the checkpoint before the last one, so that an announcement may get lost.
  [[nodiscard]] Checkpoint checkpoint();
  // Whether it is one of those that are kept.
  [[nodiscard]] bool contains(const NumberedTag& datagram) const;
  [[nodiscard]] std::uint64_t count() const { return count_; }
  [[nodiscard]] std::uint64_t since_checkpoint() const { return count_ - last_; }

 private:
  std::vector<std::uint64_t> tags_;                       // a ring, by counter
  std::uint64_t count_ = 0, last_ = 0, before_last_ = 0;  // of all so far, and at the last two checkpoints
};

// The datagrams that have been heard from another process, and await its checkpoints.
class HeardDatagrams {
 public:
  static constexpr std::size_t kKept = 16'384;
  // A datagram whose counter has not been sent so long after it came is forged.
  static constexpr Duration kAhead = std::chrono::milliseconds(750);

  void note(const NumberedTag& datagram, HostTime at);
  // How many of them the checkpoint shows to be forged; these are forgotten.
  [[nodiscard]] std::size_t forged(const Checkpoint& checkpoint, std::uint64_t sent, HostTime now);
  void clear() { heard_.clear(); }

 private:
  struct Heard {
    NumberedTag datagram;
    HostTime at;
  };
  std::vector<Heard> heard_;
};

}  // namespace peerd::seal
