// Draws scenes. Sizes and heights are whole 64ths of a metre, so that stacked bodies touch to the last bit. Numbers of
// the world's file are rounded to float, as VRML reads them.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>

#include "tests/sim/chance.hpp"
#include "tests/sim/lasting_scenes/scene.hpp"

namespace peerd::sim::lasting_scenes {
namespace {

using testing_support::Chance;

constexpr double kPi = std::numbers::pi;
constexpr double kCalm_s = 3.0;  // how long bounces may take, by the greatest drop

double to_64ths(double value) { return std::round(64.0 * value) / 64.0; }

std::string number(double value) {
  std::ostringstream out;
  out.precision(17);
  out << value;
  return out.str();
}

// From `from` to `to`, smoothly (its second derivative is continuous) within duration_s from begin_s on.
std::string smooth(double from, double to, double begin_s, double duration_s) {
  const std::string s = "min(1, max(0, (t - " + number(begin_s) + ") / " + number(duration_s) + "))";
  return number(from) + " + " + number(to - from) + " * " + s + "^3 * (10 - 15 * " + s + " + 6 * " + s + "^2)";
}

class Drawing {
 public:
  explicit Drawing(std::uint64_t seed) : chance_(seed * 0x9e3779b97f4a7c15ULL + 63) {
    scene_.seed = seed;
    scene_.bodies.reserve(16);  // references to them stay
    draw_session();
    static constexpr std::array<void (Drawing::*)(), 11> kKinds = {
        &Drawing::stack,       &Drawing::slope,        &Drawing::wedge,         &Drawing::trough,
        &Drawing::driven_tray, &Drawing::sliding_tray, &Drawing::pusher,        &Drawing::conveyor,
        &Drawing::lift,        &Drawing::pressed,      &Drawing::boxes_in_boxes};
    (this->*kKinds[chance_.below(kKinds.size())])();
    finish();
  }
  LastingScene take() { return std::move(scene_); }

 private:
  void draw_session() {
    scene_.owners = chance_.one_of({1, 2, 2, 2, 3, 3});
    const bool have_observer = chance_.happens(0.5), have_late = chance_.happens(0.3);
    const auto count = std::size_t(scene_.owners) + have_observer + have_late;
    std::vector<std::uint32_t> ids = {1, 2, 3, 4, 5};
    for (std::size_t i = ids.size() - 1; i > 0; --i) std::swap(ids[i], ids[chance_.below(i + 1)]);
    for (std::size_t p = 0; p < count; ++p) scene_.peers.push_back({std::string(1, char('a' + p)), ids[p], 0});
    scene_.latency_ms = chance_.one_of({0.0, 1.0, 20.0, 50.0, 100.0, 200.0, 300.0});
    if (chance_.happens(0.25)) scene_.loss = 0.1;
    if (chance_.happens(0.25)) scene_.jitter_ms = 20.0;
    scene_.tick_hz = chance_.one_of({20u, 30u, 60u, 60u, 60u, 100u, 144u});
    scene_.policy = chance_.one_of({"id", "id", "velocity", "field-of-view", "expected-error", "server"});
    scene_.approach = chance_.one_of({"dr", "dr+rcp", "dr+rcp+acpt", "dr+rcp+acpt"});
    scene_.threshold_m = chance_.one_of({0.5, 0.5, 0.1, 0.01});
    scene_.server = int(chance_.below(count - (have_late ? 1 : 0)));
    scene_.have_views = chance_.happens(0.5);
    if (have_late) scene_.late_s = chance_.between(0.5, 4.0);
    restitution_ = chance_.one_of({0.0, 0.0, 0.2, 0.5, 0.7, 0.9});
    gravity_ = chance_.one_of({9.81, 9.81, 1.62, 3.71});
  }

  int any_owner() { return int(chance_.below(std::size_t(scene_.owners))); }
  int owner_or_nobody() { return chance_.happens(0.4) ? -1 : any_owner(); }
  double mass() { return chance_.happens(0.1) ? chance_.one_of({0.05, 40.0}) : chance_.between(0.5, 4.0); }
  double restitution() { return chance_.happens(0.7) ? restitution_ : chance_.between(0.0, restitution_); }

