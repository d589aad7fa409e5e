#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "peerd/lab/recorded/recording.hpp"
#include "peerd/view/frames/pose_frame.hpp"

namespace peerd::recorded {

// Makes stretches of frames out of the rows of each instant. Each frame has the rows that have changed; one of a kind
// that is there no more has the owner 0.
class StretchWriter {
 public:
  // The rows of all kinds at that instant, which is after the last one, of a scene of that revision and so many nodes.
  void add(double t_s, std::uint32_t revision, std::size_t nodes, const view::PoseTable::Times& times,
           std::span<const view::PoseRow> rows);
  // Nothing is known between what was and what comes next.
  void interrupt();

  [[nodiscard]] const std::vector<Stretch>& stretches() const { return stretches_; }
  [[nodiscard]] std::vector<Stretch> finish();
  // The compressed bytes so far, and the rows in all frames.
  [[nodiscard]] std::size_t size_bytes() const { return size_bytes_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }

 private:
  static constexpr double kStretch_s = 2.0;
  struct Known {
    view::PoseRow row;
    std::uint64_t at = 0;  // the instant, by its number, that had the row last; 0: there is none
  };

  void find_changes(std::span<const view::PoseRow> rows);
  void put_frame(double t_s, const view::PoseTable::Times& times);
  void begin(double t_s, const view::PoseTable::Times& times);
  void close();

  std::vector<Stretch> stretches_;
  std::size_t size_bytes_ = 0, rows_ = 0;
  std::optional<Stretch> open_;  // its frames are not compressed yet
  std::vector<Known> known_[view::kPoseKinds];
  std::vector<view::PoseRow> changed_;
  std::uint64_t instant_ = 0;
};

}  // namespace peerd::recorded
