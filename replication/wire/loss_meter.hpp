#pragma once
#include <cstdint>
#include <optional>

namespace peerd::replication {

// The datagrams of a sender that have come, by their numbers: for the last `kWindow` each by itself, for those before
// whether none is missing.
struct Received {
  static constexpr std::uint32_t kWindow = 64, kRunMax = 16'383;
  std::uint32_t highest = 0;
  std::uint32_t run = 0;   // so many up to `highest` came in a row; 0: it is asked for again; kRunMax: or more
  std::uint64_t last = 0;  // bit k: highest - k has come
  [[nodiscard]] bool has(std::uint32_t number) const {
    if (number > highest) return false;
    const std::uint32_t behind = highest - number;
    return behind < run || (behind < kWindow && (last >> behind & 1) != 0);
  }
  // Whether the datagram has surely not come. Of older ones nothing is known.
  [[nodiscard]] bool surely_lost(std::uint32_t number) const {
    return number <= highest && highest - number < kWindow && !has(number);
  }
  friend bool operator==(const Received&, const Received&) = default;
};

// Measures the part of another peer's datagrams that is lost on the way here, by the numbers that they carry. Old ones
// are forgotten (the last thousand or so count); a datagram that comes late is not lost, and a duplicate counts
// nothing.
class LossMeter {
 public:
  // A datagram came. `number`: the sender's count of its datagrams, from 1.
  void on_datagram(std::uint32_t number);
  // Marks a datagram that could not be used yet: in echoes it counts as missing.
  void mark_as_missing(std::uint32_t number);
  // Datagrams from before the first one that came count as received, and those that are later than by the window as
  // lost.
  [[nodiscard]] Received received() const;
  // The numbers of datagrams that came again, and that came after a later one.
  [[nodiscard]] std::uint64_t duplicates() const { return duplicates_; }
  [[nodiscard]] std::uint64_t overtaken() const { return overtaken_; }
  // The part that is lost, in (0, 1): one in ten before anything has come, afterwards ever nearer to the measured
  // part.
  [[nodiscard]] double loss() const { return loss(0.1); }
  // The same with another assumption before anything has come: the mean loss of the other peers, in place of one in
  // ten.
  [[nodiscard]] double loss(double of_others) const {
    return (lost_ + kPriorDatagrams * of_others) / (sent_ + kPriorDatagrams);
  }
  // The part that was lost, as counted, for reports; none before anything has come.
  [[nodiscard]] std::optional<double> measured_loss() const {
    return sent_ > 0.0 ? std::optional(lost_ / sent_) : std::nullopt;
  }
  // Adds the counts of another meter, which has numbers of its own, so that loss() is that of both together.
  LossMeter& operator+=(const LossMeter& other) {
    sent_ += other.sent_;
    lost_ += other.lost_;
    duplicates_ += other.duplicates_;
    overtaken_ += other.overtaken_;
    return *this;
  }

 private:
  // The assumption before anything has come counts like so many datagrams: eight without a loss are a link on which
  // copies do not pay. More would send the world's first states two or three times over links that lose nothing; less
  // would take the luck of a few for a good link, and an acknowledgement mends that.
  static constexpr double kPriorDatagrams = 0.5;
  static constexpr std::uint32_t kWindow = Received::kWindow;  // a datagram that is later than by so many stays lost
  std::uint32_t highest_ = 0;
  // Bit k of seen_: highest_ - k has come; of marked_missing_: it has been asked for again.
  std::uint64_t seen_ = 0, marked_missing_ = 0;
  std::uint32_t hole_ = 0;  // the highest number before the window that has not come; 0: none
  std::uint64_t duplicates_ = 0, overtaken_ = 0;
  double sent_ = 0.0, lost_ = 0.0;
};

// The number of copies of a datagram that should arrive at once: the fewest, in 1 .. most, of which all are lost with
// a probability of at most kAllLostMax, each by `loss` and independently. A loss below kLossMin is not worth twice the
// bytes.
inline constexpr double kAllLostMax = 0.001, kLossMin = 0.006;
[[nodiscard]] std::uint32_t copies_against(double loss, std::uint32_t most);

}  // namespace peerd::replication
