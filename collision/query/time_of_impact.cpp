#include "collision/query/time_of_impact.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <tuple>

#include "collision/exact/infinity.hpp"
#include "collision/exact/ordered_sums.hpp"
#include "collision/exact/triangle_distance.hpp"
#include "collision/query/wide_impact.hpp"

namespace peerd::collision {

using Ref = WideTree::Ref;

namespace {

// A window is so long that nothing turns farther than this [rad], and nothing moves farther than this part of the
// larger mesh: bounds of the motion are loose beyond, and more pairs are visited. Where few are, a window may be
// kLongerIdle times as long.
constexpr double kWindow_rad = 0.0625;
constexpr double kWindowOfExtent = 0.125;
constexpr double kLongerIdle = 8.0;
constexpr std::uint32_t kIdleWork = 16;
// The line between two near points tells their sides while rounding turns it by less than this.
constexpr double kClearSide = 0x1p-10;
// The relative accuracy to which the direction between two triangles is sought: the gap along any direction is certain,
// so a rough one will do.
constexpr double kRelativeAccuracy = 0.125;
// The pairs that a window may visit before it is given up. It is tried again half as long, with kMoreWork times as
// many; the next kShortWindows windows are then no longer. Where meshes are close along large parts, shorter windows
// don't visit fewer pairs, hence the 4.
constexpr std::uint32_t kWindowWork = 512, kMoreWork = 4, kShortWindows = 4;

// No point of the soup is farther from its frame's origin.
double radius(const TriangleSoup& soup) {
  Vec3 far;
  for (int k = 0; k < 3; ++k) far[k] = std::max(std::abs(soup.box.lo[k]), std::abs(soup.box.hi[k]));
  return length(far) * (1.0 + 0x1p-50);
}

// The motion of material points of both bodies at an instant, in A's frame as it stands then.
struct MotionState {
  RelativeMotion a_from_b;
  Mat3 world_from_a;
  Vec3 velocity_a, velocity_b;                  // of the bodies' origins [m/s]
  Vec3 angular_velocity_a, angular_velocity_b;  // [rad/s]
  Vec3 pressing;                                // A's acceleration less B's [m/s^2]

  MotionState(const KinematicState& a, const KinematicState& b)
      : a_from_b(a.pose(), b.pose()),
        world_from_a(a.orientation.toRotationMatrix()),
        velocity_a(rotate_back(world_from_a, a.velocity)),
        velocity_b(rotate_back(world_from_a, b.velocity)),
        angular_velocity_a(a.angular_velocity_body),
        angular_velocity_b(multiply(a_from_b.rotation, b.angular_velocity_body)),
        pressing(rotate_back(world_from_a, a.acceleration - b.acceleration)) {}

  [[nodiscard]] Vec3 velocity_at_a(const Vec3& p) const { return velocity_a + angular_velocity_a.cross(p); }
  [[nodiscard]] Vec3 velocity_at_b(const Vec3& p) const {
    return velocity_b + angular_velocity_b.cross(p - a_from_b.translation);
  }
};

// The time until a gap that closes at `closing` and ever faster, by `closing_acceleration_bound` [m/s^2] at most, is
// gone.
double time_to_close(double gap, double closing, double closing_acceleration_bound) {
  if (gap <= 0.0) return 0.0;
  if (closing <= 0.0 && closing_acceleration_bound <= 0.0) return kInfinity;
  const double root = std::sqrt(closing * closing + 2.0 * closing_acceleration_bound * gap);
  const double s = closing > 0.0 ? 2.0 * gap / (closing + root) : (root - closing) / closing_acceleration_bound;
  assert(!(s < 0.0));
  return s * (1.0 - 0x1p-45);
}

// The corners of two triangles along a direction from A to B: their places [m] and speeds [m/s].
struct AxisProjections {
  std::array<double, 3> at_a, at_b, speed_a, speed_b;

  AxisProjections(const MotionState& now, const Vec3& n, const Triangle& a, const Triangle& b) {
    for (std::size_t i = 0; i < 3; ++i) {
      at_a[i] = dot(n, a[i]);
      at_b[i] = dot(n, b[i]);
      speed_a[i] = dot(n, now.velocity_at_a(a[i]));
      speed_b[i] = dot(n, now.velocity_at_b(b[i]));
    }
  }
  [[nodiscard]] double gap() const { return *std::ranges::min_element(at_b) - *std::ranges::max_element(at_a); }

