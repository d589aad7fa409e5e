#pragma once
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "core/scene/scene.hpp"

namespace peerd::replication {

// Two ends of interests: nodes of the scene, of which one may be below the other.
struct CollisionPair {
  ObjectId collider, collidee;
  CollisionType type = CollisionType::kWitness;
  bool mutual = false;  // the collidee is registered for the collider as well, and so responds too
};

// An InterestKey names an interest in any model of the scene: by its type, its collider and its collidee.
using InterestKey = std::tuple<CollisionType, ObjectId, ObjectId>;
[[nodiscard]] inline InterestKey key_of(const CollisionPair& pair) { return {pair.type, pair.collider, pair.collidee}; }

inline constexpr std::uint32_t kNoNode = std::numeric_limits<std::uint32_t>::max();

// Two parts, one of each end of a pair, that may meet. The bodies of two types of interests meet part by part; the
// boxes of type kBox are those of whole ends. A part is the body of a node, by its index, or behind all nodes a
// flexible part.
struct PartPair {
  std::uint32_t pair = 0;          // number of the pair
  std::uint32_t a = 0, b = 0;      // parts that meet; kNoNode: the boxes of both whole ends
  std::uint32_t common = kNoNode;  // the nearest carrier that both move with: the two meet in its frame
  bool fixed = false;              // they never move relative to each other
};

// The pairs of an interest between two groups: each collider with each collidee. They are numbered, and no list of them
// is kept. Each end is one rigid body that nothing carries, and so each pair has one part pair. The colliders are among
// the collidees, in the same order, or none of them is. Pairs are numbered collider by collider, in the order of the
// interest; two that are both colliders are one mutual pair, of the earlier one.
class PairGroup {
 public:
  struct End {
    ObjectId object;
    std::uint32_t node;
    bool is_carrier;
  };
  // The place of a node in the group.
  struct Member {
    std::uint32_t node = kNoNode;
    std::uint32_t row = kNoNode;       // among the colliders; kNoNode: it is none
    std::uint32_t column = kNoNode;    // among the collidees; kNoNode: it is none
    std::uint32_t mere_collidees = 0;  // of the collidees before it those that are no colliders
  };

  // Whether the colliders are among the collidees in the same order, or none of them is; each end is there once.
  [[nodiscard]] static bool fits(std::span<const ObjectId> colliders, std::span<const ObjectId> collidees);

  // The ends fit. `first` and `first_part` are the numbers of the first pair and of its part pair.
  PairGroup(CollisionType type, std::vector<End> colliders, std::vector<End> collidees, std::uint32_t first,
            std::uint32_t first_part);

  [[nodiscard]] CollisionType type() const { return type_; }
  [[nodiscard]] std::uint32_t first() const { return first_; }
  [[nodiscard]] std::uint32_t first_part() const { return first_part_; }
  [[nodiscard]] std::size_t size() const { return row_at_.back(); }
  [[nodiscard]] std::span<const Member> members() const { return members_; }  // ascending by node
  [[nodiscard]] const Member* member(std::uint32_t node) const;               // null: the node is none

  // `offset` is added to first() or first_part().
  [[nodiscard]] CollisionPair pair(std::uint32_t offset) const;
  [[nodiscard]] PartPair part_pair(std::uint32_t offset) const;
  // The number of the pair of two members; none where both are colliders alone, or collidees alone.
  [[nodiscard]] std::optional<std::uint32_t> number_of(const Member& a, const Member& b) const;

  // How many pairs a member has, and which is its kth, from first() on, ascending.
  [[nodiscard]] std::uint32_t count_of(const Member& member) const {
    if (member.row == kNoNode) return static_cast<std::uint32_t>(colliders_.size());
    return static_cast<std::uint32_t>(collidees_.size()) - (colliders_are_collidees_ ? 1U : 0U);
  }
  [[nodiscard]] std::uint32_t offset_of(const Member& member, std::uint32_t k) const {
    assert(k < count_of(member));
    if (!colliders_are_collidees_) return member.row != kNoNode ? row_at_[member.row] + k : row_at_[k] + member.column;
    if (member.row != kNoNode && k >= member.row) return row_at_[member.row] + k - member.row;
    return row_at_[k] + offset_in_row(k, member);
  }