  Body& add(std::string name, Vec3 at, int owner) {
    Body& body = scene_.bodies.emplace_back();
    body.name = std::move(name);
    body.at = at;
    body.owner = owner;
    return body;
  }
  Body& add_standing(std::string name, Vec3 at, Vec3 half) {
    Body& body = add(std::move(name), at, owner_or_nobody());
    body.parts = {{half}};
    return body;
  }
  // Of this half height at least, in each owner's turn.
  Body& add_free(std::string name, Vec3 at, Part part, Vec3 acceleration) {
    Body& body = add(std::move(name), at, int(next_owner_++ % std::size_t(scene_.owners)));
    body.parts = {part};
    body.motion = Motion::kPhysics;
    body.acceleration = acceleration;
    body.mass_kg = mass();
    body.restitution = restitution();
    return body;
  }
  Part box(double low = 0.25, double high = 0.75) {
    const auto half = [&] { return to_64ths(chance_.between(low, high)); };
    const double x = half(), y = half(), z = half();
    return {Vec3(x, y, z)};
  }
  Part ball(double low = 0.25, double high = 0.6) { return {Vec3::Zero(), to_64ths(chance_.between(low, high))}; }
  static double half_height(const Part& part) { return part.radius_m > 0.0 ? part.radius_m : part.half_m.y(); }
  static double half_width(const Part& part) { return part.radius_m > 0.0 ? part.radius_m : part.half_m.x(); }

  // The greatest drop after which it bounces no longer than kCalm_s.
  double greatest_drop(double acceleration) const {
    const double flight_s = kCalm_s / 1.5 * (1.0 - restitution_) / (1.0 + restitution_);
    return std::min(1.0, 0.5 * acceleration * flight_s * flight_s);
  }
  double settling_s(double drop, double acceleration) const {
    return 1.5 * std::sqrt(2.0 * drop / acceleration) * (1.0 + restitution_) / (1.0 - restitution_);
  }
  void input(double at_s) { scene_.inputs_s.push_back(at_s); }
  void add_key(const Body& body, Vec3 velocity, bool replaces, double at_s) {
    scene_.sensors += "KeySensor { recipient \"" + body.name + "\" keyValue 32 value " + number(velocity.x()) + ' ' +
                      number(velocity.y()) + ' ' + number(velocity.z()) + (replaces ? " absoluteValue TRUE" : "") +
                      " }\n";
    scene_.events += "[event.key]\nkind = \"key\"\nat_s = " + number(at_s) +
                     "\nkey = \" \"\npeer = \"OWNER:" + scene_.peers[std::size_t(body.owner)].name + "\"\n";
    input(at_s);
  }
  void remove(const Body& body, double at_s) {
    scene_.events += "[event.away]\nkind = \"remove\"\nat_s = " + number(at_s) + "\npath = \"" + body.name +
                     "\"\npeer = \"OWNER:" + scene_.peers[std::size_t(any_owner())].name + "\"\n";
    scene_.removed = body.name;
    scene_.removed_s = at_s;
    // The edit takes effect within 100 ms or twice the longest latency.
    for (const double later_s : {0.0, 0.1, 2e-3 * (scene_.latency_ms + scene_.jitter_ms)}) input(at_s + later_s);
  }

  void stack() {
    scene_.kind = "stack";
    const double drop = greatest_drop(gravity_);
    const bool is_removed = chance_.happens(0.25);
    const double thick = is_removed ? std::max(1.0 / 32.0, to_64ths(0.4 * drop)) : 1.0;
    if (is_removed) add_standing("FLOOR", Vec3(0, -0.5 - thick, 0), Vec3(6, 0.5, 6));
    add_standing("TABLE", Vec3(0, -0.5 * thick, 0), Vec3(3, 0.5 * thick, 3));
    const std::size_t count = 2 + chance_.below(3);
    const bool touch = chance_.happens(0.4);
    double top = 0.0;
    bool was_ball = false;
    for (std::size_t i = 0; i < count; ++i) {
      const bool is_ball = !was_ball && chance_.happens(0.3);
      const Part part = is_ball ? ball() : box();
      const double gap = touch ? 0.0 : to_64ths(chance_.between(0.0, 0.5 * drop / double(count)));
      const double y = top + gap + half_height(part);
      const double off = was_ball || is_ball ? 0.0 : 0.1;
      Body& body = add_free("B" + std::to_string(i), Vec3(chance_.between(-off, off), y, chance_.between(-off, off)),
                            part, Vec3(0, -gravity_, 0));
      if (!is_ball && chance_.happens(0.3)) body.angle_rad = chance_.between(-0.5, 0.5);
      top = y + half_height(part);
      was_ball = is_ball;
    }
    double until_s = settling_s(drop, gravity_);
    if (is_removed) {
      remove(scene_.bodies[1], until_s + 0.5);
      until_s += 0.7 + 2e-3 * scene_.latency_ms + settling_s(drop, gravity_);
    } else if (chance_.happens(0.3)) {
      const Body& kicked = chance_.happens(0.5) ? scene_.bodies.back() : scene_.bodies[1];
      add_key(kicked, Vec3(0, std::sqrt(2.0 * gravity_ * 0.5 * drop), 0), chance_.happens(0.5), until_s + 0.5);
      until_s += 1.0 + settling_s(drop, gravity_);
    }
    end_at(until_s);
  }

