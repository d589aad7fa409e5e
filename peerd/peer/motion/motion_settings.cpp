#include "peerd/peer/motion/motion_settings.hpp"

#include <array>

#include "replication/wire/wire_limits.hpp"

namespace peerd::motion {
namespace {

constexpr double kForever_s = 1e6;

WalkSettings read_walk(TomlReader reader, std::optional<std::uint64_t>& seed) {
  WalkSettings s;
  reader.read("seed", seed);
  reader.read("speed_m_s", s.speed_m_s, 0.1, 10.0);
  reader.read("speed_sd_m_s", s.speed_sd_m_s, 0.0, 5.0);
  reader.read("turn_rad_s", s.turn_rad_s, 0.0, 2.0);
  reader.read("turn_memory_s", s.turn_memory_s, 0.1, 60.0);
  reader.read("stop_every_s", s.stop_every_s, 0.0, kForever_s);
  reader.read("stop_s", s.stop_s, 0.0, kForever_s);
  reader.require("within_m");
  std::vector<double> within{0, 0, 1, 1};
  reader.read("within_m", within, 4);
  s.x_min_m = within[0], s.z_min_m = within[1], s.x_max_m = within[2], s.z_max_m = within[3];
  if (!(s.x_max_m - s.x_min_m >= kWalkWidthMin_m && s.z_max_m - s.z_min_m >= kWalkWidthMin_m)) {
    reader.fail(reader.raw().get("within_m"), reader.dotted("within_m") +
                                                  ": write it as [x, z, x, z], the lower corner " +
                                                  "first, at least 10 m apart each way");
  }
  reader.finish();
  return s;
}

DriveSettings read_drive(TomlReader reader, std::optional<std::uint64_t>& seed) {
  DriveSettings s;
  reader.read("seed", seed);
  reader.read("speed_m_s", s.speed_m_s, 1.0, 60.0);
  reader.read("acceleration_m_s2", s.acceleration_m_s2, 0.5, 10.0);
  reader.read("block_m", s.block_m, 40.0, 10'000.0);
  reader.read("blocks", s.blocks, 1, 1000);
  reader.read("lane_m", s.lane_m, 0.0, 5.0);
  std::vector<double> origin{0, 0};
  reader.read("origin_m", origin, 2);
  s.origin_x_m = origin[0], s.origin_z_m = origin[1];
  reader.finish();
  return s;
}

FlockSettings read_flock(TomlReader reader, std::optional<std::uint64_t>& seed) {
  FlockSettings s;
  reader.read("seed", seed);
  reader.read("speed_m_s", s.speed_m_s, 0.1, 100.0);
  reader.read("acceleration_m_s2", s.acceleration_m_s2, 0.1, 100.0);
  reader.read("separation_m", s.separation_m, 0.1, 1000.0);
  reader.read("neighbour_m", s.neighbour_m, 0.1, 1000.0);
  reader.read("goal_every_s", s.goal_every_s, 0.1, kForever_s);
  reader.require("within_m");
  std::vector<double> within{0, 0, 0, 1, 1, 1};
  reader.read("within_m", within, 6);
  s.low = Vec3(within[0], within[1], within[2]);
  s.high = Vec3(within[3], within[4], within[5]);
  if (!(s.low.array() < s.high.array()).all()) {
    reader.fail(reader.raw().get("within_m"),
                reader.dotted("within_m") + ": write it as [x, y, z, x, y, z], the lower corner first");
  }
  reader.finish();
  return s;
}

Waypoints read_waypoints(TomlReader& reader) {
  Waypoints w;
  w.rows = reader.rows("waypoints", 4);
  reader.read("loop", w.loop);
  reader.read("corners", w.corners);
  const auto wrong = check(w);
  if (!wrong) return w;
  const toml::array* rows = reader.raw().get("waypoints")->as_array();
  reader.fail(rows->get(wrong->row), reader.dotted("waypoints") + ": " + wrong->sentence);
  return w;
}

// Reads how the object begins to move by physics.
replication::Launch read_physics(TomlReader reader) {
  replication::Launch launch;
  std::vector<double> velocity(3), acceleration(3), angular_velocity(3);
  double at_s = 0.0;
  reader.read("velocity", velocity, 3);
  reader.read("acceleration", acceleration, 3);
  reader.read("angular_velocity", angular_velocity, 3);
  reader.read("at_s", at_s, 0.0, kForever_s);
  if (reader.has("velocity")) launch.velocity = Vec3(velocity[0], velocity[1], velocity[2]);
  if (reader.has("acceleration")) launch.acceleration = Vec3(acceleration[0], acceleration[1], acceleration[2]);
  launch.angular_velocity = Vec3(angular_velocity[0], angular_velocity[1], angular_velocity[2]);
  if (launch.angular_velocity.norm() > replication::kSpinMax) {
    reader.fail(reader.raw().get("angular_velocity"),
                reader.dotted("angular_velocity") + ": a body turns by at most 1e4 rad/s");
  }
  launch.after = from_seconds(at_s);
  reader.finish();
  return launch;
}

}  // namespace

MotionSettings read_motion(TomlReader reader, const std::filesystem::path& folder) {
  MotionSettings m;
  m.at = reader.place(nullptr);
  bool outside = false;
  reader.read("outside", outside);
  if (outside) {
    m.kind = ExternalProgram{};
    for (const auto& [key, value] : reader.raw()) {
      if (key.str() == "outside") continue;
      reader.fail(&value, reader.dotted(key.str()) + ": outside = true leaves all to a program; it has no other key");
    }
    return m;
  }
  if (const toml::table* physics = reader.table("physics")) {
    m.kind = read_physics(TomlReader(*physics, reader.dotted("physics"), reader.error()));
    reader.finish();  // it has no other key
    return m;
  }
  constexpr std::array kKinds{"waypoints", "track", "walk", "drive", "flock"};
  const char* kind = nullptr;
  for (const char* k : kKinds) {
    if (!reader.has(k)) continue;
    if (kind != nullptr) {
      reader.fail(reader.raw().get(k), reader.dotted(k) + ": the object is moved by " + kind + " already");
    }
    kind = k;
  }
  const std::string_view chosen = kind == nullptr ? "" : kind;
  const auto sub = [&](const char* key) {
    const toml::table* table = reader.table(key);
    static const toml::table empty;
    return TomlReader(table != nullptr ? *table : empty, reader.dotted(key), reader.error());
  };
  m.face_forward = chosen == "walk" || chosen == "drive" || chosen == "flock";
  if (chosen == "walk") {
    m.kind = read_walk(sub("walk"), m.seed);
  } else if (chosen == "drive") {
    m.kind = read_drive(sub("drive"), m.seed);
  } else if (chosen == "flock") {
    m.kind = read_flock(sub("flock"), m.seed);
  } else if (chosen == "waypoints") {
    m.kind = read_waypoints(reader);
  } else if (chosen == "track") {
    std::string file;
    Track track;
    reader.read("track", file);
    reader.read("loop", track.loop);
    reader.read("corners", track.corners);
    track.file = folder / file;
    m.kind = track;
  } else {
    m.kind = read_motion_formula(reader);
  }
  if (kind != nullptr) reader.read("face_forward", m.face_forward);
  std::size_t before_start = 0;
  reader.read_word("before_start", before_start, {"run", "hold"});
  m.hold_before_start = before_start == 1;
  if (auto* formula = std::get_if<MotionFormula>(&m.kind)) formula->hold_before_start = m.hold_before_start;
  reader.finish();
  return m;
}

}  // namespace peerd::motion