 private:
  struct Place {
    std::uint32_t row, column;
  };
  [[nodiscard]] Place place_of(std::uint32_t offset) const;
  // The place of a collidee in the row of a collider that is a collidee, too: first come the mere collidees before the
  // collider, then all behind it.
  [[nodiscard]] std::uint32_t offset_in_row(std::uint32_t row, const Member& collidee) const {
    return collidee.column < column_of_row_[row] ? collidee.mere_collidees : collidee.column - row - 1;
  }
  [[nodiscard]] std::uint32_t column_in_row(std::uint32_t row, std::uint32_t offset) const {
    return offset < column_of_row_[row] - row ? mere_collidees_[offset] : offset + row + 1;
  }

  CollisionType type_;
  std::uint32_t first_, first_part_;
  bool colliders_are_collidees_ = false;
  std::vector<End> colliders_, collidees_;
  std::vector<std::uint32_t> row_at_;          // by collider, and one more: the offset of its first pair
  std::vector<std::uint32_t> column_of_row_;   // by collider, where these are collidees: the same end as a collidee
  std::vector<std::uint32_t> mere_collidees_;  // columns of the collidees that are no colliders, where some are
  std::vector<bool> is_collider_;              // by collidee
  std::vector<Member> members_;
};

// Numbers of pairs or of part pairs, ascending: some are listed, some are those of a member of a group, or all from 0
// on.
class PairNumbers {
 public:
  struct Stretch {
    const std::uint32_t* listed = nullptr;  // null: they are not listed
    std::uint32_t count = 0;
    const PairGroup* group =
        nullptr;  // null: not those of a group; all from `first` on where they are not listed either
    PairGroup::Member member{};
    std::uint32_t first = 0;  // the number of the group's first pair or part pair

    [[nodiscard]] std::uint32_t operator[](std::uint32_t k) const {
      if (listed != nullptr) return listed[k];
      return first + (group == nullptr ? k : group->offset_of(member, k));
    }
  };

  class Iterator {
   public:
    using difference_type = std::ptrdiff_t;
    using value_type = std::uint32_t;
    using reference = std::uint32_t;
    using pointer = const std::uint32_t*;
    using iterator_category = std::input_iterator_tag;
    Iterator() = default;
    Iterator(const Stretch* at, const Stretch* end) : at_(at), end_(end) { skip_empty(); }
    std::uint32_t operator*() const { return (*at_)[k_]; }
    Iterator& operator++() {
      if (++k_ == at_->count) {
        ++at_;
        k_ = 0;
        skip_empty();
      }
      return *this;
    }
    Iterator operator++(int) {
      const Iterator before = *this;
      ++*this;
      return before;
    }
    friend bool operator==(const Iterator& a, const Iterator& b) { return a.at_ == b.at_ && a.k_ == b.k_; }

   private:
    void skip_empty() {
      while (at_ != end_ && at_->count == 0) ++at_;
    }
    const Stretch *at_ = nullptr, *end_ = nullptr;
    std::uint32_t k_ = 0;
  };
  using const_iterator = Iterator;
  using iterator = Iterator;
  using value_type = std::uint32_t;

  PairNumbers() = default;
  // `stretches` outlives the numbers.
  explicit PairNumbers(std::span<const Stretch> stretches) : stretches_(stretches) {}
  explicit PairNumbers(std::span<const std::uint32_t> listed)
      : own_{listed.data(), static_cast<std::uint32_t>(listed.size())} {}
  // The numbers below that one.
  [[nodiscard]] static PairNumbers all_below(std::size_t count) {
    PairNumbers all;
    all.own_.count = static_cast<std::uint32_t>(count);
    return all;
  }

  [[nodiscard]] Iterator begin() const { return {stretches().data(), end_of_stretches()}; }
  [[nodiscard]] Iterator end() const { return {end_of_stretches(), end_of_stretches()}; }
  [[nodiscard]] std::size_t size() const {
    std::size_t count = 0;
    for (const Stretch& stretch : stretches()) count += stretch.count;
    return count;
  }
  [[nodiscard]] bool empty() const { return size() == 0; }
  [[nodiscard]] std::vector<std::uint32_t> all() const { return {begin(), end()}; }

 private:
  [[nodiscard]] std::span<const Stretch> stretches() const {
    return stretches_.empty() ? std::span(&own_, 1) : stretches_;
  }
  [[nodiscard]] const Stretch* end_of_stretches() const { return stretches().data() + stretches().size(); }

  std::span<const Stretch> stretches_;
  Stretch own_{};
};

// For each node numbers of pairs, or of part pairs, each once.
class NodePairs {
 public:
  NodePairs() = default;
  explicit NodePairs(std::size_t nodes) : listed_(nodes), stretches_(nodes) {}