  // A time for which the gap certainly stays above `least` [m], corner against corner [s].
  [[nodiscard]] double time_above(double least, double closing_acceleration_bound) const {
    double s = kInfinity;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j)
        s = std::min(s, time_to_close(at_b[j] - at_a[i] - least, speed_a[i] - speed_b[j], closing_acceleration_bound));
    }
    return s;
  }

  // The closing speed of the corners that are within `reach` [m] of being the nearest [m/s].
  [[nodiscard]] double closing_speed(double reach) const {
    const double last = *std::ranges::max_element(at_a), first = *std::ranges::min_element(at_b);
    double fastest = -kInfinity, slowest = kInfinity;
    for (std::size_t i = 0; i < 3; ++i) {
      if (at_a[i] >= last - reach) fastest = std::max(fastest, speed_a[i]);
      if (at_b[i] <= first + reach) slowest = std::min(slowest, speed_b[i]);
    }
    return fastest - slowest;
  }
};

// Calls visit(n, noise) for directions that may have triangles that don't touch on either side, in either sense: of
// faces, of pairs of edges, across an edge in its face, of their nearest points (`between`), until it returns false.
// `noise`: what rounding makes of a direction between near points; a face's and an edge's hang on lengths that are not
// small.
template <class Visit>
void for_each_direction(const Triangle& a, const Triangle& b, const Vec3& between, double noise, Visit&& visit) {
  // Of vectors that are parallel but for rounding the product is mostly that.
  const auto go = [&](const Vec3& u, const Vec3& v) {
    const Vec3 n = u.cross(v);
    const double size = length(n);
    if (!(size > 0x1p-40 * length(u) * length(v)) || !std::isfinite(size)) return true;
    return visit(Vec3(n / size), 0.0);
  };
  for (const Triangle* face : {&b, &a}) {
    if (!go((*face)[1] - (*face)[0], (*face)[2] - (*face)[0])) return;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      if (!go(a[(i + 1) % 3] - a[i], b[(j + 1) % 3] - b[j])) return;
    }
  }
  // A body that slides towards the next triangle of a floor is above it: across an edge of that triangle, or of its
  // own.
  for (const Triangle* face : {&b, &a}) {
    const Vec3 normal = ((*face)[1] - (*face)[0]).cross((*face)[2] - (*face)[0]);
    for (std::size_t i = 0; i < 3; ++i) {
      if (!go(normal, (*face)[(i + 1) % 3] - (*face)[i])) return;
    }
  }
  if (noise < 1.0) visit(between, noise);
}

template <class Then>
void for_each_bit(std::uint32_t bits, Then&& then) {
  for (; bits != 0; bits &= bits - 1) then(static_cast<std::size_t>(std::countr_zero(bits)));
}

}  // namespace

class MeshImpactQuery::Search {
 public:
  Search(MeshImpactQuery& memory, WideTree& a, const KinematicState& motion_a, WideTree& b,
         const KinematicState& motion_b, double step_s, const MeshImpactOptions& options)
      : stack_(memory.stack_),
        pairs_(memory.pairs_),
        a_(a),
        b_(b),
        motion_a_(motion_a),
        motion_b_(motion_b),
        options_(options),
        step_s_(step_s),
        best_s_(step_s) {
    rate_a_ = length(motion_a.angular_velocity_body) * (1.0 + 0x1p-40);
    rate_b_ = length(motion_b.angular_velocity_body) * (1.0 + 0x1p-40);
    const double edge_a = rate_a_ * radius(a.soup()), edge_b = rate_b_ * radius(b.soup());
    spin_speed_m_s_ = edge_a + edge_b;
    centripetal_m_s2_ = (rate_a_ * edge_a + rate_b_ * edge_b) * (1.0 + 0x1p-40);
    assert(!(rate_a_ < 0.0) && !(rate_b_ < 0.0) && !(spin_speed_m_s_ < 0.0) && !(centripetal_m_s2_ < 0.0));
    acceleration_m_s2_ = length(motion_a.acceleration - motion_b.acceleration) * (1.0 + 0x1p-40);
    coordinate_bound_m_ = magnitude(motion_a.position) + magnitude(motion_b.position) + a.extent_m() + b.extent_m() +
                          magnitude(a.origin()) + magnitude(b.origin());
  }