  void slope() {
    scene_.kind = "slope";
    const double tilt = chance_.between(5.0, 40.0) * kPi / 180.0;
    const Pose frame{Vec3::Zero(), Quat(Eigen::AngleAxisd(-tilt, Vec3::UnitZ()))};  // its x leads down
    const auto turn = [&](Body& body) {
      body.at = frame * body.at;
      body.axis = Vec3::UnitZ();
      body.angle_rad = -tilt;
    };
    turn(add_standing("SLOPE", Vec3(0, -0.5, 0), Vec3(6, 0.5, 3)));
    turn(add_standing("STOP", Vec3(4.5, 1.01, 0), Vec3(0.5, 1, 3)));
    const double down = gravity_ * std::sin(tilt);
    const double way = std::min(4.0, 0.5 * down * std::pow(kCalm_s * (1.0 - restitution_) / (1.0 + restitution_), 2));
    const std::size_t count = 1 + chance_.below(3);
    double x = 4.0;
    for (std::size_t i = 0; i < count; ++i) {
      // Balls of one size that touch each other are in line.
      const Part part = chance_.happens(0.5) && count == 1 ? ball() : box();
      x -= half_width(part) + chance_.between(0.0, way / double(count)) + 0.001;
      const double gap = chance_.one_of({0.0, 0.001, 0.05});
      Body& body = add_free("B" + std::to_string(i), Vec3(x, half_height(part) + gap, chance_.between(-0.2, 0.2)), part,
                            Vec3(0, -gravity_, 0));
      if (gap == 0.0) body.at.y() += 2e-6;  // what is turned is rounded in its place
      turn(body);
      x -= half_width(part);
    }
    double until_s = 1.5 * kCalm_s * std::sqrt(double(count));
    if (chance_.happens(0.25)) {
      Body& body = scene_.bodies.back();
      add_key(body, frame.orientation * Vec3(-std::sqrt(down * way), 0, 0), false, until_s);
      until_s += 1.5 * kCalm_s;
    }
    end_at(until_s);
  }

  // Two slabs that lean against each other; their surfaces meet in the z axis.
  void add_valley() {
    for (const int side : {-1, 1}) {
      const double tilt = side * chance_.between(15.0, 55.0) * kPi / 180.0;
      const Quat turned(Eigen::AngleAxisd(tilt, Vec3::UnitZ()));
      Body& slab = add_standing(side < 0 ? "LEFT" : "RIGHT", turned * Vec3(side * 1.75, -0.25, 0), Vec3(2, 0.25, 3));
      slab.axis = Vec3::UnitZ();
      slab.angle_rad = tilt;
      flatter_ = std::min(flatter_, std::abs(tilt));
    }
  }
  void wedge() {
    scene_.kind = "wedge";
    add_valley();
    const double drop = greatest_drop(gravity_ * std::pow(std::sin(flatter_), 2));
    const bool is_ball = chance_.happens(0.5);
    const Part part = is_ball ? ball(0.3, 0.5) : box(0.25, 0.4);
    const double r = is_ball ? part.radius_m : part.half_m.head<2>().norm();
    // High enough above the line in which they meet, a little to a side.
    add_free("B0", Vec3(chance_.between(-0.2, 0.2), 1.8 * r + 0.2 + 0.5 * drop, 0), part, Vec3(0, -gravity_, 0));
    end_at(4.0 + 3.0 * settling_s(1.0 + drop, gravity_ * std::sin(flatter_)));
  }
  void trough() {
    scene_.kind = "trough";
    scene_.is_unique = scene_.rests = false;
    add_valley();
    add_standing("NEAR", Vec3(0, 0, 2.5), Vec3(3, 3, 0.25));
    add_standing("FAR", Vec3(0, 0, -2.5), Vec3(3, 3, 0.25));
    const std::size_t count = 1 + chance_.below(3);
    for (std::size_t i = 0; i < count; ++i) {
      Body& body = add_free("B" + std::to_string(i), Vec3(chance_.between(-0.1, 0.1), 1.2, -1.5 + 1.5 * double(i)),
                            ball(0.25, 0.5), Vec3(0, -gravity_, 0));
      if (chance_.happens(0.5)) body.velocity = Vec3(0, 0, chance_.between(-1.5, 1.5));
    }
    end_at(6.0);
  }