  // A number that is of no group. Numbers come ascending; the same one may come again.
  void add(std::uint32_t node, std::uint32_t number) {
    if (listed_[node].empty() || listed_[node].back() != number) listed_[node].push_back(number);
  }
  // Called once all is added: each node that is a member of one of these groups has its pairs there, too; `of_parts`:
  // the numbers are those of part pairs.
  void add_groups(std::span<const PairGroup* const> groups, bool of_parts);

  [[nodiscard]] PairNumbers of(std::size_t node) const {
    if (node >= stretches_.size()) return {};
    return stretches_[node].empty() ? PairNumbers(std::span(listed_[node])) : PairNumbers(std::span(stretches_[node]));
  }
  [[nodiscard]] std::span<const std::uint32_t> listed_of(std::size_t node) const { return listed_[node]; }
  // All numbers of the node, where some of them are of a group; else none.
  [[nodiscard]] std::span<const PairNumbers::Stretch> stretches_of(std::size_t node) const { return stretches_[node]; }

 private:
  std::vector<std::vector<std::uint32_t>> listed_;            // those of no group
  std::vector<std::vector<PairNumbers::Stretch>> stretches_;  // all, where some are of a group
};

// The pairs of a model, or its part pairs, by number: listed ones, and those of groups.
template <class Item>
class PairList {
 public:
  class Iterator {
   public:
    using difference_type = std::ptrdiff_t;
    using value_type = Item;
    Iterator() = default;
    Iterator(const PairList& list, std::uint32_t number) : list_(&list), number_(number) {}
    Item operator*() const { return (*list_)[number_]; }
    Iterator& operator++() {
      ++number_;
      return *this;
    }
    Iterator operator++(int) {
      const Iterator before = *this;
      ++*this;
      return before;
    }
    friend bool operator==(const Iterator& a, const Iterator& b) { return a.number_ == b.number_; }

   private:
    const PairList* list_ = nullptr;
    std::uint32_t number_ = 0;
  };

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] Item operator[](std::size_t number) const {
    const Place at = locate(number);
    return at.group == nullptr ? listed_[at.place] : item_of(*at.group, at.place);
  }
  // The place of an item: in a group, or among those that are listed.
  struct Place {
    const PairGroup* group;
    std::uint32_t place;
  };
  [[nodiscard]] Place locate(std::size_t number) const {
    assert(number < size_);
    auto place = static_cast<std::uint32_t>(number);
    for (const PairGroup* const group : groups_) {  // `place`: the number without those of the groups before
      const std::uint32_t first = first_of(*group);
      if (number < first) break;
      if (number - first < group->size()) return {group, static_cast<std::uint32_t>(number - first)};
      place -= static_cast<std::uint32_t>(group->size());
    }
    return {nullptr, place};
  }
  [[nodiscard]] Iterator begin() const { return {*this, 0}; }
  [[nodiscard]] Iterator end() const { return {*this, static_cast<std::uint32_t>(size_)}; }

  // Both go behind all others. The group outlives the list.
  void push_back(const Item& item) {
    listed_.push_back(item);
    ++size_;
  }
  void add(const PairGroup& group) {
    assert(first_of(group) == size_);
    groups_.push_back(&group);
    size_ += group.size();
  }
  // Calls `function(number, item)` for those that are in no group, ascending.
  template <class Function>
  void for_each_listed(Function function) const {
    std::uint32_t number = 0;
    auto group = groups_.begin();
    for (const Item& item : listed_) {
      for (; group != groups_.end() && first_of(**group) == number; ++group) {
        number += static_cast<std::uint32_t>((*group)->size());
      }
      function(number++, item);
    }
  }
  // One that is in no group.
  [[nodiscard]] Item& listed(std::size_t number) {
    assert(locate(number).group == nullptr);
    return listed_[locate(number).place];
  }

 private:
  static std::uint32_t first_of(const PairGroup& group) {
    if constexpr (std::is_same_v<Item, PartPair>) return group.first_part();
    return group.first();
  }
  static Item item_of(const PairGroup& group, std::uint32_t offset) {
    if constexpr (std::is_same_v<Item, PartPair>) {
      return group.part_pair(offset);
    } else {
      return group.pair(offset);
    }
  }

  std::size_t size_ = 0;
  std::vector<Item> listed_;
  std::vector<const PairGroup*> groups_;  // in the order of their numbers
};

}  // namespace peerd::replication
