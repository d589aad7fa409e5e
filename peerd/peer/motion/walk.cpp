#include "peerd/peer/motion/walk.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "peerd/peer/motion/random.hpp"

namespace peerd::motion {
namespace {

constexpr double kWalkerStep_s = 0.05;
constexpr double kBorder_m = 3.0;          // a walker turns back where a border is nearer than this
constexpr double kTurnMax_rad_s = 1.5;     // a turn within 1 m at 1.5 m/s
constexpr double kTurnLag_s = 0.25;        // time constant of the turn rate
constexpr double kWalkerSpeedLag_s = 0.5;  // time constant of the speed
constexpr double kAcceleration_m_s2 = 1.5;
constexpr double kSpeedMemory_s = 5.0;

class Walker {
 public:
  Walker(const WalkSettings& settings, std::uint64_t seed, std::size_t n, const Vec3& start)
      : s_(settings), random_(seed, n), position_(start) {
    usual_speed_ = std::max(0.3 * s_.speed_m_s, s_.speed_m_s + s_.speed_sd_m_s * random_.normal());
    heading_ = random_.uniform(-std::numbers::pi, std::numbers::pi);
    speed_ = std::min(usual_speed_, safe_speed());
    goes_for_s_ = time_until_stop();
  }

  [[nodiscard]] Knot knot(double t_s) const {
    Knot k;
    k.t_s = t_s;
    k.state.position = position_;
    k.state.velocity = speed_ * ahead();
    k.state.acceleration = speed_rate_ * ahead() + speed_ * turn_rate_ * left();
    face(k.state, heading_, 0.0, turn_rate_, 0.0);
    return k;
  }

  // One step of the simulation. The speed and the turn rate are continuous, and the position is the integral of the
  // velocity's cubic over the step.
  void step() {
    const Vec3 v = speed_ * ahead(), a = speed_rate_ * ahead() + speed_ * turn_rate_ * left();
    fancy_turn_ = wander(fancy_turn_, s_.turn_rad_s, s_.turn_memory_s, kWalkerStep_s, random_);
    fancy_speed_ = wander(fancy_speed_, 0.5 * s_.speed_sd_m_s, kSpeedMemory_s, kWalkerStep_s, random_);
    const double turn_wanted =
        std::clamp(fancy_turn_ * (1.0 - border()) + turn_back(), -kTurnMax_rad_s, kTurnMax_rad_s);
    const double turn_before = turn_rate_;
    turn_rate_ += (turn_wanted - turn_rate_) * kWalkerStep_s / kTurnLag_s;
    heading_ += 0.5 * (turn_before + turn_rate_) * kWalkerStep_s;
    const double rate_wanted = speed_ > safe_speed() ? -braking() : (speed_wanted() - speed_) / kWalkerSpeedLag_s;
    // The rate is bounded so that the walker never goes backwards.
    speed_rate_ = std::max(std::clamp(rate_wanted, -braking(), kAcceleration_m_s2), -speed_ / kWalkerStep_s);
    speed_ += speed_rate_ * kWalkerStep_s;
    const Vec3 v1 = speed_ * ahead(), a1 = speed_rate_ * ahead() + speed_ * turn_rate_ * left();
    position_ += 0.5 * kWalkerStep_s * (v + v1) + kWalkerStep_s * kWalkerStep_s / 12.0 * (a - a1);
  }

 private:
  [[nodiscard]] Vec3 ahead() const { return {-std::sin(heading_), 0.0, -std::cos(heading_)}; }
  [[nodiscard]] Vec3 left() const { return {-std::cos(heading_), 0.0, std::sin(heading_)}; }
  [[nodiscard]] double time_until_stop() {
    return s_.stop_every_s > 0.0 ? -s_.stop_every_s * std::log1p(-random_.uniform())
                                 : std::numeric_limits<double>::infinity();
  }
  // Points away from the borders that are near, with a length of 1 at a border and 0 at kBorder_m.
  [[nodiscard]] Vec3 inwards() const {
    const auto near = [](double distance_m) { return std::clamp(1.0 - distance_m / kBorder_m, 0.0, 1.0); };
    return {near(position_.x() - s_.x_min_m) - near(s_.x_max_m - position_.x()), 0.0,
            near(position_.z() - s_.z_min_m) - near(s_.z_max_m - position_.z())};
  }
  [[nodiscard]] double border() const { return std::min(1.0, inwards().norm()); }
  [[nodiscard]] double turn_back() const {
    const Vec3 in = inwards();
    if (in.isZero(0.0)) return 0.0;
    const double angle = std::atan2(in.dot(left()), in.dot(ahead()));
    // A direction along the border is good enough.
    return std::abs(angle) < 0.5 * std::numbers::pi - border() ? 0.0 : 4.0 * border() * angle;
  }
  // The distance to the border, the least of straight ahead and somewhat to each side, because the walker may turn.
  [[nodiscard]] double room_m() const {
    const auto along = [](double at, double towards, double low, double high) {
      if (towards == 0.0) return std::numeric_limits<double>::infinity();
      return ((towards > 0.0 ? high : low) - at) / towards;
    };
    double room = std::numeric_limits<double>::infinity();
    for (const double aside : {-0.6, 0.0, 0.6}) {
      const Vec3 towards = std::cos(aside) * ahead() + std::sin(aside) * left();
      room = std::min({room, along(position_.x(), towards.x(), s_.x_min_m, s_.x_max_m),
                       along(position_.z(), towards.z(), s_.z_min_m, s_.z_max_m)});
    }
    return room;
  }
  [[nodiscard]] double braking() const { return 2.0 * kAcceleration_m_s2; }
  [[nodiscard]] double speed_wanted() {
    goes_for_s_ -= kWalkerStep_s;
    if (goes_for_s_ <= 0.0) {
      stands_for_s_ = -s_.stop_s * std::log1p(-random_.uniform());
      goes_for_s_ = stands_for_s_ + time_until_stop();
    }
    stands_for_s_ -= kWalkerStep_s;
    if (stands_for_s_ > 0.0) return 0.0;
    return std::min(std::max(0.0, usual_speed_ + fancy_speed_), safe_speed());
  }
  // The speed at which the walker can stop half a metre short of the border.
  [[nodiscard]] double safe_speed() const {
    return std::sqrt(2.0 * kAcceleration_m_s2 * std::max(0.0, room_m() - 0.5));
  }

  const WalkSettings& s_;
  Random random_;
  Vec3 position_;
  double heading_ = 0.0, turn_rate_ = 0.0, speed_ = 0.0, speed_rate_ = 0.0;
  double usual_speed_ = 0.0, fancy_turn_ = 0.0, fancy_speed_ = 0.0;
  double goes_for_s_ = 0.0, stands_for_s_ = 0.0;
};

}  // namespace

std::vector<Knot> walk(const WalkSettings& settings, std::uint64_t seed, std::size_t n, const Vec3& start,
                       PathTimes times) {
  Walker walker(settings, seed, n, start);
  std::vector<Knot> knots;
  for (std::size_t i = 0; knots.empty() || knots.back().t_s < times.end_s; ++i) {
    if (i > 0) walker.step();
    knots.push_back(walker.knot(times.begin_s + static_cast<double>(i) * kWalkerStep_s));
  }
  return knots;
}

}  // namespace peerd::motion
