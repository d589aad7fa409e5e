#include "wire_objects.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <string>

#include "core/scene/reader.hpp"

namespace peerd::bench {

double thread_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double draw(std::mt19937_64& rng, double from, double to) {
  return from + (to - from) * std::ldexp(static_cast<double>(rng() >> 11), -53);
}

bool same_bits(const KinematicState& a, const KinematicState& b) {
  return a.position == b.position && a.velocity == b.velocity && a.acceleration == b.acceleration &&
         a.orientation.coeffs() == b.orientation.coeffs() && a.angular_velocity_body == b.angular_velocity_body;
}

bool matches_update(const KinematicState& ghost, const replication::UpdateRecord& update, SimTime t) {
  using replication::MotionKind;
  const replication::MotionModel& m = update.model;
  const KinematicState says = evaluate(m, to_seconds(t - update.at));
  const bool cut = m.kind == MotionKind::kThird || m.kind == MotionKind::kTurning ||
                   m.kind == MotionKind::kOscillating || !m.angular_acceleration_body.isZero(0.0);
  const bool there =
      cut ? (ghost.position - says.position).norm() <= replication::kPieceError_m : ghost.position == says.position;
  return there && angle_between(ghost.orientation, says.orientation) <= replication::kPieceError_rad;
}

Crowd::Crowd(std::size_t objects) {
  std::string text = "#VRML V2.0 utf8\n";
  for (std::size_t i = 0; i < objects; ++i) text += "DEF O" + std::to_string(i) + " Transform { }\n";
  ReadResult read = read_world(text);
  scene = std::move(read.scene.value());
  model = replication::make_world_model(scene);
  first = scene.find("O0").value();
}

replication::PeerConfig config_of(std::uint32_t id, ObjectId first, std::size_t count,
                                  const replication::PublishPolicy& policy) {
  replication::PeerConfig config;
  config.id = PeerId{id};
  config.name = "peer" + std::to_string(id);
  config.world_hash = 1;
  config.policy = policy;
  for (std::uint32_t i = 0; i < count; ++i) config.owned.push_back({ObjectId{first.number + i}, true, {}});
  return config;
}

Path::Path(std::mt19937_64& rng) {
  for (auto& axis : waves_) {
    for (Wave& w : axis) {
      w.rate = 2.0 * 3.141592653589793 / draw(rng, 5.0, 60.0);
      w.size_m = draw(rng, 0.2, 3.0) / w.rate;
      w.phase = draw(rng, 0.0, 6.28);
    }
  }
  middle_ = {draw(rng, -500, 500), 0.0, draw(rng, -500, 500)};
}

KinematicState Path::at(SimTime time) const {
  const double t = to_seconds(time.time_since_epoch());
  KinematicState s;
  s.position = middle_;
  for (int i = 0; i < 2; ++i) {
    for (const Wave& w : waves_[static_cast<std::size_t>(i)]) {
      const double sin = std::sin(w.rate * t + w.phase), cos = std::cos(w.rate * t + w.phase);
      s.position[2 * i] += w.size_m * sin;
      s.velocity[2 * i] += w.size_m * w.rate * cos;
      s.acceleration[2 * i] -= w.size_m * w.rate * w.rate * sin;
    }
  }
  const double speed2 = s.velocity.squaredNorm();
  s.orientation = quat_exp({0.0, std::atan2(s.velocity.x(), s.velocity.z()), 0.0});
  // At a standstill it turns on the spot, as fast as it can.
  const double turns = s.velocity.z() * s.acceleration.x() - s.velocity.x() * s.acceleration.z();
  s.angular_velocity_body.y() = std::clamp(turns / std::max(speed2, 1e-6), -3.0, 3.0);
  return s;
}

}  // namespace peerd::bench
