#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>

namespace peerd::replication {

// A turn that the code hardly ever takes by itself, and that a simulation takes on purpose, so that what follows from
// it is tried (after FoundationDB's "buggify", Zhou et al. 2021, section 4.2). Each is right at any time: it costs time
// or traffic alone.
enum class RareBranch : std::uint8_t {
  kAnswerHasNoPlace,  // the queue of answers to questions for operations counts as full
  kSmallPart,         // a datagram has room for a few bytes of operations
  kExchangeWaits,     // the rate of the exchange of operations is used up
  kNoCheckpoint,      // the scene is made from the world's file and all operations
};
inline constexpr std::size_t kRareBranchCount = 4;

// Who says which rare branches are taken. A daemon takes none.
class RareBranches {
 public:
  RareBranches() = default;  // takes none
  explicit RareBranches(std::function<bool(RareBranch)> takes) : takes_(std::move(takes)) {}

  [[nodiscard]] bool take(RareBranch branch) const { return takes_ && takes_(branch); }

 private:
  std::function<bool(RareBranch)> takes_;
};

}  // namespace peerd::replication