  // Things on a tray with rims.
  double add_load(double floor_y, double half_x, std::size_t most, double drop) {
    const std::size_t count = 1 + chance_.below(most);
    const double room = 2.0 * half_x / double(count);
    double reach = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const Part part = chance_.happens(0.4) ? ball(0.2, 0.4) : box(0.2, 0.4);
      const double x = -half_x + room * (double(i) + 0.5);
      const double gap = chance_.happens(0.5) ? 0.0 : to_64ths(chance_.between(0.0, 0.5 * drop));
      add_free("B" + std::to_string(i), Vec3(x, floor_y + half_height(part) + gap, 0), part, Vec3(0, -gravity_, 0));
      reach = std::max(reach, gap);
    }
    return reach;
  }
  static std::vector<Part> tray_parts(double half_x) {
    return {{Vec3(half_x, 0.125, 1.5), 0.0, Vec3::Zero()},
            {Vec3(0.125, 0.5, 1.5), 0.0, Vec3(half_x + 0.125, 0.375, 0)},
            {Vec3(0.125, 0.5, 1.5), 0.0, Vec3(-half_x - 0.125, 0.375, 0)}};
  }
  void drive(Body& body, int axis, double way, double begin_s, double duration_s) {
    body.motion = Motion::kDriven;
    for (int i = 0; i < 3; ++i) body.formula[i] = number(body.at[i]);
    body.formula[axis] = smooth(body.at[axis], body.at[axis] + way, begin_s, duration_s);
    scene_.driven_until_s = begin_s + duration_s;
    input(begin_s);
  }
  void driven_tray() {
    scene_.kind = "driven tray";
    scene_.is_unique = false;
    scene_.rests = false;  // what a rim throws glides on from rim to rim
    Body& tray = add("TRAY", Vec3(0, -0.125, 0), any_owner());
    tray.parts = tray_parts(1.5);
    const double way = chance_.between(-4.0, 4.0), duration_s = chance_.between(1.0, 3.0);
    drive(tray, 0, way, chance_.between(1.0, 2.0), duration_s);
    add_load(0.0, 1.5, 2, greatest_drop(gravity_));
    end_at(scene_.driven_until_s + 3.0);
  }
  void sliding_tray() {
    scene_.kind = "sliding tray";
    scene_.is_unique = scene_.rests = false;
    add_standing("FLOOR", Vec3(0, -0.75, 0), Vec3(30, 0.5, 3));
    Body& tray = add_free("TRAY", Vec3(0, -0.125, 0), {}, Vec3(0, -gravity_, 0));
    tray.parts = tray_parts(1.5);
    if (chance_.happens(0.5)) {
      tray.velocity.x() = chance_.between(-1.5, 1.5);
    } else {
      tray.acceleration.x() = chance_.between(-0.5, 0.5);
    }
    if (chance_.happens(0.4)) tray.at_s = chance_.between(1.0, 2.5), input(tray.at_s);
    add_load(0.0, 1.5, 2, greatest_drop(gravity_));
    end_at(6.0);
  }

