#include "peerd/lab/baselines/responsiveness.hpp"

#include <algorithm>
#include <limits>

#include "core/motion/key_sensors.hpp"

namespace peerd::baselines {
namespace {

using measure::GhostSample;

const Vec3& in_picture(const GhostSample& sample, Picture picture) {
  return picture == Picture::kOwners ? sample.seen.position : sample.shown.position;
}

// The mean distance between a picture and the truth that much earlier, straight between samples.
double mean_distance_m(std::span<const GhostSample> view, Picture picture, double delay) {
  double sum = 0.0;
  std::size_t count = 0, next = 1;
  for (const GhostSample& sample : view) {
    if (sample.t_s < view.front().t_s + kDelayMax_s) continue;  // the same samples for all delays
    const double t_s = sample.t_s - delay;
    while (next + 1 < view.size() && view[next].t_s < t_s) ++next;
    const GhostSample &a = view[next - 1], &b = view[next];
    const double part = b.t_s > a.t_s ? (t_s - a.t_s) / (b.t_s - a.t_s) : 1.0;
    const Vec3 truth = a.truth.position + part * (b.truth.position - a.truth.position);
    sum += (in_picture(sample, picture) - truth).norm();
    ++count;
  }
  return count == 0 ? std::numeric_limits<double>::infinity() : sum / static_cast<double>(count);
}

}  // namespace

bool moves(std::span<const GhostSample> view) {
  constexpr double kStands_m = 1e-3;
  double way_m = 0.0;
  for (std::size_t i = 1; i < view.size(); ++i) {
    way_m += (view[i].truth.position - view[i - 1].truth.position).norm();
  }
  return way_m >= kStands_m;
}

// Coarse steps find the valley, fine ones its bottom.
std::optional<double> delay_s(std::span<const GhostSample> view, Picture picture) {
  constexpr double kCoarse_s = 0.02, kFine_s = 0.0025;
  if (view.size() < 2 || view.back().t_s - view.front().t_s <= 2.0 * kDelayMax_s || !moves(view)) return std::nullopt;
  for (std::size_t i = 1; i < view.size(); ++i) {
    if (view[i].t_s - view[i - 1].t_s > kSampleStepMax_s) return std::nullopt;
  }
  double best_s = 0.0, least_m = std::numeric_limits<double>::infinity();
  const auto search = [&](double from_s, double to_s, double step_s) {
    for (int step = 0; from_s + step * step_s <= to_s; ++step) {
      const double distance_m = mean_distance_m(view, picture, from_s + step * step_s);
      if (distance_m < least_m) (least_m = distance_m, best_s = from_s + step * step_s);
    }
  };
  search(0.0, kDelayMax_s, kCoarse_s);
  search(std::max(0.0, best_s - kCoarse_s), std::min(kDelayMax_s, best_s + kCoarse_s), kFine_s);
  return best_s;
}

std::vector<KeyMove> key_moves(const config::RunSettings& run, std::span<const config::PeerObjects> objects,
                               const Scene& scene) {
  std::vector<KeyMove> moves;
  for (std::size_t i = 0; i < run.peers.size(); ++i) {
    KeySensors sensors(scene);
    for (const config::ScriptedKey& key : run.peers[i].keys) {
      for (const std::size_t hit : sensors.press(key.key).hits) {
        const auto recipient = scene.key_sensors[hit].recipient;
        const bool moves_it = recipient && std::ranges::find(objects[i].owned, *recipient) != objects[i].owned.end() &&
                              !objects[i].motions.contains(*recipient);
        if (moves_it) moves.push_back({key.at_s, *recipient});
      }
    }
  }
  return moves;
}

std::optional<double> response_s(std::span<const GhostSample> view, Picture picture, double at_s) {
  const auto before = std::ranges::lower_bound(view, at_s - kCourse_s, {}, &GhostSample::t_s);
  const auto after = std::ranges::upper_bound(view, at_s, {}, &GhostSample::t_s);
  if (before == view.begin() || after - before < 2) return std::nullopt;
  const GhostSample &first = *before, &last = *(after - 1);
  const Vec3 place = in_picture(last, picture);
  const Vec3 velocity = (place - in_picture(first, picture)) / (last.t_s - first.t_s);
  const auto off_course_m = [&](const GhostSample& sample) {
    return (in_picture(sample, picture) - (place + (sample.t_s - last.t_s) * velocity)).norm();
  };
  double usual_m = 0.0;  // a picture may go by steps
  for (auto sample = before; sample != after; ++sample) usual_m = std::max(usual_m, off_course_m(*sample));
  for (auto sample = after; sample != view.end(); ++sample) {
    if (off_course_m(*sample) > usual_m + kLeaves_m) return sample->t_s - at_s;
  }
  return std::nullopt;
}

}  // namespace peerd::baselines
