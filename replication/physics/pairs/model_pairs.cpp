#include "replication/physics/pairs/model_pairs.hpp"

#include <unordered_map>
#include <unordered_set>

namespace peerd::replication {

bool PairGroup::fits(std::span<const ObjectId> colliders, std::span<const ObjectId> collidees) {
  std::unordered_map<ObjectId, std::uint32_t> columns;
  for (const ObjectId id : collidees) {
    if (!columns.try_emplace(id, static_cast<std::uint32_t>(columns.size())).second) return false;
  }
  const std::unordered_set<ObjectId> each(colliders.begin(), colliders.end());
  if (each.size() != colliders.size()) return false;
  const auto is_collidee = [&](ObjectId id) { return columns.contains(id); };
  if (std::ranges::none_of(colliders, is_collidee)) return true;
  return std::ranges::all_of(colliders, is_collidee) &&
         std::ranges::is_sorted(colliders, {}, [&](ObjectId id) { return columns.at(id); });
}

PairGroup::PairGroup(CollisionType type, std::vector<End> colliders, std::vector<End> collidees, std::uint32_t first,
                     std::uint32_t first_part)
    : type_(type),
      first_(first),
      first_part_(first_part),
      colliders_(std::move(colliders)),
      collidees_(std::move(collidees)),
      is_collider_(collidees_.size(), false) {
  assert(!colliders_.empty() && !collidees_.empty());
  const auto count = [](const std::vector<End>& ends) { return static_cast<std::uint32_t>(ends.size()); };
  std::unordered_map<std::uint32_t, std::uint32_t> row_of_node;
  for (std::uint32_t row = 0; row < count(colliders_); ++row) row_of_node.emplace(colliders_[row].node, row);
  for (std::uint32_t column = 0; column < count(collidees_); ++column) {
    const auto mere = static_cast<std::uint32_t>(mere_collidees_.size());
    const auto row = row_of_node.find(collidees_[column].node);
    if (row == row_of_node.end()) {
      members_.push_back({collidees_[column].node, kNoNode, column, mere});
      mere_collidees_.push_back(column);
      continue;
    }
    members_.push_back({collidees_[column].node, row->second, column, mere});
    assert(row->second == column_of_row_.size() && "the colliders are in the order of the collidees");
    column_of_row_.push_back(column);
    is_collider_[column] = true;
  }
  colliders_are_collidees_ = !column_of_row_.empty();
  assert(!colliders_are_collidees_ || column_of_row_.size() == colliders_.size());
  row_at_.push_back(0);
  for (std::uint32_t row = 0; row < count(colliders_); ++row) {
    if (!colliders_are_collidees_) members_.push_back({colliders_[row].node, row, kNoNode, 0});
    row_at_.push_back(row_at_.back() + count(collidees_) - (colliders_are_collidees_ ? row + 1 : 0));
  }
  std::ranges::sort(members_, {}, &Member::node);
}

const PairGroup::Member* PairGroup::member(std::uint32_t node) const {
  const auto at = std::ranges::lower_bound(members_, node, {}, &Member::node);
  return at == members_.end() || at->node != node ? nullptr : &*at;
}

PairGroup::Place PairGroup::place_of(std::uint32_t offset) const {
  assert(offset < row_at_.back());
  const auto behind = std::ranges::upper_bound(row_at_, offset);
  const auto row = static_cast<std::uint32_t>(behind - row_at_.begin() - 1);
  const std::uint32_t in_row = offset - row_at_[row];
  if (!colliders_are_collidees_) return {row, in_row};
  return {row, column_in_row(row, in_row)};
}

CollisionPair PairGroup::pair(std::uint32_t offset) const {
  const auto [row, column] = place_of(offset);
  return {colliders_[row].object, collidees_[column].object, type_, is_collider_[column]};
}

PartPair PairGroup::part_pair(std::uint32_t offset) const {
  const auto [row, column] = place_of(offset);
  const End &a = colliders_[row], &b = collidees_[column];
  return {first_ + offset, a.node, b.node, kNoNode, !a.is_carrier && !b.is_carrier};
}

std::optional<std::uint32_t> PairGroup::number_of(const Member& a, const Member& b) const {
  if (a.node == b.node) return std::nullopt;
  const Member *collider = &a, *collidee = &b;
  const bool both = a.row != kNoNode && b.row != kNoNode;
  if (a.row == kNoNode || (both && b.row < a.row)) std::swap(collider, collidee);
  if (collider->row == kNoNode || collidee->column == kNoNode) return std::nullopt;
  const std::uint32_t in_row = colliders_are_collidees_ ? offset_in_row(collider->row, *collidee) : collidee->column;
  return first_ + row_at_[collider->row] + in_row;
}

void NodePairs::add_groups(std::span<const PairGroup* const> groups, bool of_parts) {
  std::vector<std::uint32_t> done(listed_.size(), 0);  // of each node's listed numbers, those in its stretches
  const auto add_listed = [&](std::uint32_t node, std::uint32_t before) {
    const std::vector<std::uint32_t>& listed = listed_[node];
    const auto from = listed.begin() + done[node], to = std::lower_bound(from, listed.end(), before);
    if (from == to) return;
    stretches_[node].push_back({&*from, static_cast<std::uint32_t>(to - from)});
    done[node] = static_cast<std::uint32_t>(to - listed.begin());
  };
  for (const PairGroup* const group : groups) {
    const std::uint32_t first = of_parts ? group->first_part() : group->first();
    for (const PairGroup::Member& member : group->members()) {
      add_listed(member.node, first);
      stretches_[member.node].push_back({nullptr, group->count_of(member), group, member, first});
    }
  }
  for (std::uint32_t node = 0; node < listed_.size(); ++node) {
    if (!stretches_[node].empty()) add_listed(node, kNoNode);
  }
}

}  // namespace peerd::replication
