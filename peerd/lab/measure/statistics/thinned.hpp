#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace peerd::measure {

// Keeps every n-th row of each series. n begins at 1 and doubles whenever more than `most` rows would be kept, so what
// is kept is even over each series and depends on nothing but the rows. The first row of each series is always kept, so
// that more series than `most` keep one row each.
template <class Row>
class Thinned {
 public:
  explicit Thinned(std::size_t most) : most_(most) {}

  // `ordinal` is the number of the row in its series, from 0 on.
  void add(std::uint64_t ordinal, Row row) {
    if (ordinal % stride_ != 0) return;
    rows_.push_back(std::move(row));
    ordinals_.push_back(ordinal);
    if (rows_.size() <= most_) return;
    stride_ *= 2;
    keep_every_stride();
    if (rows_.size() > most_ - most_ / 4) most_ = 2 * rows_.size();  // nearly all of them are the first of their series
  }

  // Every so many rows one was kept.
  [[nodiscard]] std::uint64_t stride() const { return stride_; }
  [[nodiscard]] std::vector<Row> take() { return std::move(rows_); }

 private:
  void keep_every_stride() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (ordinals_[i] % stride_ != 0) continue;
      if (kept != i) rows_[kept] = std::move(rows_[i]);
      ordinals_[kept++] = ordinals_[i];
    }
    rows_.erase(rows_.begin() + static_cast<std::ptrdiff_t>(kept), rows_.end());
    ordinals_.resize(kept);
  }

  std::size_t most_;
  std::uint64_t stride_ = 1;
  std::vector<Row> rows_;
  std::vector<std::uint64_t> ordinals_;  // of each row
};

}  // namespace peerd::measure
