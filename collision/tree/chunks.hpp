#pragma once
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <ranges>
#include <span>
#include <vector>

namespace peerd::collision {

// An array that grows at its end and whose entries stay where they are: its memory comes in chunks. It may also be a
// view of entries that someone else keeps, and doesn't grow then.
template <class T>
class Chunks {
 public:
  static constexpr std::uint32_t kShift = 6, kChunk = 1u << kShift;  // entries of a chunk

  Chunks() = default;
  explicit Chunks(std::span<const T> entries) : size_(static_cast<std::uint32_t>(entries.size())) {
    for (std::size_t i = 0; i < entries.size(); i += kChunk) chunks_.push_back(entries.data() + i);
  }

  [[nodiscard]] std::uint32_t size() const { return size_; }
  [[nodiscard]] const T& operator[](std::uint32_t i) const {
    assert(i < size_);
    return chunks_[i >> kShift][i & (kChunk - 1)];
  }
  [[nodiscard]] T& at(std::uint32_t i) {  // not of a view
    assert(i < size_ && i >> kShift < owned_.size());
    return owned_[i >> kShift][i & (kChunk - 1)];
  }
  // Adds an entry. There will never be more than `most`, so that small arrays take little memory.
  T& add(std::size_t most) {
    assert(size_ < most && chunks_.size() == owned_.size());
    if ((size_ & (kChunk - 1)) == 0) {
      const std::size_t capacity = std::min<std::size_t>(kChunk, most - size_);
      owned_.push_back(std::make_unique<T[]>(capacity));
      chunks_.push_back(owned_.back().get());
      capacity_ += capacity;
    }
    ++size_;
    return at(size_ - 1);
  }
  [[nodiscard]] std::size_t memory_bytes() const {
    return capacity_ * sizeof(T) + chunks_.capacity() * sizeof(T*) + owned_.capacity() * sizeof(std::unique_ptr<T[]>);
  }
  // All entries, in their order.
  [[nodiscard]] auto all() const {
    return std::views::iota(std::uint32_t{0}, size_) |
           std::views::transform([this](std::uint32_t i) -> const T& { return (*this)[i]; });
  }

 private:
  std::vector<const T*> chunks_;
  std::vector<std::unique_ptr<T[]>> owned_;  // the same memory, where it isn't someone else's
  std::size_t capacity_ = 0;                 // of what is owned
  std::uint32_t size_ = 0;
};

}  // namespace peerd::collision
