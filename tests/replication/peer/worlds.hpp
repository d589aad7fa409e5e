#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/reader.hpp"
#include "replication/physics/world/model_in_force.hpp"
#include "replication/physics/world/motion_world.hpp"
#include "replication/wire/wire.hpp"

// Small worlds of boxes, short names for states and times, and what a MotionWorld reports.
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
  [[nodiscard]] ObjectId operator[](std::string_view path) const { return scene.find(path).value(); }

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

// ARM has no Shape of its own; HAND, a cube, is 20 m along x from it.
inline std::string arm(const std::string& name = "ARM", const std::string& hand = "HAND") {
  return "DEF " + name + " Transform { children DEF " + hand +
         " Transform { translation 20 0 0 children Shape { geometry Box { size 1 1 1 } } } }\n";
}
// CAR carries WHEEL, whose front is 1.5 m before the middle of the car.
inline std::string car_and_wheel(const std::string& at = "0 2 0") {
  return box_with("CAR", "4 1 2", at, "", box("WHEEL", "1 1 0.4", "1 -1 0"));
}
// The scale of GROWS along x goes from 1 to 4 in 2 s, and back.
inline const char* const kGrows = R"(DEF T TimeSensor { cycleInterval 4 loop TRUE }
DEF P PositionInterpolator { key [ 0 0.5 1 ] keyValue [ 1 1 1, 4 1 1, 1 1 1 ] }
ROUTE T.fraction_changed TO P.set_fraction ROUTE P.value_changed TO GROWS.set_scale
)";
// The object goes from x = 10 m to 4 m in 6 s, and back.
inline std::string shuttles(const std::string& name) {
  return "DEF T TimeSensor { cycleInterval 12 loop TRUE }\n"
         "DEF P PositionInterpolator { key [ 0 0.5 1 ] keyValue [ 10 0 0, 4 0 0, 10 0 0 ] }\n"
         "ROUTE T.fraction_changed TO P.set_fraction ROUTE P.value_changed TO " +
         name + ".translation\n";
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

// A decision by the lower id on a contact along x that changes nothing.
inline DecisionRecord decision_on(ObjectId collider, ObjectId collidee, SimTime contact,
                                  const KinematicState& of_collider = {}, const KinematicState& of_collidee = {}) {
  DecisionRecord d;
  d.collider = collider;
  d.collidee = collidee;
  d.contact = contact;
  d.normal = Vec3::UnitX();
  d.collider_before = d.collider_after = of_collider;
  d.collidee_before = d.collidee_after = of_collidee;
  return d;
}

// A world whose motion begins at 0 s, with what moves in it, how it moves from then on, and the paths of what peers
// own.
struct Started {
  struct Mover {
    const char* path;
    Role role;
    std::optional<MotionModel> from = {};
  };
  explicit Started(const std::string& text, const std::vector<Mover>& movers = {},
                   const std::vector<const char*>& owned = {})
      : w(text, owned) {
    for (const Mover& m : movers) world.declare(w[m.path], m.role);
    for (const Mover& m : movers) {
      if (m.from) world.set_base(w[m.path], sim(0s), *m.from);
    }
  }

  World w;
  MotionWorld world{*w.model, sim(0s)};
};

// ---- what a world reports; each takes all that is there ----

inline std::vector<MotionWorld::Event> events_of(MotionWorld& world) {
  std::vector<MotionWorld::Event> events;
  while (auto event = world.poll_event()) events.push_back(std::move(*event));
  return events;
}
inline std::vector<ContactEvent> contacts_of(MotionWorld& world) {
  std::vector<ContactEvent> all;
  while (const auto event = world.poll_event()) {
    if (const auto* contact = std::get_if<ContactEvent>(&*event)) all.push_back(*contact);
  }
  return all;
}
inline std::vector<SimTime> contact_times(MotionWorld& world) {
  std::vector<SimTime> times;
  for (const ContactEvent& contact : contacts_of(world)) times.push_back(contact.at);
  return times;
}
// The times of the contacts that are not retracted, ascending. `known` has them, and those of earlier calls.
inline std::vector<SimTime> standing(MotionWorld& world, std::vector<ContactEvent>& known) {
  while (const auto event = world.poll_event()) {
    if (const auto* contact = std::get_if<ContactEvent>(&*event)) known.push_back(*contact);
    if (const auto* back = std::get_if<ContactsRetracted>(&*event)) {
      std::erase_if(known, [&](const ContactEvent& c) { return back->retracts(c.at, c.collider, c.collidee); });
    }
  }
  std::vector<SimTime> times;
  for (const ContactEvent& contact : known) times.push_back(contact.at);
  std::ranges::sort(times);
  return times;
}
inline std::vector<SimTime> standing(MotionWorld& world) {
  std::vector<ContactEvent> known;
  return standing(world, known);
}

}  // namespace peerd::replication::test