  // In line along x, without gravity.
  void pusher() {
    scene_.kind = "pusher";
    scene_.is_unique = scene_.rests = false;
    const std::size_t count = 1 + chance_.below(3);
    const bool is_driven = chance_.happens(0.4), to_wall = chance_.happens(0.5);
    Body* pushes = nullptr;
    const Part part = box();
    double x = half_width(part);
    if (is_driven) {
      pushes = &add("PUSHER", Vec3(0, 0, 0), any_owner());
      pushes->parts = {part};
    } else {
      pushes = &add_free("PUSHER", Vec3(0, 0, 0), part, Vec3(chance_.between(0.5, 2.0), 0, 0));
      if (chance_.happens(0.4)) pushes->at_s = chance_.between(0.5, 2.0), input(pushes->at_s);
    }
    double room = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const bool is_ball = chance_.happens(0.3);
      const Part pushed = is_ball ? ball() : box();
      const double gap = chance_.happens(0.5) ? 0.0 : to_64ths(chance_.between(0.0, 0.7));
      room += gap;
      x += gap + half_width(pushed);
      add_free("B" + std::to_string(i), Vec3(x, 0, 0), pushed, Vec3::Zero());
      x += half_width(pushed);
    }
    if (to_wall) add_standing("WALL", Vec3(x + 1.75, 0, 0), Vec3(0.25, 2, 2));
    if (is_driven) {
      drive(*pushes, 0, room + (to_wall ? 0.75 : chance_.between(0.5, 3.0)), chance_.between(0.5, 2.0),
            chance_.between(1.0, 3.0));
    } else if (to_wall) {
      scene_.is_unique = scene_.rests = true;
      double pushed_kg = 0.0;
      for (const Body& body : scene_.bodies) {
        if (&body != pushes && body.motion == Motion::kPhysics) pushed_kg += body.mass_kg;
      }
      pushes->mass_kg = std::max(pushes->mass_kg, pushed_kg);  // it is at the wall within 6 s
    } else {
      scene_.is_isolated = true;
      if (chance_.happens(0.3))
        add_key(*pushes, Vec3::Zero(), true, chance_.between(2.0, 4.0)), scene_.is_isolated = false;
    }
    end_at(scene_.rests ? 6.0 + 3.0 * (1.0 + restitution_) / (1.0 - restitution_) : 7.0);
  }

  void conveyor() {
    scene_.kind = "conveyor";
    Body& belt = add("BELT", Vec3(0, -0.25, 0), any_owner());
    belt.parts = {{Vec3(5, 0.25, 2)}};
    const double drop = greatest_drop(gravity_), until_s = settling_s(drop, gravity_);
    drive(belt, chance_.happens(0.5) ? 0 : 2, chance_.between(-1.2, 1.2), chance_.between(0.5, 2.0),
          chance_.between(1.0, 3.0));
    add_load(0.0, 1.5, 3, drop);
    end_at(std::max(until_s, scene_.driven_until_s) + 0.5);
  }
  void lift() {
    scene_.kind = "lift";
    Body& platform = add("LIFT", Vec3(0, -0.25, 0), any_owner());
    platform.parts = {{Vec3(3, 0.25, 2)}};
    drive(platform, 1, chance_.between(-2.0, 2.0), chance_.between(0.5, 2.0), chance_.between(1.5, 3.0));
    const double drop = greatest_drop(gravity_);
    add_load(0.0, 1.5, 3, drop);
    if (chance_.happens(0.5)) {
      const Body& below = scene_.bodies.back();
      if (below.parts[0].radius_m == 0.0) {
        const Part part = box(0.2, 0.4);
        add_free("TOP", below.at + Vec3(0, below.parts[0].half_m.y() + part.half_m.y(), 0), part,
                 Vec3(0, -gravity_, 0));
      }
    }
    end_at(scene_.driven_until_s + 1.0 + settling_s(std::max(drop, 0.3), gravity_));
  }

  void pressed() {
    scene_.kind = "pressed pair";
    scene_.rests = false;
    scene_.is_isolated = true;
    const bool touch = chance_.happens(0.4);
    const double press = chance_.between(0.5, 4.0);
    const double gap = touch ? 0.0 : to_64ths(std::min(2.0, greatest_drop(press)));
    double x = 0.0;
    for (const int side : {0, 1}) {
      const Part part = chance_.happens(0.3) ? ball() : box();
      x += half_width(part);
      Body& body =
          add_free(side == 0 ? "B0" : "B1", Vec3(x, 0, 0), part,
                   Vec3((side == 0 ? 1 : -1) * (chance_.happens(0.5) ? press : chance_.between(0.5, 4.0)), 0, 0));
      if (chance_.happens(0.25)) body.at_s = chance_.between(0.5, 2.5), input(body.at_s);
      x += half_width(part) + gap;
    }
    end_at(4.0 + 2.0 * settling_s(std::max(gap, 0.1), press) * 1.5);
  }

