#pragma once
#include <algorithm>
#include <chrono>
#include <ostream>

#include <spdlog/fmt/fmt.h>

namespace peerd {

// Shows how far a command has come through a stretch of world time, and an estimate of what is left, on a terminal's
// last line.
class WorldTimeProgress {
 public:
  // `terminal`: null: nothing is shown.
  WorldTimeProgress(std::ostream* terminal, double begin_s, double end_s)
      : terminal_(terminal), begin_s_(begin_s), end_s_(end_s) {}

  void show(double time_s) {
    if (terminal_ == nullptr) return;
    const auto now = std::chrono::steady_clock::now();
    if (now - shown_ < kPeriod) return;
    shown_ = now;
    const double taken_s = std::chrono::duration<double>(now - start_).count();
    const double left_s = taken_s * (end_s_ - time_s) / std::max(time_s - begin_s_, 1e-9);
    *terminal_ << fmt::format("\r\033[K{:.3f} s of {:.3f} s; about {:.0f} s left; Ctrl-C ends it", time_s, end_s_,
                              left_s)
               << std::flush;
    visible_ = true;
  }
  // Events are printed to the same terminal.
  void hide() {
    if (visible_) *terminal_ << "\r\033[K" << std::flush;
    visible_ = false;
  }

 private:
  static constexpr std::chrono::milliseconds kPeriod{500};

  std::ostream* terminal_;
  double begin_s_, end_s_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now(), shown_ = start_;
  bool visible_ = false;
};

}  // namespace peerd
