#pragma once
#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

namespace peerd {

// An Arena is memory that is only freed as a whole. Allocated objects stay where they are, so views into them hold as
// long as the arena lives.
class Arena {
 public:
  // Returns uninitialised memory. Large arrays get a block of their own size, small ones share blocks.
  template <class T>
  [[nodiscard]] std::span<T> allocate(std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
    return {static_cast<T*>(bytes(count * sizeof(T), alignof(T))), count};
  }
  template <class T>
  [[nodiscard]] std::span<const T> copy(std::span<const T> elements) {
    const std::span<T> out = allocate<T>(elements.size());
    std::ranges::copy(elements, out.begin());
    return out;
  }
  [[nodiscard]] std::string_view copy(std::string_view text) {
    const auto out = copy(std::span<const char>(text));
    return {out.data(), out.size()};
  }

  [[nodiscard]] std::size_t size_bytes() const { return size_; }  // size of all blocks

 private:
  static constexpr std::size_t kFirstBlock = 4096;
  static constexpr std::size_t kLargestBlock = std::size_t{1} << 18;

  void* bytes(std::size_t size, std::size_t alignment) {
    const std::size_t padding = -used_ & (alignment - 1);  // a power of two, and a division costs more than the rest
    if (size + padding > free_) {
      if (size > kLargestBlock / 4) return add_block(size);  // the block in use stays in use
      next_block_ = std::min(2 * next_block_, kLargestBlock);
      const std::size_t block = std::max(size, next_block_);
      begin_ = add_block(block);
      used_ = 0;
      free_ = block;
      return take(size, 0);
    }
    return take(size, padding);
  }
  void* take(std::size_t size, std::size_t padding) {
    std::byte* const at = begin_ + used_ + padding;
    used_ += padding + size;
    free_ -= padding + size;
    return at;
  }
  std::byte* add_block(std::size_t size) {
    blocks_.push_back(std::make_unique_for_overwrite<std::byte[]>(std::max<std::size_t>(size, 1)));
    size_ += size;
    return blocks_.back().get();
  }

  std::vector<std::unique_ptr<std::byte[]>> blocks_;  // each aligned for any type
  std::byte* begin_ = nullptr;                        // state of the block in use
  std::size_t used_ = 0, free_ = 0;                   // state of the block in use
  std::size_t next_block_ = kFirstBlock / 2;
  std::size_t size_ = 0;
};

// A GrowingList grows inside an arena. When the caller guessed the count right, it takes one block of the right size;
// otherwise the outgrown blocks stay in the arena unused.
template <class T>
class GrowingList {
 public:
  GrowingList(Arena& arena, std::size_t guess) : arena_(arena), block_(arena.allocate<T>(guess)) {}

  void add(T element) {
    if (count_ == block_.size()) grow();
    block_[count_++] = element;
  }
  [[nodiscard]] std::span<const T> elements() const { return block_.first(count_); }

 private:
  void grow() {
    const auto larger = arena_.allocate<T>(std::max<std::size_t>(8, 2 * count_));
    std::ranges::copy(elements(), larger.begin());
    block_ = larger;
  }

  Arena& arena_;
  std::span<T> block_;
  std::size_t count_ = 0;
};

}  // namespace peerd