  // Whether two triangles that share a point are in each other: they touch where they are apart along some direction,
  // but for rounding.
  [[nodiscard]] bool penetrate(const FacePair& faces, const MotionState& now) const {
    const Triangle a = a_.soup().triangle(faces.a), in_b = b_.soup().triangle(faces.b);
    const Triangle b = {now.a_from_b(in_b[0]), now.a_from_b(in_b[1]), now.a_from_b(in_b[2])};
    const double rounding = rounding_at(now);
    bool apart = false;
    for_each_direction(a, b, Vec3::Zero(), 1.0, [&](const Vec3& n, double) {
      apart = AxisProjections(now, n, a, b).gap() >= -rounding || AxisProjections(now, -n, a, b).gap() >= -rounding;
      return !apart;
    });
    return !apart;
  }

  MeshImpact run() {
    assert(step_s_ >= 0.0 && options_.tolerance_m >= 0.0);
    const double usual_s = usual_window();
    double from_s = 0.0, window_s = usual_s;
    std::uint32_t max_work = kWindowWork, short_windows_left = 0;
    while (true) {
      // Time must advance in spite of rounding.
      const double until_s = std::min(best_s_, std::max(from_s + window_s, from_s * (1.0 + 0x1p-40)));
      assert(until_s >= from_s);
      const std::uint32_t work = search_window(from_s, until_s, max_work);
      if (exhausted_ || too_far_apart_) {
        impact_.state = exhausted_ ? MeshImpactState::kIterationLimit : MeshImpactState::kTooLarge;
        impact_.time_s = from_s;
        return impact_;
      }
      if (work > max_work) {  // given up
        window_s = 0.5 * (until_s - from_s);
        max_work *= kMoreWork;
        short_windows_left = kShortWindows;
        continue;
      }
      if (until_s >= best_s_) break;
      from_s = until_s;
      max_work = std::max(kWindowWork, 2 * work);
      if (short_windows_left > 0) --short_windows_left;
      // The meshes are far where the roots alone are visited, and windows may become ever longer.
      const double most_s = work > kIdleWork ? usual_s : work > 1 ? kLongerIdle * usual_s : kInfinity;
      if (short_windows_left == 0) window_s = std::min(2.0 * window_s, most_s);
    }
    assert(best_s_ >= 0.0 && best_s_ <= step_s_);
    impact_.state = hit_ ? MeshImpactState::kHit : MeshImpactState::kSeparated;
    impact_.time_s = best_s_;
    return impact_;
  }

 private:
  // The time for which bounds that are taken at an instant are tight enough [s].
  [[nodiscard]] double usual_window() const {
    const double turning = rate_a_ + rate_b_;
    const double by_turning = turning > 0.0 ? kWindow_rad / turning : kInfinity;
    const double speed = length(motion_a_.velocity - motion_b_.velocity) + acceleration_m_s2_ * step_s_;
    const double way = kWindowOfExtent * std::max(a_.extent_m(), b_.extent_m());
    return std::min(by_turning, speed > 0.0 ? way / speed : kInfinity);
  }

  // Returns the pairs of nodes and leaves visited: more than `max_work` where the window was given up.
  std::uint32_t search_window(double from_s, double until_s, std::uint32_t max_work) {
    const KinematicState at_a = advance(motion_a_, from_s), at_b = advance(motion_b_, from_s);
    const MotionState now(at_a, at_b);
    // Pairs nearer than the tolerance are visited: they would come nearer before they are a hit otherwise.
    const WideMotion wide(a_, b_, now.a_from_b, options_.tolerance_m);
    too_far_apart_ = !wide.in_range;
    if (too_far_apart_) return 0;
    const WideSpeeds speeds = speeds_at(at_a, at_b, until_s - from_s);
    stack_.assign(1, {WideTree::kRoot, WideTree::kRoot});
    pairs_.clear();
    Masks masks;
    MeetTimes times;
    WideTree::Node around;  // what is visited beside a leaf is a node, so the leaf's boxes are made one
    // The pairs of triangles that wait count as well.
    const auto work_done = [&, before = impact_.iterations] {
      return impact_.iterations - before + static_cast<std::uint32_t>(pairs_.size());
    };
    while (!stack_.empty()) {
      if (work_done() > max_work || !spend_iteration()) break;
      const auto [slot_a, slot_b] = stack_.back();
      stack_.pop_back();
      const auto within_s = static_cast<float>((std::min(best_s_, until_s) - from_s) * (1.0 + 0x1p-20));
      const Ref of_a = a_.at(slot_a), of_b = b_.at(slot_b);
      const bool node_a = of_a.kind() == Ref::kNode, node_b = of_b.kind() == Ref::kNode;
      if (node_a || node_b) {
        if (!node_a) around = a_.lone(slot_a);
        if (!node_b) around = b_.lone(slot_b);
        nodes_may_meet(node_a ? a_.node(of_a.index()) : around, node_b ? b_.node(of_b.index()) : around, wide, speeds,
                       within_s, masks);
        for (std::size_t row = WideTree::kWidth; row-- > 0;) {
          for_each_bit(masks[row], [&](std::size_t i) {
            stack_.emplace_back(node_a ? WideTree::child_slot(of_a, i) : slot_a,
                                node_b ? WideTree::child_slot(of_b, row) : slot_b);
          });
        }
        continue;
      }
      const WideTree::Leaf &leaf_a = a_.leaf(of_a.index()), &leaf_b = b_.leaf(of_b.index());
      leaves_may_meet(leaf_a, leaf_b, wide, speeds, within_s, masks, times);
      for (std::size_t row = 0; row < leaf_b.count; ++row) {
        for_each_bit(masks[row], [&](std::size_t i) {
          pairs_.push_back({times[row][i], a_.face(leaf_a, i), b_.face(leaf_b, row)});
        });
      }
    }
    const std::uint32_t sum = work_done();
    if (sum <= max_work) follow_pairs(now, from_s, until_s);
    return sum;
  }

