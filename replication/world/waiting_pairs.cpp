#include "replication/world/waiting_pairs.hpp"

#include <cassert>

#include "collision/contact/contact_time.hpp"
#include "replication/motion/swept_bound.hpp"

namespace peerd::replication {

bool WaitingPairs::may_wait(std::uint32_t number, const MovingObjects& objects) const {
  const std::uint32_t first = model_->first_part_pair[number];
  if (model_->first_part_pair[number + 1] != first + 1) return false;
  const CollisionPair& pair = model_->pairs[number];
  const PartPair& parts = model_->part_pairs[first];
  const auto stands_alone = [&](std::uint32_t part, ObjectId end) {
    return part != ModelNode::kNone && !model_->is_flexible(part) && model_->nodes[part].object == end &&
           model_->nodes[part].carrier == ModelNode::kNone && model_->carried_by[part].empty() &&
           model_->bodies[part].unsupported.empty() && objects.has_never_moved(part);
  };
  if (parts.fixed || !stands_alone(parts.a, pair.collider) || !stands_alone(parts.b, pair.collidee)) return false;
  const collision::Body &a = model_->bodies[parts.a], &b = model_->bodies[parts.b];
  if (pair.type != CollisionType::kBox && !collision::has_exact_answer(a, b)) return false;
  return always_apart(a, objects.place_of(parts.a), b, objects.place_of(parts.b));
}

void WaitingPairs::set(std::uint32_t number, bool waits) {
  if (waits_[number] == waits) return;
  waits_[number] = waits;
  const PartPair& parts = model_->part_pairs[model_->first_part_pair[number]];
  waits ? ++count_ : --count_;
  for (const std::uint32_t node : {parts.a, parts.b}) waits ? ++of_node_[node] : --of_node_[node];
}

std::vector<std::uint32_t> WaitingPairs::take_of(std::size_t node) {
  std::vector<std::uint32_t> taken;
  if (node >= of_node_.size() || of_node_[node] == 0) return taken;
  for (const std::uint32_t number : model_->pairs_of_node[node]) {
    if (!waits_[number]) continue;
    set(number, false);
    taken.push_back(number);
  }
  return taken;
}

std::set<InterestKey> WaitingPairs::interests() const {
  std::set<InterestKey> interests;
  for (std::uint32_t number = 0; number < waits_.size(); ++number) {
    if (waits_[number]) interests.insert(key_of(model_->pairs[number]));
  }
  return interests;
}

}  // namespace peerd::replication
