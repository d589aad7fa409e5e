#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/ids.hpp"

namespace peerd {

// An ObjectTable has a small value for each object, mostly none: objects of the world's file in a table by number, as
// there are many questions about them, the others in a map.
template <class Value>
class ObjectTable {
 public:
  explicit ObjectTable(Value none) : none_(none) {}

  // Returns the value of an object; `none` where it has none.
  [[nodiscard]] Value of(ObjectId id) const {
    if (id.packed() < of_file_.size()) return of_file_[id.packed()];  // no other origin is so low
    return of_added(id);
  }
  void set(ObjectId id, Value value) {
    if (id.origin != 0) {
      if (value == none_) {
        added_.erase(id);
      } else {
        added_.insert_or_assign(id, value);
      }
      return;
    }
    if (id.number >= of_file_.size()) {
      if (value == none_) return;
      of_file_.resize(id.number + std::size_t{1}, none_);
    }
    of_file_[id.number] = value;
  }
  void clear() {
    of_file_.clear();
    added_.clear();
  }

  // Returns the first object, from this one on, that has a value.
  [[nodiscard]] std::optional<std::pair<ObjectId, Value>> from(ObjectId first) const {
    if (first.origin == 0) {
      for (std::size_t i = first.number; i < of_file_.size(); ++i) {
        if (of_file_[i] != none_) return std::pair(ObjectId{static_cast<std::uint32_t>(i)}, of_file_[i]);
      }
    }
    const auto it = added_.lower_bound(first);
    return it == added_.end() ? std::nullopt : std::optional(std::pair(it->first, it->second));
  }

 private:
  [[nodiscard, gnu::noinline]] Value of_added(ObjectId id) const {  // so that of() is small where it is called
    const auto it = added_.find(id);
    return it == added_.end() ? none_ : it->second;
  }

  Value none_;
  std::vector<Value> of_file_;
  std::map<ObjectId, Value> added_;
};

}  // namespace peerd
