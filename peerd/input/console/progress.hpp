#pragma once
#include <chrono>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace peerd {

// Where a series of simulated runs is.
struct SimProgress {
  std::size_t run = 0;             // index of the present run
  std::span<const double> runs_s;  // durations of all runs
  std::optional<double> run_s;     // how far the present run is; none: its motions have not begun
  double took_s = 0.0;             // real time since the first run began

  [[nodiscard]] double done() const;  // share of the simulated time of all runs, 0 to 1
};

// One line for a terminal: "run 3 of 20: 12 of 30 s simulated, 1 min 20 s left". The time left is that of the rest at
// the present pace, and is left out before a fiftieth is done or two seconds are over, when there is no telling.
[[nodiscard]] std::string progress_line(const SimProgress& progress);

// Shows lines in place of each other on standard error where that is a terminal, five times a second at most.
class ProgressDisplay {
 public:
  explicit ProgressDisplay(bool shown) : shown_(shown) {}
  ~ProgressDisplay() { clear(); }
  ProgressDisplay(const ProgressDisplay&) = delete;
  ProgressDisplay& operator=(const ProgressDisplay&) = delete;

  [[nodiscard]] bool due();
  void show(const std::string& line);
  void clear();

 private:
  bool shown_;
  bool on_screen_ = false;
  std::chrono::steady_clock::time_point next_{};
};

}  // namespace peerd
