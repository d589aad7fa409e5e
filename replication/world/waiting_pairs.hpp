#pragma once
#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

#include "replication/world/moving_objects.hpp"
#include "replication/world/world_model.hpp"

namespace peerd::replication {

// The watched pairs of a MotionWorld that wait for one of their two to move: both are one rigid body that nothing
// carries and that has never moved, and in the file they are apart. In a large world most are such pairs, and nothing
// is kept of them but that they wait.
class WaitingPairs {
 public:
  explicit WaitingPairs(const WorldModel& model)
      : model_(&model), waits_(model.pairs.size()), of_node_(model.nodes.size()) {}

  [[nodiscard]] bool contains(std::uint32_t number) const { return waits_[number]; }
  [[nodiscard]] std::size_t count() const { return count_; }
  // Whether the pair of that number in the model may wait.
  [[nodiscard]] bool may_wait(std::uint32_t number, const MovingObjects& objects) const;
  void set(std::uint32_t number, bool waits);
  // The pairs of a node, which wait no more.
  [[nodiscard]] std::vector<std::uint32_t> take_of(std::size_t node);
  // The interests of all that wait.
  [[nodiscard]] std::set<InterestKey> interests() const;

 private:
  const WorldModel* model_;
  std::vector<bool> waits_;             // by number
  std::vector<std::uint32_t> of_node_;  // how many of its pairs wait
  std::size_t count_ = 0;
};

}  // namespace peerd::replication
