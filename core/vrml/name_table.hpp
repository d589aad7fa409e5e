#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

namespace peerd::vrml {

// A NameTable holds values by name, in the order in which the names came; the names are kept elsewhere. Large worlds
// name every node, so the table holds its entries side by side and its slots (open addressing, at most half of them
// taken) apart from them: std::unordered_map costs a block and twice the cache misses a name.
template <class Value>
class NameTable {
 public:
  [[nodiscard]] const Value* find(std::string_view name) const {
    if (slots_.empty()) return nullptr;
    const Slot& slot = slots_[place(name, hash(name))];
    return slot.entry == kFree ? nullptr : &entries_[slot.entry].second;
  }
  // Returns the value of `name`, made of nothing where it is new.
  Value& operator[](std::string_view name) {
    if (2 * entries_.size() >= slots_.size()) grow();
    const std::uint32_t h = hash(name);
    Slot& slot = slots_[place(name, h)];
    if (slot.entry == kFree) {
      slot = {h, static_cast<std::uint32_t>(entries_.size())};
      entries_.emplace_back(name, Value{});
    }
    return entries_[slot.entry].second;
  }

  [[nodiscard]] std::size_t size() const { return entries_.size(); }
  [[nodiscard]] auto begin() const { return entries_.begin(); }  // iterates over pairs of a name and its value
  [[nodiscard]] auto end() const { return entries_.end(); }

 private:
  static constexpr std::uint32_t kFree = std::numeric_limits<std::uint32_t>::max();
  struct Slot {
    std::uint32_t hash = 0, entry = kFree;
  };

  static std::uint32_t hash(std::string_view name) {
    return static_cast<std::uint32_t>(std::hash<std::string_view>{}(name));
  }
  // Returns the slot where `name` is, or would be. There is always a free slot to end at.
  [[nodiscard]] std::size_t place(std::string_view name, std::uint32_t hash) const {
    const std::size_t mask = slots_.size() - 1;
    std::size_t i = hash & mask;
    while (slots_[i].entry != kFree && (slots_[i].hash != hash || entries_[slots_[i].entry].first != name)) {
      i = (i + 1) & mask;
    }
    return i;
  }
  void grow() {
    const std::vector<Slot> old = std::exchange(slots_, std::vector<Slot>(slots_.empty() ? 16 : 4 * slots_.size()));
    const std::size_t mask = slots_.size() - 1;
    for (const Slot& slot : old) {
      if (slot.entry == kFree) continue;
      std::size_t i = slot.hash & mask;
      while (slots_[i].entry != kFree) i = (i + 1) & mask;
      slots_[i] = slot;
    }
  }

  std::vector<std::pair<std::string_view, Value>> entries_;
  std::vector<Slot> slots_;  // a power of two
};

// A LateNameTable is a NameTable for names that most texts never look up: they wait in a list until one is looked for.
// A lookup costs a cache miss, and those of names that follow one another overlap.
template <class Value>
class LateNameTable {
 public:
  // The last value of a name counts.
  void set(std::string_view name, Value value) { waiting_.emplace_back(name, value); }

  [[nodiscard]] const Value* find(std::string_view name) { return table().find(name); }
  [[nodiscard]] const NameTable<Value>& table() {
    for (const auto& [name, value] : waiting_) table_[name] = value;
    waiting_.clear();
    return table_;
  }

 private:
  NameTable<Value> table_;
  std::vector<std::pair<std::string_view, Value>> waiting_;
};

}  // namespace peerd::vrml
