#pragma once
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <utility>
#include <vector>

namespace peerd {

// A table of items by their number, of which few are there: one that is not costs a pointer. Items keep their
// addresses; what erase() takes away leaves its memory to the next one.
template <class T>
class SparseTable {
 public:
  SparseTable() = default;
  explicit SparseTable(std::size_t size) : by_number_(size) {}
  SparseTable(SparseTable&&) = default;
  SparseTable& operator=(SparseTable&&) = default;

  [[nodiscard]] std::size_t size() const { return by_number_.size(); }
  [[nodiscard]] bool contains(std::size_t number) const { return find(number) != nullptr; }
  // Null where the item is not there.
  [[nodiscard]] T* find(std::size_t number) {
    assert(number < size());
    return by_number_[number] == nullptr ? nullptr : &by_number_[number]->item;
  }
  [[nodiscard]] const T* find(std::size_t number) const {
    assert(number < size());
    return by_number_[number] == nullptr ? nullptr : &by_number_[number]->item;
  }
  [[nodiscard]] T& operator[](std::size_t number) {
    assert(contains(number));
    return by_number_[number]->item;
  }
  [[nodiscard]] const T& operator[](std::size_t number) const {
    assert(contains(number));
    return by_number_[number]->item;
  }
  // The numbers of the items that are there, in the order in which they came; after erase() in any order.
  [[nodiscard]] std::span<const std::uint32_t> numbers() const { return numbers_; }

  // Puts an item where none is.
  T& add(std::size_t number, T item) {
    assert(!contains(number));
    Entry* entry = nullptr;
    if (free_.empty()) {
      entry = &entries_.emplace_back(Entry{std::move(item), {}});
    } else {
      entry = free_.back();
      free_.pop_back();
      entry->item = std::move(item);
    }
    entry->place = static_cast<std::uint32_t>(numbers_.size());
    by_number_[number] = entry;
    numbers_.push_back(static_cast<std::uint32_t>(number));
    return entry->item;
  }
  // Takes away the item that is there.
  void erase(std::size_t number) {
    assert(contains(number));
    Entry* const entry = std::exchange(by_number_[number], nullptr);
    entry->item = T{};
    const std::uint32_t last = numbers_.back();
    numbers_[entry->place] = last;
    numbers_.pop_back();
    if (last != number) by_number_[last]->place = entry->place;
    free_.push_back(entry);
  }
  // Puts an item behind all numbers.
  T& push_back(T item) {
    by_number_.push_back(nullptr);
    return add(size() - 1, std::move(item));
  }

 private:
  struct Entry {
    T item;
    std::uint32_t place;  // of its number in numbers_
  };

  std::vector<Entry*> by_number_;  // into entries_
  std::deque<Entry> entries_;
  std::vector<Entry*> free_;  // those of no number
  std::vector<std::uint32_t> numbers_;
};

}  // namespace peerd
