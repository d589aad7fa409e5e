#include "peerd/peer/motion/flock.hpp"

#include <algorithm>
#include <cmath>

#include "peerd/peer/motion/random.hpp"

namespace peerd::motion {
namespace {

constexpr double kBirdStep_s = 1.0 / 30.0;
constexpr double kLag_s = 0.2;           // time constant of the acceleration
constexpr double kBirdSpeedLag_s = 1.0;  // time constant of the speed
// The weights of a bird's wishes, in parts of the greatest acceleration.
constexpr double kSeparate = 1.5, kAlign = 0.6, kCohere = 0.4, kSeek = 0.4;

struct Bird {
  Vec3 position, velocity, acceleration = Vec3::Zero();
};

Vec3 at_most(const Vec3& v, double length) {
  const double n = v.norm();
  return n > length ? Vec3(v * (length / n)) : v;
}

Vec3 wanted_acceleration(const FlockSettings& s, const std::vector<Bird>& birds, std::size_t self, const Vec3& goal) {
  const Bird& bird = birds[self];
  Vec3 away = Vec3::Zero(), velocities = Vec3::Zero(), places = Vec3::Zero();
  double neighbours = 0.0;
  for (std::size_t i = 0; i < birds.size(); ++i) {
    const Vec3 apart = bird.position - birds[i].position;
    const double distance2 = apart.squaredNorm();
    if (i == self || distance2 > s.neighbour_m * s.neighbour_m || distance2 == 0.0) continue;
    const double distance = std::sqrt(distance2);
    if (distance < s.separation_m) away += apart / distance * (1.0 - distance / s.separation_m);
    velocities += birds[i].velocity;
    places += birds[i].position;
    neighbours += 1.0;
  }
  Vec3 wish = kSeparate * away + kSeek * at_most(goal - bird.position, 1.0);
  if (neighbours > 0.0) {
    wish += kAlign * (velocities / neighbours - bird.velocity) / s.speed_m_s * 4.0;
    wish += kCohere * at_most((places / neighbours - bird.position) / s.neighbour_m, 1.0);
  }
  const double speed = bird.velocity.norm();
  if (speed > 0.0) wish += bird.velocity / speed * (s.speed_m_s - speed) / (kBirdSpeedLag_s * s.acceleration_m_s2);
  return at_most(s.acceleration_m_s2 * wish, s.acceleration_m_s2);
}

Knot knot(double t_s, const Bird& bird, const KinematicState& before) {
  Knot k;
  k.t_s = t_s;
  k.state.position = bird.position;
  k.state.velocity = bird.velocity;
  k.state.acceleration = bird.acceleration;
  face_forward(k.state, false, before);
  return k;
}

}  // namespace

std::vector<std::vector<Knot>> flock(const FlockSettings& settings, std::uint64_t seed, std::span<const Vec3> starts,
                                     PathTimes times) {
  Random random(seed, 0);
  const auto new_goal = [&] {
    Vec3 goal;
    for (int i = 0; i < 3; ++i) goal[i] = random.uniform(settings.low[i], settings.high[i]);
    return goal;
  };
  Vec3 goal = new_goal();
  std::vector<Bird> birds;
  for (const Vec3& start : starts) {
    const Vec3 towards = (goal - start).normalized();
    const Vec3 about(random.uniform(-0.3, 0.3), random.uniform(-0.1, 0.1), random.uniform(-0.3, 0.3));
    birds.push_back({start, settings.speed_m_s * (towards + about)});
  }
  std::vector<std::vector<Knot>> paths(birds.size());
  double goal_until_s = times.begin_s + settings.goal_every_s;
  for (std::size_t step = 0;; ++step) {
    const double t = times.begin_s + static_cast<double>(step) * kBirdStep_s;
    for (std::size_t i = 0; i < birds.size(); ++i) {
      paths[i].push_back(knot(t, birds[i], paths[i].empty() ? KinematicState{} : paths[i].back().state));
    }
    if (t >= times.end_s) return paths;
    if (t >= goal_until_s) {
      goal = new_goal();
      goal_until_s += settings.goal_every_s;
    }
    std::vector<Bird> next = birds;
    for (std::size_t i = 0; i < birds.size(); ++i) {
      const Vec3 a = birds[i].acceleration;
      // The acceleration is linear over the step, and velocity and position are its integrals.
      const Vec3 a1 = a + (wanted_acceleration(settings, birds, i, goal) - a) * (kBirdStep_s / kLag_s);
      next[i].acceleration = a1;
      next[i].velocity += 0.5 * kBirdStep_s * (a + a1);
      next[i].position += kBirdStep_s * birds[i].velocity + kBirdStep_s * kBirdStep_s / 6.0 * (2.0 * a + a1);
    }
    birds = std::move(next);
  }
}

}  // namespace peerd::motion
