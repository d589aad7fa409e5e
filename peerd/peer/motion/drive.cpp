#include "peerd/peer/motion/drive.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "peerd/peer/motion/street_route.hpp"

namespace peerd::motion {
namespace {

constexpr double kCarStep_s = 0.05;
constexpr double kCurvatureMax = 1.0 / 5.0;  // [1/m]: a car's turning circle
constexpr double kSteering = 0.2;            // [1/(m s)]: 30 degrees a second at the wheels, 2.7 m apart
constexpr double kJerk_m_s3 = 4.0;
constexpr double kCarSpeedLag_s = 0.5;

class Car {
 public:
  Car(const DriveSettings& settings, std::uint64_t seed, std::size_t n, const Vec3& start)
      : s_(settings), random_(seed, n), route_(s_, {start.x(), start.z()}, random_), height_m_(start.y()) {
    usual_speed_ = s_.speed_m_s * random_.uniform(0.85, 1.15);
    const StreetRoute::Place begin = route_.at(0.0);
    position_ = begin.position;
    heading_ = std::atan2(begin.direction.y(), begin.direction.x());
    speed_ = safe_speed();
  }

  [[nodiscard]] Knot knot(double t_s) const {
    Knot k;
    k.t_s = t_s;
    const Vec2 v = velocity(), a = acceleration();
    k.state.position = Vec3(position_.x(), height_m_, position_.y());
    k.state.velocity = Vec3(v.x(), 0.0, v.y());
    k.state.acceleration = Vec3(a.x(), 0.0, a.y());
    face(k.state, -heading_ - 0.5 * std::numbers::pi, 0.0, -speed_ * curvature_, 0.0);
    return k;
  }

  // One step of the simulation. The position is the integral of the velocity's cubic over the step.
  void step() {
    const Vec2 v = velocity(), a = acceleration();
    const double turn_rate = speed_ * curvature_;
    const double most = s_.acceleration_m_s2;
    const double pull = std::clamp((safe_speed() - speed_) / kCarSpeedLag_s, -most, most);
    const double pull_before = pull_;
    pull_ += std::clamp(pull - pull_, -kJerk_m_s3 * kCarStep_s, kJerk_m_s3 * kCarStep_s);
    speed_ = std::max(0.0, speed_ + 0.5 * kCarStep_s * (pull_before + pull_));
    curvature_ += std::clamp(curvature_wanted() - curvature_, -kSteering * kCarStep_s, kSteering * kCarStep_s);
    const double curvature_max = most / std::max(speed_ * speed_, 1e-3);  // the tyres' grip
    curvature_ = std::clamp(curvature_, -curvature_max, curvature_max);
    heading_ += 0.5 * kCarStep_s * (turn_rate + speed_ * curvature_);
    const Vec2 v1 = velocity(), a1 = acceleration();
    position_ += 0.5 * kCarStep_s * (v + v1) + kCarStep_s * kCarStep_s / 12.0 * (a - a1);
    // The route is followed up to the place that the car is abreast of.
    const StreetRoute::Place abreast = route_.at(come_m_);
    come_m_ += std::max(0.0, (position_ - abreast.position).dot(abreast.direction));
  }

 private:
  [[nodiscard]] Vec2 ahead() const { return {std::cos(heading_), std::sin(heading_)}; }
  [[nodiscard]] Vec2 right() const { return {-std::sin(heading_), std::cos(heading_)}; }
  [[nodiscard]] Vec2 velocity() const { return speed_ * ahead(); }
  [[nodiscard]] Vec2 acceleration() const { return pull_ * ahead() + speed_ * speed_ * curvature_ * right(); }
  // Braking sets in late and turns are wider than planned, so both keep a reserve.
  [[nodiscard]] double safe_speed() {
    return route_.safe_speed(come_m_, 0.7 * s_.acceleration_m_s2, 0.7 * s_.acceleration_m_s2, usual_speed_);
  }
  // The curvature of the circle that leads from the car, tangentially, to the route some way ahead.
  [[nodiscard]] double curvature_wanted() {
    const Vec2 to = route_.at(come_m_ + 3.0 + 0.5 * speed_).position - position_;
    return std::clamp(2.0 * to.dot(right()) / to.squaredNorm(), -kCurvatureMax, kCurvatureMax);
  }

  const DriveSettings& s_;
  Random random_;
  StreetRoute route_;
  double height_m_;
  Vec2 position_;
  double heading_ = 0.0;  // angle from +x towards +z
  double speed_ = 0.0, pull_ = 0.0, curvature_ = 0.0, usual_speed_ = 0.0, come_m_ = 0.0;
};

}  // namespace

std::vector<Knot> drive(const DriveSettings& settings, std::uint64_t seed, std::size_t n, const Vec3& start,
                        PathTimes times) {
  Car car(settings, seed, n, start);
  std::vector<Knot> knots;
  for (std::size_t i = 0; knots.empty() || knots.back().t_s < times.end_s; ++i) {
    if (i > 0) car.step();
    knots.push_back(car.knot(times.begin_s + static_cast<double>(i) * kCarStep_s));
  }
  return knots;
}

}  // namespace peerd::motion
