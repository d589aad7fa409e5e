#include "replication/wire/smallest_three.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstdlib>
#include <numbers>

namespace peerd::replication {
namespace {

constexpr double kUnit_steps = std::numbers::sqrt2 * SmallestThree::kMost;
constexpr double kStep = 1.0 / kUnit_steps;
constexpr std::int32_t kUnit_steps2 = 2 * SmallestThree::kMost * SmallestThree::kMost;  // exactly

std::array<double, 4> components(const Quat& q) { return {q.w(), q.x(), q.y(), q.z()}; }

std::optional<SmallestThree> without(const std::array<double, 4>& q, int largest) {
  SmallestThree three{largest, {}};
  const double sign = q[static_cast<std::size_t>(largest)] < 0.0 ? -1.0 : 1.0;
  std::size_t out = 0;
  for (int i = 0; i < 4; ++i) {
    if (i == largest) continue;
    const double steps = std::nearbyint(sign * q[static_cast<std::size_t>(i)] * kUnit_steps);
    if (!(std::abs(steps) <= SmallestThree::kMost)) return std::nullopt;
    three.steps[out++] = static_cast<std::int32_t>(steps);
  }
  return three;
}

}  // namespace

std::optional<Quat> to_orientation(const SmallestThree& three) {
  assert(three.largest >= 0 && three.largest < 4);
  std::int32_t left = kUnit_steps2;
  for (const std::int32_t n : three.steps) {
    assert(std::abs(n) <= SmallestThree::kMost);
    left -= n * n;
  }
  if (left < 0) return std::nullopt;
  std::array<double, 4> q{};
  std::size_t in = 0;
  for (int i = 0; i < 4; ++i) {
    q[static_cast<std::size_t>(i)] = kStep * (i == three.largest ? std::sqrt(double{1} * left) : three.steps[in++]);
  }
  if (left == kUnit_steps2)
    q[static_cast<std::size_t>(three.largest)] = 1.0;  // the exact value, whatever rounding does
  return Quat(q[0], q[1], q[2], q[3]);
}

// Rounding may have exchanged the two largest components where they are almost equal: then another one is left out
// than before, and only leaving out the same one again gives the same bits.
SmallestThree smallest_three(const Quat& orientation) {
  const std::array<double, 4> q = components(orientation);
  const auto larger = [](double a, double b) { return std::abs(a) < std::abs(b); };
  const int largest = static_cast<int>(std::ranges::max_element(q, larger) - q.begin());
  const auto gives_it = [&](const std::optional<SmallestThree>& three) {
    const auto back = three ? to_orientation(*three) : std::nullopt;
    return back && components(*back) == q;
  };
  // A unit quaternion's largest is at least 1/2, its others at most 1 / sqrt(2) but for rounding.
  std::array<double, 4> within = q;
  for (double& c : within) c = std::clamp(c, -std::numbers::sqrt2 / 2.0, std::numbers::sqrt2 / 2.0);
  within[static_cast<std::size_t>(largest)] = q[static_cast<std::size_t>(largest)];
  const SmallestThree nearest = *without(within, largest);
  if (gives_it(nearest)) return nearest;
  for (const int i : {0, 2, 1, 3}) {  // w and y first: an object that is turned about the vertical has no others
    const auto other = without(q, i);
    if (gives_it(other)) return *other;
  }
  return nearest;
}

}  // namespace peerd::replication
