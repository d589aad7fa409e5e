#pragma once
#include <cstdint>

namespace peerd::replication {

// Which of a sender's datagrams have come, by their numbers: the last `kWindow` each by itself, those before by whether
// none is missing.
struct Received {
  static constexpr std::uint32_t kWindow = 64, kRunMax = 16'383;
  std::uint32_t highest = 0;
  std::uint32_t run = 0;   // so many up to `highest` have come in a row; 0: it is asked for again; kRunMax: or more
  std::uint64_t last = 0;  // bit k: highest - k has come
  [[nodiscard]] bool has(std::uint32_t number) const {
    if (number > highest) return false;
    const std::uint32_t behind = highest - number;
    return behind < run || (behind < kWindow && (last >> behind & 1) != 0);
  }
  // Surely not; the others are not known of.
  [[nodiscard]] bool surely_lost(std::uint32_t number) const {
    return number <= highest && highest - number < kWindow && !has(number);
  }
  friend bool operator==(const Received&, const Received&) = default;
};

// How many of another peer's datagrams get lost on their way here, by the numbers that they carry. Old ones are
// forgotten (the last thousand or so count); one that comes late is no loss, a duplicate is nothing.
class LossMeter {
 public:
  // `number`: the sender's count of its datagrams, from 1.
  void on_datagram(std::uint32_t number);
  // That datagram could not be used yet: in what is told of it, it has not come.
  void mark_as_missing(std::uint32_t number);
  // Those from before the first that came count as come, and what is later than by the window as lost.
  [[nodiscard]] Received received() const;
  // Those that came again, and those that came after a later one.
  [[nodiscard]] std::uint64_t duplicates() const { return duplicates_; }
  [[nodiscard]] std::uint64_t overtaken() const { return overtaken_; }
  // The part that gets lost, in (0, 1): before anything has come one in ten, afterwards ever nearer to what was seen.
  [[nodiscard]] double loss() const { return loss(0.1); }
  // The same where so much of others gets lost on average: what to believe before anything has come, in place of one
  // in ten.
  [[nodiscard]] double loss(double of_others) const { return (lost_ + kPriorDatagrams * of_others) / (sent_ + kPriorDatagrams); }
  // What of both together gets lost, where each has its own numbers.
  LossMeter& operator+=(const LossMeter& other) {
    sent_ += other.sent_;
    lost_ += other.lost_;
    duplicates_ += other.duplicates_;
    overtaken_ += other.overtaken_;
    return *this;
  }

 private:
  // What is believed before counts like so many datagrams: eight without a loss are a link worth no copies. More would
  // send the world's first states twice or three times over links that lose nothing; less would take the luck of a few
  // for one, and a receipt mends that.
  static constexpr double kPriorDatagrams = 0.5;
  static constexpr std::uint32_t kWindow = Received::kWindow;  // later than by so many, a datagram stays lost
  std::uint32_t highest_ = 0;
  // Bit k: highest_ - k has come, and has been asked for again.
  std::uint64_t seen_ = 0, marked_missing_ = 0;
  std::uint32_t hole_ = 0;  // the highest of those before that have not; 0: none
  std::uint64_t duplicates_ = 0, overtaken_ = 0;
  double sent_ = 0.0, lost_ = 0.0;
};

// How often to send what should arrive at once: the fewest copies, 1 .. most, of which all get lost with a probability
// of at most kAllLostMax, each by `loss` and by itself. A loss below kLossMin is not worth twice the bytes.
inline constexpr double kAllLostMax = 0.001, kLossMin = 0.006;
[[nodiscard]] std::uint32_t copies_against(double loss, std::uint32_t most);

}  // namespace peerd::replication
