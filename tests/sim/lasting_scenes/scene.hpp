#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "core/math.hpp"

// Scenes in which contacts last: what rests, leans, pushes and is pushed, and who owns it.
namespace peerd::sim::lasting_scenes {

// A box or a ball, at a place in its body's frame.
struct Part {
  Vec3 half_m = Vec3::Zero();  // a box
  double radius_m = 0.0;       // above 0: a ball
  Vec3 offset_m = Vec3::Zero();
};

enum class Motion : std::uint8_t { kStands, kPhysics, kDriven };

struct Body {
  std::string name;
  std::vector<Part> parts;
  Vec3 at = Vec3::Zero();  // [m], world
  Vec3 axis = Vec3::UnitY();
  double angle_rad = 0.0;
  int owner = -1;  // of LastingScene::peers; -1: nobody
  Motion motion = Motion::kStands;
  Vec3 velocity = Vec3::Zero(), acceleration = Vec3::Zero();  // physics; the acceleration where nothing bears it
  double at_s = 0.0;
  std::string formula[3] = {};  // driven: x, y, z
  double mass_kg = 1.0, restitution = 0.0;
  bool encloses = false;  // a room: what is in it stays in it

  [[nodiscard]] Pose pose() const { return {at, Quat(Eigen::AngleAxisd(angle_rad, axis.normalized()))}; }
};

struct Peer {
  std::string name;
  std::uint32_t id = 0;
  std::uint32_t tick_hz = 0;  // 0: the session's
};

struct LastingScene {
  std::uint64_t seed = 0;
  std::string kind;
  std::vector<Body> bodies;
  std::vector<Peer> peers;  // owners first; then those that own nothing; the last one joins late if late_s > 0
  int owners = 1;
  double duration_s = 6.0, late_s = 0.0;
  double latency_ms = 0.0, jitter_ms = 0.0, loss = 0.0;
  std::uint32_t tick_hz = 60;
  double threshold_m = 0.5;  // of every body
  std::string policy = "id", approach = "dr+rcp+acpt";
  int server = 0;
  bool have_views = false;
  std::string events;   // TOML
  std::string sensors;  // VRML
  // What nobody could know before: launches, keys, edits [s].
  std::vector<double> inputs_s;
  // Until when something is driven [s]; 0: nothing is.
  double driven_until_s = 0.0;
  std::string removed;  // a body that an edit takes away, at removed_s
  double removed_s = 0.0;
  bool rests = true;         // at the end nothing moves
  bool is_unique = true;     // there is one end, whoever owns what
  bool is_isolated = false;  // nothing but what physics moves

  [[nodiscard]] bool is_driven() const { return driven_until_s > 0.0; }
  [[nodiscard]] std::string world() const;
  [[nodiscard]] std::string scenario(bool one_owner) const;
  // What this variation is, in one line.
  [[nodiscard]] std::string text() const;
};

// The same seed gives the same scene on every machine.
[[nodiscard]] LastingScene draw_scene(std::uint64_t seed);

// What is wrong with the run of a scene and with that of the same scene with one owner; a line each. `folder`: for
// world and scenario, and, if asked for, for all states of both runs.
[[nodiscard]] std::vector<std::string> faults_of(const LastingScene& scene, const std::string& folder,
                                                 bool writes_states);

}  // namespace peerd::sim::lasting_scenes
