#pragma once
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <ranges>
#include <set>
#include <utility>
#include <vector>

#include "core/ids.hpp"
#include "core/object_table.hpp"

namespace peerd::replication {

// The owners of all objects, in a table by object: an update asks for its object's owner, and there are many of both.
class Owners {
 public:
  // The owner of an object; kNobody where nobody owns it, or where there is no such object.
  [[nodiscard]] PeerId of(ObjectId object) const { return by_object_.of(object); }
  // Whether two different peers own the two objects.
  [[nodiscard]] bool have_two(ObjectId a, ObjectId b) const {
    const PeerId owner_a = of(a), owner_b = of(b);
    return owner_a != kNobody && owner_b != kNobody && owner_a != owner_b;
  }
  // Sets the owner of an object, which exists. kNobody: nobody owns it from now on. `as_founder`: the world's file
  // gives the object to the founder of the session, and the owner has it for no other reason.
  void set(ObjectId object, PeerId owner, bool as_founder = false) {
    assert(owner != kNobody || !as_founder);
    if (of(object) != owner) ++revision_;
    by_object_.set(object, owner);
    if (as_founder) {
      as_founder_.insert(object);
    } else {
      as_founder_.erase(object);
    }
  }
  // A number that changes with any owner.
  [[nodiscard]] std::uint64_t revision() const { return revision_; }
  // Whether the owner has the object as the founder of the session.
  [[nodiscard]] bool as_founder(ObjectId object) const { return as_founder_.contains(object); }

  // The owned objects, each with its owner, ascending; from() gives those from that one on, and size() counts all.
  class Iterator {
   public:
    using difference_type = std::ptrdiff_t;
    using value_type = std::pair<ObjectId, PeerId>;
    Iterator() = default;
    Iterator(const ObjectTable<PeerId>& by_object, ObjectId first) : by_object_(&by_object) { go_to(first); }
    value_type operator*() const { return at_; }
    Iterator& operator++() {
      go_to(ObjectId::unpacked(at_.first.packed() + 1));
      return *this;
    }
    Iterator operator++(int) {
      const Iterator before = *this;
      ++*this;
      return before;
    }
    friend bool operator==(const Iterator& a, const Iterator& b) {
      return a.is_behind_ == b.is_behind_ && (a.is_behind_ || a.at_.first == b.at_.first);
    }

   private:
    void go_to(ObjectId first) {
      const auto found = by_object_->from(first);
      is_behind_ = !found;
      if (found) at_ = *found;
    }
    const ObjectTable<PeerId>* by_object_ = nullptr;
    value_type at_{};
    bool is_behind_ = true;  // behind all
  };
  [[nodiscard]] Iterator begin() const { return {by_object_, ObjectId{}}; }
  [[nodiscard]] Iterator end() const { return {}; }
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(std::ranges::distance(begin(), end())); }
  [[nodiscard]] auto from(ObjectId first) const { return std::ranges::subrange(Iterator(by_object_, first), end()); }

 private:
  ObjectTable<PeerId> by_object_{kNobody};
  std::uint64_t revision_ = 0;
  std::set<ObjectId> as_founder_;
};

}  // namespace peerd::replication
