#pragma once
#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace peerd {

// A SharedArray is an immutable array that any number of owners share: a copy costs a reference count. It keeps its
// elements alive, be they its own or a part of something larger, as the numbers that a text was read into.
template <class T>
class SharedArray {
 public:
  SharedArray() = default;
  SharedArray(std::vector<T> elements) {  // NOLINT: a vector is one
    const auto owned = std::make_shared<const std::vector<T>>(std::move(elements));
    view_ = *owned;
    owner_ = owned;
  }
  SharedArray(std::shared_ptr<const void> owner, std::span<const T> part) : owner_(std::move(owner)), view_(part) {}

  [[nodiscard]] const T& operator[](std::size_t i) const { return view_[i]; }
  [[nodiscard]] std::size_t size() const { return view_.size(); }
  [[nodiscard]] bool empty() const { return view_.empty(); }
  [[nodiscard]] const T* data() const { return view_.data(); }
  [[nodiscard]] auto begin() const { return view_.begin(); }
  [[nodiscard]] auto end() const { return view_.end(); }
  [[nodiscard]] std::span<const T> span() const { return view_; }

  // Whether the two share their elements. Arrays with equal elements of their own are two.
  friend bool operator==(const SharedArray& a, const SharedArray& b) {
    return a.data() == b.data() && a.size() == b.size();
  }

 private:
  std::shared_ptr<const void> owner_;
  std::span<const T> view_;
};

}  // namespace peerd
