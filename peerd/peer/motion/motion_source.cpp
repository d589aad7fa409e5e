#include "peerd/peer/motion/motion_source.hpp"

#include <algorithm>
#include <cassert>
#include <map>

namespace peerd::motion {
namespace {

// Peers learn of a motion some seconds before its start, and the object is under way then too. Before that it stands
// still.
constexpr double kUnderWay_s = 5.0;
constexpr double kAfterEnd_s = 2.0;
constexpr double kGeneratedMax_s = 3600.0;  // 20 to 30 knots a second are made before the run

using Knots = std::vector<Knot>;

// Makes the knots of the objects with these numbers. Only a flock needs the places of all objects.
struct KnotMaker {
  std::span<const Pose> places;
  std::span<const std::size_t> numbers;
  std::uint64_t seed;
  PathTimes times;

  template <class Make>
  std::vector<Knots> each(const Make& make) const {
    std::vector<Knots> all;
    for (const std::size_t number : numbers) all.push_back(make(number));
    return all;
  }
  std::vector<Knots> operator()(const WalkSettings& s) const {
    return each([&](std::size_t n) { return walk(s, seed, n, places[n].position, times); });
  }
  std::vector<Knots> operator()(const DriveSettings& s) const {
    return each([&](std::size_t n) { return drive(s, seed, n, places[n].position, times); });
  }
  std::vector<Knots> operator()(const FlockSettings& s) const {
    std::vector<Vec3> starts;
    for (const Pose& place : places) starts.push_back(place.position);
    std::vector<Knots> all = flock(s, seed, starts, times);
    return each([&](std::size_t n) { return std::move(all[n]); });
  }
};

void keep_orientation(Knots& knots, const Quat& orientation) {
  for (Knot& knot : knots) {
    knot.state.orientation = orientation;
    knot.state.angular_velocity_body.setZero();
  }
}

struct Maker {
  const MotionSettings& motion;
  const std::string& what;
  KnotMaker knots;
  double duration_s;
  std::vector<MotionSource> sources = {};
  std::optional<InputError> error = {};

  void fail(const std::string& sentence) { error = InputError{what + ": " + sentence}; }
  void add(Knots path, bool loops = false) {
    sources.emplace_back(MotionPath(std::move(path), loops), motion.hold_before_start);
  }
  void operator()(const MotionFormula& formula) {
    for (const std::size_t number : knots.numbers) {
      auto made = FormulaMotion::make(formula, what, duration_s, number);
      if (!made) {
        error = made.error();
        return;
      }
      sources.emplace_back(std::move(*made));
    }
  }
  // All objects have the same path.
  void add_same(const Knots& path, bool loops, bool turns) {
    const Knots facing = motion.face_forward ? facing_forward(path) : path;
    for (const std::size_t number : knots.numbers) {
      Knots own = facing;
      if (!motion.face_forward && !turns) keep_orientation(own, knots.places[number].orientation);
      add(std::move(own), loops);
    }
  }
  void operator()(const Waypoints& waypoints) { add_same(waypoint_knots(waypoints), waypoints.loop, false); }
  void operator()(const Track& track) {
    const auto loaded = load_track(track);
    if (!loaded) {
      error = loaded.error();
      return;
    }
    add_same(loaded->knots, track.loop, loaded->turns);
  }
  void operator()(const ExternalProgram&) { assert(false && "a program drives it"); }
  void operator()(const replication::Launch&) { assert(false && "nothing drives it"); }
  void operator()(const auto& random) {  // a walker, a car or a flock
    if (duration_s > kGeneratedMax_s) return fail("such a motion is made before the run, so for 3600 s at most");
    if (const auto wrong = misplaced(random)) return fail(*wrong);
    std::vector<Knots> all = knots(random);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (!motion.face_forward) keep_orientation(all[i], knots.places[knots.numbers[i]].orientation);
      add(std::move(all[i]));
    }
  }
  [[nodiscard]] std::optional<std::string> misplaced(const WalkSettings& s) const {
    for (const std::size_t number : knots.numbers) {
      const Vec3& p = knots.places[number].position;
      const double inside = std::min({p.x() - s.x_min_m, s.x_max_m - p.x(), p.z() - s.z_min_m, s.z_max_m - p.z()});
      if (inside >= kWalkMargin_m) continue;
      return "object number " + std::to_string(number) + " must stand at least 1 m inside of within_m in the world";
    }
    return std::nullopt;
  }
  [[nodiscard]] std::optional<std::string> misplaced(const auto&) const { return std::nullopt; }
};

}  // namespace

Pose MotionSource::pose(double t_s) const {
  if (hold_) t_s = std::max(0.0, t_s);
  return std::visit([&](const auto& motion) { return motion.pose(t_s); }, motion_);
}

KinematicState MotionSource::sample(double t_s) const {
  if (hold_ && t_s < 0.0) return at_rest(pose(0.0));
  return std::visit([&](const auto& motion) { return motion.sample(t_s); }, motion_);
}

Result<std::vector<MotionSource>> make_sources(const MotionSettings& motion, const std::string& what,
                                               std::span<const Pose> places, std::span<const std::size_t> numbers,
                                               std::uint64_t scenario_seed, double duration_s) {
  const double begin_s = motion.hold_before_start ? 0.0 : -kUnderWay_s;
  Maker maker{motion,
              what,
              {places, numbers, motion.seed.value_or(scenario_seed), {begin_s, duration_s + kAfterEnd_s}},
              duration_s};
  std::visit(maker, motion.kind);
  if (maker.error) return std::unexpected(*maker.error);
  return std::move(maker.sources);
}

}  // namespace peerd::motion