  [[nodiscard]] WideSpeeds speeds_at(const KinematicState& a, const KinematicState& b, double window_s) const {
    WideSpeeds speeds{};
    const auto fill = [](const KinematicState& at, const Vec3& origin, auto& base, auto& turn) {
      const Vec3& w = at.angular_velocity_body;
      const Vec3 v = rotate_back(at.orientation.toRotationMatrix(), at.velocity) + w.cross(origin);
      for (int k = 0; k < 3; ++k) {
        base[static_cast<std::size_t>(k)] = static_cast<float>(v[k]);
        turn[static_cast<std::size_t>(k)] = static_cast<float>(w[k]);
      }
    };
    fill(a, a_.origin(), speeds.linear_velocity_a, speeds.angular_velocity_a);
    fill(b, b_.origin(), speeds.linear_velocity_b, speeds.angular_velocity_b);
    speeds.rate_a = static_cast<float>(rate_a_ * (1.0 + 0x1p-20));
    speeds.rate_b = static_cast<float>(rate_b_ * (1.0 + 0x1p-20));
    const double rounding = 0x1p-17 * (length(a.velocity) + length(b.velocity) + spin_speed_m_s_);
    const double change =
        std::min(0.5 * centripetal_m_s2_ * window_s, 2.0 * spin_speed_m_s_) + 0.5 * acceleration_m_s2_ * window_s;
    speeds.slack_m_s = static_cast<float>((change + rounding) * (1.0 + 0x1p-20));
    return speeds;
  }

  // Pairs that may meet first come first: a hit ends the search for the others.
  void follow_pairs(const MotionState& at_begin, double from_s, double until_s) {
    std::ranges::sort(pairs_, {}, [](const TrianglePair& pair) { return std::tuple(pair.free_s, pair.b, pair.a); });
    for (const TrianglePair& pair : pairs_) advance_pair(pair, at_begin, from_s, until_s);
    pairs_.clear();
  }

  // Follows two triangles until they can't meet before a window's end, or the best hit.
  void advance_pair(const TrianglePair& pair, const MotionState& at_begin, double from_s, double until_s) {
    const Triangle triangle_a = a_.soup().triangle(pair.a), in_b = b_.soup().triangle(pair.b);
    double t = from_s + static_cast<double>(pair.free_s);
    std::optional<MotionState> later;
    while (t <= std::min(best_s_, until_s) && spend_iteration()) {
      if (t > from_s) later.emplace(advance(motion_a_, t), advance(motion_b_, t));
      const MotionState& now = later ? *later : at_begin;
      const Triangle triangle_b = {now.a_from_b(in_b[0]), now.a_from_b(in_b[1]), now.a_from_b(in_b[2])};
      const double step = safe_step(pair.a, pair.b, now, t, triangle_a, triangle_b);
      assert(!(step < 0.0));
      if (step == 0.0) return;
      t += step;
    }
  }

