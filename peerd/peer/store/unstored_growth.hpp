#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <span>
#include <vector>

#include "replication/wire/operation.hpp"

namespace peerd::store {

// The growth of logs that is not in the store yet, in its order. While the store cannot be written this grows with
// the number of authors, and by one entry per kGrowthMax_bytes or so, however many operations these are.
class UnstoredGrowth {
 public:
  static constexpr std::uint64_t kGrowthMax_bytes = std::uint64_t{1} << 20;
  static constexpr std::uint64_t kBatchMax_bytes = std::uint64_t{8} << 20;

  struct Growth {
    replication::OperationRange range;
    replication::OperationId last;  // the last operation in it
  };

  // Whole operations, which begin where those of that author end.
  void add(const Growth& growth);
  [[nodiscard]] bool empty() const { return entries_.empty(); }
  [[nodiscard]] std::size_t count() const { return entries_.size(); }
  [[nodiscard]] std::uint64_t bytes() const { return bytes_; }
  // The first ones, for one transaction: at least one, and so many that they have kBatchMax_bytes at most.
  [[nodiscard]] std::vector<Growth> next_batch() const;
  // The first `count` ones are stored.
  void drop(std::size_t count);

 private:
  std::deque<Growth> entries_;
  std::map<replication::AuthorId, std::uint64_t> newest_;  // the number of the last entry of each author
  std::uint64_t dropped_ = 0;                              // so many entries were before the first one
  std::uint64_t bytes_ = 0;
};

}  // namespace peerd::store
