#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

namespace peerd::seal {

// Which of a sender's counters have come, to take each once (the sliding window of RFC 4303, section 3.4.3). Counters
// count from 1.
class ReplayWindow {
 public:
  static constexpr std::uint64_t kWidth = 1024;  // counters; older ones are taken no more

  // Whether it has not come and is not too old.
  [[nodiscard]] bool would_take(std::uint64_t counter) const;
  // The same; it has come from then on.
  bool take(std::uint64_t counter);
  [[nodiscard]] std::uint64_t newest() const { return newest_; }

 private:
  static constexpr std::uint64_t kWord_bits = 64;
  static constexpr std::uint64_t kWords = kWidth / kWord_bits + 1;  // one more, so that it can be cleared as a whole

  std::uint64_t newest_ = 0;
  std::array<std::uint64_t, kWords> words_{};  // a ring: bit i % 64 of word i / 64 % kWords is that of counter i
};

}  // namespace peerd::seal