  // A time for which two triangles certainly don't touch [s]; 0 where none is known, and they are the best hit now.
  double safe_step(std::uint32_t face_a, std::uint32_t face_b, const MotionState& now, double t, const Triangle& a,
                   const Triangle& b) {
    TriangleDistance found = triangle_distance(a, b, kRelativeAccuracy);
    // In a world with large coordinates, places are known less well than the tolerance.
    const double rounding = rounding_at(now);
    const double band = options_.tolerance_m + rounding;
    if (found.lower <= band && found.upper - found.lower > 0x1p-20 * found.upper) found = triangle_distance(a, b);
    const double apart = length(found.on_b - found.on_a);
    const Vec3 between = apart > 0.0 ? Vec3((found.on_b - found.on_a) / apart) : center_direction(now);
    if (found.distance > band) {
      const double least = 0.5 * options_.tolerance_m + rounding;
      const AxisProjections along(now, between, a, b);
      double step = along.time_above(least, closing_acceleration_bound(now, between));
      if (along.gap() < 0.5 * found.distance) {  // large triangles, tilted by rounding
        for_each_direction(a, b, between, 0.0, [&](const Vec3& direction, double) {
          const Vec3 n = dot(direction, between) < 0.0 ? Vec3(-direction) : direction;
          step = std::max(step, AxisProjections(now, n, a, b).time_above(least, closing_acceleration_bound(now, n)));
          return true;
        });
      }
      if (step > 0.0) return step;
    }
    if (options_.only_distance) return hit(face_a, face_b, now, t, found, between, false);
    // The triangles are near, or touch. No contact follows as long as there is a direction along which they are apart,
    // but for rounding, and don't approach.
    double free_s = 0.0;
    std::optional<Vec3> closing;
    bool rests = false;
    const double noise = found.distance > 0.0 ? rounding / found.distance : 1.0;
    for_each_direction(a, b, between, noise, [&](const Vec3& direction, double noise_of_direction) {
      const Vec3 n = facing(direction, now, a, b, rounding, noise < kClearSide ? std::optional(between) : std::nullopt);
      const AxisProjections along(now, n, a, b);
      const double gap = along.gap();
      if (gap < -2.0 * rounding) return true;
      const NearPairState touch = classify_contact(along, now, n, 2.0 * band, noise_of_direction);
      if (touch == NearPairState::kFree) {
        free_s = along.time_above(least_gap(along, gap, band, rounding), closing_acceleration_bound(now, n));
        return false;
      }
      if (!closing) {
        closing = n;
        rests = touch == NearPairState::kRests;
      }
      return true;
    });
    if (free_s > 0.0) return free_s;
    return hit(face_a, face_b, now, t, found, closing.value_or(between), rests);
  }

  // The gap to which a pair that doesn't approach may come until it is looked at again [m].
  [[nodiscard]] double least_gap(const AxisProjections& along, double gap, double band, double rounding) const {
    if (gap <= rounding) return gap - rounding;
    // One that parts may come back to half the tolerance, or to its present gap less 1/1024: if it could halve the gap
    // with each bounce, there would soon be no gap left to find.
    const bool parts = along.closing_speed(2.0 * band) < 0.0;
    return parts ? std::min(0.5 * options_.tolerance_m, (1.0 - 0x1p-10) * gap)
                 : 0.5 * std::min(gap, options_.tolerance_m);
  }

  [[nodiscard]] double rounding_at(const MotionState& now) const {
    return 0x1p-46 * (magnitude(now.a_from_b.translation) + coordinate_bound_m_);
  }

  // The sense of a direction that leads from A's triangle to B's, which are near: that in which they are farther apart;
  // where both lie across it, that of `between`, or of the way from the middle of A to the middle of B.
  [[nodiscard]] Vec3 facing(const Vec3& n, const MotionState& now, const Triangle& a, const Triangle& b,
                            double rounding, const std::optional<Vec3>& between) const {
    const double ahead = AxisProjections(now, n, a, b).gap(), behind = AxisProjections(now, -n, a, b).gap();
    if (std::min(ahead, behind) < -2.0 * rounding) return ahead < behind ? Vec3(-n) : n;
    if (between) return dot(n, *between) < 0.0 ? Vec3(-n) : n;
    const Vec3 middle_a = 0.5 * (a_.soup().box.lo + a_.soup().box.hi);
    const Vec3 middle_b = now.a_from_b(Vec3(0.5 * (b_.soup().box.lo + b_.soup().box.hi)));
    return dot(n, middle_b - middle_a) < 0.0 ? Vec3(-n) : n;
  }

  // A direction for triangles that are in each other, which takes coordinates whose rounding is as large as the
  // tolerance.
  [[nodiscard]] static Vec3 center_direction(const MotionState& now) {
    const double distance = length(now.a_from_b.translation);
    return distance > 0.0 ? Vec3(now.a_from_b.translation / distance) : Vec3::UnitX();
  }

