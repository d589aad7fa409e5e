#include "peerd/input/console/progress.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numeric>

#include <spdlog/fmt/fmt.h>

namespace peerd {
namespace {

constexpr double kLeastDone = 0.02, kLeastTook_s = 2.0;

std::string duration_text(double s) {
  const auto whole_s = static_cast<long>(std::ceil(s));
  if (whole_s < 60) return fmt::format("{} s", whole_s);
  if (whole_s < 3600) return fmt::format("{} min {} s", whole_s / 60, whole_s % 60);
  return fmt::format("{} h {} min", whole_s / 3600, whole_s % 3600 / 60);
}

}  // namespace

double SimProgress::done() const {
  const double all_s = std::accumulate(runs_s.begin(), runs_s.end(), 0.0);
  const double before_s = std::accumulate(runs_s.begin(), runs_s.begin() + static_cast<std::ptrdiff_t>(run), 0.0);
  const double now_s = before_s + std::clamp(run_s.value_or(0.0), 0.0, runs_s[run]);
  return all_s > 0.0 ? now_s / all_s : 0.0;
}

std::string progress_line(const SimProgress& progress) {
  std::string line = fmt::format("run {} of {}", progress.run + 1, progress.runs_s.size());
  const double of_s = progress.runs_s[progress.run];
  line += progress.run_s ? fmt::format(": {:.0f} of {:.0f} s simulated", std::clamp(*progress.run_s, 0.0, of_s), of_s)
                         : ": the peers are joining";
  const double done = progress.done();
  if (done < kLeastDone || progress.took_s < kLeastTook_s) return line;
  return line + ", " + duration_text(progress.took_s * (1.0 - done) / done) + " left";
}

bool ProgressDisplay::due() {
  if (!shown_) return false;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return false;
  next_ = now + std::chrono::milliseconds(200);
  return true;
}

void ProgressDisplay::show(const std::string& line) {
  std::cerr << '\r' << line << "\033[K" << std::flush;
  on_screen_ = true;
}

void ProgressDisplay::clear() {
  if (on_screen_) std::cerr << "\r\033[K" << std::flush;
  on_screen_ = false;
}

}  // namespace peerd