  void boxes_in_boxes() {
    scene_.kind = "boxes in boxes";
    scene_.is_unique = false;
    Body& room = add("ROOM", Vec3::Zero(), owner_or_nobody());
    room.parts = {{Vec3(3, 2, 3)}};
    room.encloses = true;
    const double drop = greatest_drop(gravity_);
    const auto fall = [&](double extent) { return to_64ths(chance_.between(0.0, 0.8 * drop)) - 2.0 + extent; };
    if (chance_.happens(0.4)) {
      const Part crate = {Vec3(1.25, 1, 1.25)};
      const double y = fall(1.0);
      add_free("CRATE", Vec3(0, y, 0), crate, Vec3(0, -gravity_, 0)).encloses = true;
      const Part part = chance_.happens(0.5) ? ball(0.2, 0.5) : box(0.2, 0.5);
      add_free("B0", Vec3(0.25, y - 1.0 + half_height(part) + to_64ths(chance_.between(0.0, 0.2 * drop)), 0.25), part,
               Vec3(0, -gravity_, 0));
    } else {
      const std::size_t count = 1 + chance_.below(3);
      for (std::size_t i = 0; i < count; ++i) {
        const Part part = chance_.happens(0.5) ? ball(0.25, 0.6) : box(0.25, 0.6);
        Body& body = add_free("B" + std::to_string(i), Vec3(-1.75 + 1.75 * double(i), fall(half_height(part)), 0.25),
                              part, Vec3(0, -gravity_, 0));
        if (chance_.happens(0.3)) body.velocity = Vec3(chance_.between(-2, 2), 0, chance_.between(-2, 2));
        scene_.rests = scene_.rests && body.velocity == Vec3::Zero();
      }
    }
    if (chance_.happens(0.3)) {
      Body& body = scene_.bodies.back();
      add_key(body, Vec3(0, std::sqrt(gravity_ * drop), 0), false, settling_s(drop, gravity_));
    }
    end_at(2.0 * settling_s(drop, gravity_) + 0.5);
  }

  void end_at(double until_s) { calm_s_ = until_s; }
  // Time for the last update to come, and for who joins.
  void finish() {
    for (Body& body : scene_.bodies) {
      body.at = body.at.cast<float>().cast<double>();
      body.angle_rad = double(float(body.angle_rad));
      body.mass_kg = double(float(body.mass_kg));
      body.restitution = double(float(body.restitution));
      // Until its launch it stands, and takes any momentum.
      if (body.at_s > 0.0) scene_.is_isolated = false;
    }
    double until_s = std::max(calm_s_, 3.0);
    for (const double at_s : scene_.inputs_s) until_s = std::max(until_s, at_s);
    // What a driven body has struck is told as exactly as that one, up to the update by the time threshold of 5 s.
    if (scene_.is_driven()) until_s = std::max(until_s, scene_.driven_until_s + 5.5);
    if (scene_.late_s > 0.0) until_s = std::max(until_s, scene_.late_s + 3.5);
    scene_.duration_s =
        std::ceil(until_s + 1.0 + 6e-3 * (scene_.latency_ms + scene_.jitter_ms) + (scene_.loss > 0.0 ? 2.0 : 0.0));
    for (const Body& body : scene_.bodies) {
      if (body.motion == Motion::kPhysics && body.at_s == 0.0) {
        input(0.0);
        break;
      }
    }
  }

  Chance chance_;
  LastingScene scene_;
  double restitution_ = 0.0, gravity_ = 9.81, calm_s_ = 0.0, flatter_ = kPi / 2.0;
  std::size_t next_owner_ = 0;
};

}  // namespace

LastingScene draw_scene(std::uint64_t seed) { return Drawing(seed).take(); }

}  // namespace peerd::sim::lasting_scenes