  enum class NearPairState : std::uint8_t { kCloses, kRests, kFree };
  [[nodiscard]] NearPairState classify_contact(const AxisProjections& along, const MotionState& now, const Vec3& n,
                                               double reach, double noise) const {
    const double unknown = 0x1p-40 + noise;
    const double still = unknown * (length(now.velocity_a) + length(now.velocity_b) + spin_speed_m_s_);
    const double closing = along.closing_speed(reach), pressing = dot(n, now.pressing);
    if (closing > still) return NearPairState::kCloses;
    // A pair that doesn't rise by the tolerance before it comes back rests.
    if (closing < -still && closing * closing > 2.0 * pressing * options_.tolerance_m) return NearPairState::kFree;
    // For rotating bodies only a bound of the further motion is known, so they count as pressed.
    return pressing > unknown * acceleration_m_s2_ || spin_speed_m_s_ > 0.0 ? NearPairState::kRests
                                                                            : NearPairState::kFree;
  }

  double hit(std::uint32_t face_a, std::uint32_t face_b, const MotionState& now, double t,
             const TriangleDistance& found, const Vec3& direction, bool rests) {
    if (hit_ && t >= best_s_) return 0.0;
    assert(face_a < a_.soup().faces.size() && face_b < b_.soup().faces.size());
    assert(t >= 0.0 && !(std::abs(dot(direction, direction) - 1.0) > 1e-9));
    hit_ = true;
    best_s_ = t;
    impact_.pair = {a_.soup().faces[face_a].polygon, b_.soup().faces[face_b].polygon};
    impact_.distance_m = found.distance;
    impact_.direction = rotate(now.world_from_a, direction);
    impact_.resting = rests && t == 0.0;
    return 0.0;
  }

  // A bound of the acceleration with which points come nearer to each other along a direction [m/s^2].
  [[nodiscard]] double closing_acceleration_bound(const MotionState& now, const Vec3& direction) const {
    return centripetal_m_s2_ + std::max(0.0, dot(direction, now.pressing) + 0x1p-40 * acceleration_m_s2_);
  }

  bool spend_iteration() {
    exhausted_ = exhausted_ || impact_.iterations >= options_.max_iterations;
    impact_.iterations += !exhausted_;
    return !exhausted_;
  }

  std::vector<std::pair<WideTree::ChildSlot, WideTree::ChildSlot>>& stack_;
  std::vector<TrianglePair>& pairs_;
  WideTree &a_, &b_;
  const KinematicState &motion_a_, &motion_b_;
  const MeshImpactOptions& options_;
  double step_s_, best_s_;
  double rate_a_ = 0.0, rate_b_ = 0.0;  // [rad/s]
  double spin_speed_m_s_ = 0.0;         // no two points move faster by turning, together
  double centripetal_m_s2_ = 0.0;       // nor do those velocities change faster
  double acceleration_m_s2_ = 0.0;      // of one origin against the other
  double coordinate_bound_m_ = 0.0;     // the sum of the largest coordinates at the start
  bool hit_ = false, exhausted_ = false;
  bool too_far_apart_ = false;  // for binary32
  MeshImpact impact_;
};

MeshImpact MeshImpactQuery::first_impact(WideTree& a, const KinematicState& motion_a, WideTree& b,
                                         const KinematicState& motion_b, double step_s,
                                         const MeshImpactOptions& options) {
  assert(step_s >= 0.0 && std::isfinite(step_s));
  MeshImpact impact;
  const RelativeMotion a_from_b(motion_a.pose(), motion_b.pose());
  const bool shares_points = overlap_.find_pair(a, b, a_from_b, impact.pair);
  if (a.scale() != 1.0 || b.scale() != 1.0) {
    impact.state = shares_points ? MeshImpactState::kOverlapped : MeshImpactState::kTooLarge;
    return impact;
  }
  Search search(*this, a, motion_a, b, motion_b, step_s, options);
  if (shares_points) {
    const MotionState start(motion_a, motion_b);
    for (const FacePair& faces : overlap_.faces_within(a, b, a_from_b, 0.0)) {
      if (!search.penetrate(faces, start)) continue;
      impact.state = MeshImpactState::kOverlapped;
      impact.pair = {a.soup().faces[faces.a].polygon, b.soup().faces[faces.b].polygon};
      return impact;
    }
  }
  return search.run();
}

}  // namespace peerd::collision
