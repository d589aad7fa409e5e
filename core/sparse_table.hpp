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
// addresses.
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
    return by_number_[number];
  }
  [[nodiscard]] const T* find(std::size_t number) const {
    assert(number < size());
    return by_number_[number];
  }
  [[nodiscard]] T& operator[](std::size_t number) {
    assert(contains(number));
    return *by_number_[number];
  }
  [[nodiscard]] const T& operator[](std::size_t number) const {
    assert(contains(number));
    return *by_number_[number];
  }
  // The numbers of the items that are there, in the order in which they came.
  [[nodiscard]] std::span<const std::uint32_t> numbers() const { return numbers_; }

  // Puts an item where none is.
  T& add(std::size_t number, T item) {
    assert(!contains(number));
    T& added = items_.emplace_back(std::move(item));
    by_number_[number] = &added;
    numbers_.push_back(static_cast<std::uint32_t>(number));
    return added;
  }
  // Puts an item behind all numbers.
  T& push_back(T item) {
    by_number_.push_back(nullptr);
    return add(size() - 1, std::move(item));
  }

 private:
  std::vector<T*> by_number_;  // into items_
  std::deque<T> items_;
  std::vector<std::uint32_t> numbers_;
};

}  // namespace peerd
