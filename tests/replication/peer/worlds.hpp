#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/scene/reader.hpp"
#include "replication/physics/world/model_in_force.hpp"
#include "replication/physics/world/motion_world.hpp"

// Small worlds of boxes, and short names for states and times.
namespace peerd::replication::test {

using namespace std::chrono_literals;

struct World {
  // `owned`: the paths of what peers own.
  explicit World(const std::string& body, const std::vector<const char*>& owned = {}) {
    const std::string text = "#VRML V2.0 utf8\n" + body;
    ReadResult result = read_world(text);
    for (const Diagnostic& d : result.diagnostics) ADD_FAILURE() << render(result, d);
    scene = std::move(result.scene.value());
    std::vector<ObjectId> ids;
    for (const char* path : owned) ids.push_back((*this)[path]);
    model = make_world_model(scene, ids);
    in_force.emplace(*model);
  }
  World(const World&) = delete;
  [[nodiscard]] ObjectId operator[](const char* path) const { return scene.find(path).value(); }

  Scene scene;
  std::unique_ptr<const WorldModel> model;
  std::optional<ModelInForce> in_force;
};

inline const char* const kBounces = " collisionResponse CollisionResponse { } ";
inline const char* const kStops = " collisionResponse CollisionResponse { responseType 1 } ";

// A box object; `fields` are those of its Transform besides the translation.
inline std::string box(const std::string& name, const std::string& size, const std::string& at,
                       const std::string& fields = "") {
  return "DEF " + name + " Transform { translation " + at + " " + fields + " children Shape { geometry Box { size " +
         size + " } } }\n";
}
inline std::string interest(const std::string& collider, const std::string& collidees, int type = 1) {
  return "CollisionInterest { objectPath \"" + collider + "\" interests [" + collidees + "] collisionType " +
         std::to_string(type) + " }\n";
}
// A Transform with a box of its own and more children.
inline std::string box_with(const std::string& name, const std::string& size, const std::string& at,
                            const std::string& fields, const std::string& children) {
  return "DEF " + name + " Transform { translation " + at + " " + fields + " children [ Shape { geometry Box { size " +
         size + " } }\n" + children + "] }\n";
}

// BALL, 0.5 m wide and as deep, between walls whose faces leave its centre [-3, 3] m of x.
inline std::string corridor(const std::string& ball_fields = kBounces) {
  return box("BALL", "0.5 0.5 0.5", "0 0 0", ball_fields) + box("LEFT", "1 50 50", "-3.75 0 0") +
         box("RIGHT", "1 50 50", "3.75 0 0") + interest("BALL", "\"LEFT\" \"RIGHT\"");
}

inline KinematicState moving(const Vec3& p, const Vec3& v = Vec3::Zero(), const Vec3& a = Vec3::Zero()) {
  KinematicState s;
  s.position = p;
  s.velocity = v;
  s.acceleration = a;
  return s;
}

inline SimTime sim(Duration since_epoch) { return SimTime{since_epoch}; }
inline HostTime host(Duration since_epoch) { return HostTime{since_epoch}; }
inline Duration seconds(double s) { return from_seconds(s); }

// The comparison is bit for bit, so that -0 and 0 differ.
inline bool same_bits(const KinematicState& a, const KinematicState& b) {
  const auto flat = [](const KinematicState& s) {
    Eigen::Matrix<double, 16, 1> all;
    all << s.position, s.velocity, s.acceleration, s.orientation.coeffs(), s.angular_velocity_body;
    return all;
  };
  const auto x = flat(a), y = flat(b);
  return std::equal(x.begin(), x.end(), y.begin(), [](double p, double q) {
    return std::bit_cast<std::uint64_t>(p) == std::bit_cast<std::uint64_t>(q);
  });
}

}  // namespace peerd::replication::test
