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

namespace peerd::replication {

// The owners of all objects, in a table by object: an update asks for its object's owner, and there are many of both.
class Owners {
 public:
  // A scene has so many objects, with ids below that number.
  explicit Owners(std::size_t objects) : by_object_(objects, kNobody) {}

  // The owner of an object; kNobody where nobody owns it, or where there is no such object.
  [[nodiscard]] PeerId of(ObjectId object) const {
    return object.value < by_object_.size() ? by_object_[object.value] : kNobody;
  }
  // Whether two different peers own the two objects.
  [[nodiscard]] bool have_two(ObjectId a, ObjectId b) const {
    const PeerId owner_a = of(a), owner_b = of(b);
    return owner_a != kNobody && owner_b != kNobody && owner_a != owner_b;
  }
  // Sets the owner of an object, which exists. kNobody: nobody owns it from now on. `as_founder`: the world's file
  // gives the object to the founder of the session, and the owner has it for no other reason.
  void set(ObjectId object, PeerId owner, bool as_founder = false) {
    assert(object.value < by_object_.size());
    assert(owner != kNobody || !as_founder);
    if (std::exchange(by_object_[object.value], owner) != owner) ++revision_;
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
    Iterator(const std::vector<PeerId>& by_object, std::size_t at) : by_object_(&by_object), at_(at) { find(); }
    value_type operator*() const { return {ObjectId{static_cast<std::uint32_t>(at_)}, (*by_object_)[at_]}; }
    Iterator& operator++() {
      ++at_;
      find();
      return *this;
    }
    Iterator operator++(int) {
      const Iterator before = *this;
      ++*this;
      return before;
    }
    friend bool operator==(const Iterator&, const Iterator&) = default;

   private:
    void find() {
      while (at_ < by_object_->size() && (*by_object_)[at_] == kNobody) ++at_;
    }
    const std::vector<PeerId>* by_object_ = nullptr;
    std::size_t at_ = 0;
  };
  [[nodiscard]] Iterator begin() const { return {by_object_, 0}; }
  [[nodiscard]] Iterator end() const { return {by_object_, by_object_.size()}; }
  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(std::ranges::distance(begin(), end())); }
  [[nodiscard]] auto from(ObjectId first) const {
    return std::ranges::subrange(Iterator(by_object_, std::min<std::size_t>(first.value, by_object_.size())), end());
  }

 private:
  std::vector<PeerId> by_object_;
  std::uint64_t revision_ = 0;
  std::set<ObjectId> as_founder_;
};

}  // namespace peerd::replication
