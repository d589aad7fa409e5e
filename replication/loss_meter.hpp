#pragma once
#include <cstdint>

namespace peerd::replication {

// How many of another peer's datagrams get lost on their way here, by the numbers that they carry. Old ones are
// forgotten (the last thousand or so count); one that comes late is no loss, a duplicate is nothing.
class LossMeter {
 public:
  // `number`: the sender's count of its datagrams, from 1.
  void on_datagram(std::uint32_t number);
  [[nodiscard]] std::uint32_t highest() const { return highest_; }
  // Of those from the first that came to highest(): how many had not come when a later one did. Never less than before,
  // so that what is as much as before tells that all since then have come.
  [[nodiscard]] std::uint32_t missing() const { return missing_; }
  // Those that came again, and those that came after a later one.
  [[nodiscard]] std::uint64_t duplicates() const { return duplicates_; }
  [[nodiscard]] std::uint64_t overtaken() const { return overtaken_; }
  // The part that gets lost, in (0, 1): before anything has come one in ten, afterwards ever nearer to what was seen.
  [[nodiscard]] double loss() const { return (lost_ + 0.2) / (sent_ + 2.0); }
  // The same where so much of others gets lost on average: what to believe before anything has come, in place of one
  // in ten.
  [[nodiscard]] double loss(double of_others) const { return (lost_ + 2.0 * of_others) / (sent_ + 2.0); }
  // What of both together gets lost, where each has its own numbers.
  LossMeter& operator+=(const LossMeter& other) {
    sent_ += other.sent_;
    lost_ += other.lost_;
    duplicates_ += other.duplicates_;
    overtaken_ += other.overtaken_;
    return *this;
  }

 private:
  std::uint32_t highest_ = 0, missing_ = 0;
  std::uint64_t seen_ = 0;  // bit k: highest_ - k has come
  std::uint64_t duplicates_ = 0, overtaken_ = 0;
  double sent_ = 0.0, lost_ = 0.0;
};

// How often to send what should arrive at once: the fewest copies, 1 .. most, of which all get lost with a probability
// of at most kAllLostMax, each by `loss` and by itself. A loss below kLossMin is not worth twice the bytes.
inline constexpr double kAllLostMax = 0.001, kLossMin = 0.006;
[[nodiscard]] std::uint32_t copies_against(double loss, std::uint32_t most);

}  // namespace peerd::replication
