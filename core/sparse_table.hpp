#pragma once
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <utility>
#include <vector>

namespace peerd {

// Small items by number, in one block of memory: a hash table with linear probing, which erases by moving back what
// comes behind (Knuth, The Art of Computer Programming 3, 6.4, algorithm R). Items may move with any change.
template <class T>
class NumberMap {
 public:
  [[nodiscard]] std::size_t size() const { return size_; }
  // Null where the item is not there.
  [[nodiscard]] const T* find(std::uint32_t number) const {
    if (size_ == 0) return nullptr;
    for (std::size_t i = home_of(number);; i = next(i)) {
      if (!slots_[i].is_used) return nullptr;
      if (slots_[i].number == number) return &slots_[i].item;
    }
  }
  // Puts an item where none is.
  void add(std::uint32_t number, T item) {
    assert(find(number) == nullptr);
    if (2 * (size_ + 1) > slots_.size()) grow();
    put({number, true, std::move(item)});
    ++size_;
  }
  // Takes away the item that is there.
  void erase(std::uint32_t number) {
    assert(find(number) != nullptr);
    std::size_t gap = home_of(number);
    while (slots_[gap].number != number) gap = next(gap);
    for (std::size_t i = next(gap); slots_[i].is_used; i = next(i)) {
      const std::size_t from_home = (i - home_of(slots_[i].number)) & (slots_.size() - 1);
      if (from_home < ((i - gap) & (slots_.size() - 1))) continue;  // its search does not pass the gap
      slots_[gap] = std::move(slots_[i]);
      gap = i;
    }
    slots_[gap] = {};
    --size_;
  }

 private:
  struct Slot {
    std::uint32_t number = 0;
    bool is_used = false;
    T item{};
  };

  [[nodiscard]] std::size_t home_of(std::uint32_t number) const {  // Knuth's multiplicative hashing
    return (number * 0x9E3779B97F4A7C15ULL) >> shift_;
  }
  [[nodiscard]] std::size_t next(std::size_t i) const { return (i + 1) & (slots_.size() - 1); }
  void put(Slot slot) {
    std::size_t i = home_of(slot.number);
    while (slots_[i].is_used) i = next(i);
    slots_[i] = std::move(slot);
  }
  void grow() {
    std::vector<Slot> before = std::exchange(slots_, {});
    shift_ = before.empty() ? 60 : shift_ - 1;
    slots_.resize(std::size_t{1} << (64 - shift_));
    for (Slot& slot : before) {
      if (slot.is_used) put(std::move(slot));
    }
  }

  std::vector<Slot> slots_;  // a power of two of them, at most half of them used
  int shift_ = 60;           // of a hash, to an index into slots_
  std::size_t size_ = 0;
};

// A table of items by their number, of which few are there. Items keep their addresses; what erase() takes away leaves
// its memory, and its slot, to the next one. One that is not there costs a pointer, or nothing where numbers are
// hashed: that is where there are more than kLargestList of them, unless somebody says otherwise.
template <class T>
class SparseTable {
 public:
  static constexpr std::size_t kLargestList = std::size_t{1} << 16;

  SparseTable() = default;
  explicit SparseTable(std::size_t size) : SparseTable(size, size > kLargestList) {}
  SparseTable(std::size_t size, bool hashes) : size_(size), hashes_(hashes), by_list_(hashes ? 0 : size) {}
  SparseTable(SparseTable&&) = default;
  SparseTable& operator=(SparseTable&&) = default;

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool contains(std::size_t number) const { return entry_of(number) != nullptr; }
  // Null where the item is not there.
  [[nodiscard]] T* find(std::size_t number) {
    Entry* const entry = entry_of(number);
    return entry == nullptr ? nullptr : &entry->item;
  }
  [[nodiscard]] const T* find(std::size_t number) const {
    const Entry* const entry = entry_of(number);
    return entry == nullptr ? nullptr : &entry->item;
  }
  [[nodiscard]] T& operator[](std::size_t number) {
    assert(contains(number));
    return entry_of(number)->item;
  }
  [[nodiscard]] const T& operator[](std::size_t number) const {
    assert(contains(number));
    return entry_of(number)->item;
  }
  // The numbers of the items that are there, in the order in which they came; after erase() in any order.
  [[nodiscard]] std::span<const std::uint32_t> numbers() const { return numbers_; }

  // Each item that is there has a slot of its own, below slots().
  [[nodiscard]] std::size_t slots() const { return entries_.size(); }
  [[nodiscard]] std::size_t slot_of(std::size_t number) const {
    assert(contains(number));
    return entry_of(number)->slot;
  }
  // The number of the item in that slot; there is one.
  [[nodiscard]] std::uint32_t number_in(std::size_t slot) const { return numbers_[entries_[slot].place]; }

  // Puts an item where none is.
  T& add(std::size_t number, T item) {
    assert(!contains(number));
    Entry* entry = nullptr;
    if (free_.empty()) {
      entry = &entries_.emplace_back(Entry{std::move(item), {}, static_cast<std::uint32_t>(entries_.size())});
    } else {
      entry = free_.back();
      free_.pop_back();
      entry->item = std::move(item);
    }
    entry->place = static_cast<std::uint32_t>(numbers_.size());
    if (hashes_) {
      by_hash_.add(static_cast<std::uint32_t>(number), entry);
    } else {
      by_list_[number] = entry;
    }
    numbers_.push_back(static_cast<std::uint32_t>(number));
    return entry->item;
  }
  // Takes away the item that is there.
  void erase(std::size_t number) {
    Entry* const entry = entry_of(number);
    assert(entry != nullptr);
    if (hashes_) {
      by_hash_.erase(static_cast<std::uint32_t>(number));
    } else {
      by_list_[number] = nullptr;
    }
    entry->item = T{};
    const std::uint32_t last = numbers_.back();
    numbers_[entry->place] = last;
    numbers_.pop_back();
    if (last != number) entry_of(last)->place = entry->place;
    free_.push_back(entry);
  }
  // Puts an item behind all numbers.
  T& push_back(T item) {
    if (!hashes_) by_list_.push_back(nullptr);
    return add(size_++, std::move(item));
  }

 private:
  struct Entry {
    T item;
    std::uint32_t place;  // of its number in numbers_
    std::uint32_t slot;   // its place in entries_
  };

  [[nodiscard]] Entry* entry_of(std::size_t number) const {
    assert(number < size_);
    if (!hashes_) return by_list_[number];
    Entry* const* const at = by_hash_.find(static_cast<std::uint32_t>(number));
    return at == nullptr ? nullptr : *at;
  }

  std::size_t size_ = 0;
  bool hashes_ = false;
  std::vector<Entry*> by_list_;  // into entries_, unless it hashes
  NumberMap<Entry*> by_hash_;    // into entries_, if it hashes
  std::deque<Entry> entries_;
  std::vector<Entry*> free_;  // those of no number
  std::vector<std::uint32_t> numbers_;
};

}  // namespace peerd
