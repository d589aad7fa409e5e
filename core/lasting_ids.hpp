#pragma once
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/ids.hpp"

namespace peerd {

// LastingIds say which entry of a list has which lasting id. The entries of a text that was read count on from one id;
// those of what was edited since have any.
template <class Id>
class LastingIds {
 public:
  LastingIds() = default;  // a world as its file has it
  // The ids of a text that somebody adds to a world.
  explicit LastingIds(Id first) : first_(first) {}
  // The ids of all entries in their order, each once.
  explicit LastingIds(std::vector<Id> in_order) : in_order_(std::move(in_order)), edited_(true) {
    for (std::uint32_t i = 0; i < in_order_.size(); ++i) {
      const Id id = in_order_[i];
      if (id.origin != 0) {
        [[maybe_unused]] const bool is_new = added_.emplace(id, i).second;
        assert(is_new && "an id names one entry");
        continue;
      }
      if (id.number >= of_file_.size()) of_file_.resize(id.number + std::size_t{1}, kNone);
      assert(of_file_[id.number] == kNone && "an id names one entry");
      of_file_[id.number] = i;
    }
  }

  [[nodiscard]] Id id_of(std::uint32_t index) const {
    return edited_ ? in_order_[index] : Id{first_.number + index, first_.origin};
  }
  // Returns the index of an entry, which is below `count`, the number of entries; none: no entry has the id.
  [[nodiscard]] std::optional<std::uint32_t> find(Id id, std::size_t count) const {
    if (edited_) return find_edited(id);
    const std::uint64_t index = id.packed() - first_.packed();  // huge below the first
    return index < count ? std::optional(static_cast<std::uint32_t>(index)) : std::nullopt;
  }

 private:
  static constexpr std::uint32_t kNone = ~0u;
  [[nodiscard]] std::optional<std::uint32_t> find_edited(Id id) const {
    if (id.origin == 0) {
      const bool there = id.number < of_file_.size() && of_file_[id.number] != kNone;
      return there ? std::optional(of_file_[id.number]) : std::nullopt;
    }
    const auto it = added_.find(id);
    return it == added_.end() ? std::nullopt : std::optional(it->second);
  }

  Id first_;
  std::vector<Id> in_order_;
  bool edited_ = false;                          // by in_order_; otherwise they count on from first_
  std::vector<std::uint32_t> of_file_;           // index by number, for those of the world's file; kNone: removed
  std::unordered_map<Id, std::uint32_t> added_;  // index of the others
};

}  // namespace peerd
