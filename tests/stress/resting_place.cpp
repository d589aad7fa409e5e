#include "tests/stress/resting_place.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <sstream>

namespace peerd::stress {
namespace {

class Chance {
 public:
  explicit Chance(std::uint64_t seed) : engine_(seed) {}
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  double of_magnitude(double low, double high) { return std::exp(between(std::log(low), std::log(high))); }
  bool happens(double probability) { return between(0.0, 1.0) < probability; }

 private:
  std::mt19937_64 engine_;
};

enum class Shape : std::uint8_t { kSphere, kBox, kMesh };

std::string numbers(const Vec3& v) {
  std::ostringstream text;
  text.precision(17);
  text << v.x() << ' ' << v.y() << ' ' << v.z();
  return text.str();
}

std::string box(const Vec3& size) { return "Box { size " + numbers(size) + " }"; }

// A table on two legs, all in [-1/2, 1/2]^3 times the size: not convex, and level at the bottom of its legs.
std::string table(double size) {
  const std::array<std::array<double, 2>, 8> outline{
      {{-.5, -.5}, {-.25, -.5}, {-.25, .25}, {.25, .25}, {.25, -.5}, {.5, -.5}, {.5, .5}, {-.5, .5}}};
  std::ostringstream text;
  text << "IndexedFaceSet { convex FALSE coord Coordinate { point [";
  for (const double z : {-.5, .5}) {
    for (const auto& [x, y] : outline) text << numbers(size * Vec3(x, y, z)) << ", ";
  }
  text << "] } coordIndex [7 6 5 4 3 2 1 0 -1, 8 9 10 11 12 13 14 15 -1";
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const std::size_t next = (i + 1) % outline.size();
    text << ", " << i << ' ' << next << ' ' << next + 8 << ' ' << i + 8 << " -1";
  }
  return text.str() + "] }";
}

// Everything is made upright around the origin, and then turned and moved as one.
class Builder {
 public:
  Builder(Chance& chance, const Pose& frame, double size, double gap)
      : chance_(chance), frame_(frame), size_(size), gap_(gap) {}

  // Something that stands.
  void support(const std::string& geometry, const Vec3& place, const Quat& turn = Quat::Identity()) {
    const std::string name = "S" + std::to_string(supports_.size());
    supports_.push_back({name, add(name, geometry, place, turn, "")});
    interests_ += '"' + name + "\" ";
  }
  // A body under gravity; all bodies and supports before it are what it may meet.
  void body(Shape shape, const Vec3& place, const Quat& turn = Quat::Identity()) {
    const std::string name = "O" + std::to_string(bodies_.size());
    std::ostringstream response;
    response << " collisionResponse CollisionResponse { responseType 2 mass " << chance_.of_magnitude(0.1, 1e3)
             << " restitution " << (chance_.happens(0.3) ? 0.0 : chance_.between(0.0, 0.95)) << " friction "
             << (chance_.happens(0.5) ? 0.0 : chance_.between(0.0, 1.0)) << " }";
    std::ostringstream sphere;
    sphere.precision(17);
    sphere << "Sphere { radius " << 0.5 * size_ << " }";
    const std::string geometry = shape == Shape::kSphere ? sphere.str()
                                 : shape == Shape::kBox  ? box(Vec3::Constant(size_))
                                                         : table(size_);
    KinematicState launch = add(name, geometry, place, turn, response.str());
    launch.acceleration = frame_.orientation * Vec3(0, -9.81, 0);
    world_ += "CollisionInterest { collisionType 1 objectPath \"" + name + "\" interests [" + interests_ + "] }\n";
    interests_ += '"' + name + "\" ";
    bodies_.push_back({name, launch});
  }
  Chance& chance() { return chance_; }
  [[nodiscard]] double size() const { return size_; }
  [[nodiscard]] double gap() const { return gap_; }
  [[nodiscard]] const std::string& world() const { return world_; }
  [[nodiscard]] const std::vector<PlacedObject>& supports() const { return supports_; }
  [[nodiscard]] const std::vector<PlacedObject>& bodies() const { return bodies_; }

 private:
  KinematicState add(const std::string& name, const std::string& geometry, const Vec3& place, const Quat& turn,
                     const std::string& fields) {
    KinematicState state;
    state.position = frame_.position + frame_.orientation * place;
    state.orientation = (frame_.orientation * turn).normalized();
    world_ += "DEF " + name + " Transform {" + fields + " children Shape { geometry " + geometry + " } }\n";
    return state;
  }

  Chance& chance_;
  Pose frame_;
  double size_, gap_;
  std::string world_, interests_;
  std::vector<PlacedObject> supports_, bodies_;
};

Quat about(const Vec3& axis, double angle) { return Quat(Eigen::AngleAxisd(angle, axis)); }

Quat any_yaw(Builder& in) { return about(Vec3::UnitY(), in.chance().between(-3.0, 3.0)); }

void floor_box(Builder& in) {
  const double s = in.size();
  in.support(box({8 * s, 2 * s, 6 * s}), {0, -s, 0});
}

// The quad [-a, b] x {0} x [-c, c] of two triangles.
std::string quad(double a, double b, double c) {
  return "IndexedFaceSet { solid FALSE coord Coordinate { point [" + numbers({-a, 0, -c}) + ", " + numbers({-a, 0, c}) +
         ", " + numbers({b, 0, c}) + ", " + numbers({b, 0, -c}) + "] } coordIndex [0 1 2 -1, 0 2 3 -1] }";
}

void floor_triangles(Builder& in) {
  const double s = in.size();
  in.support(quad(3 * s, 4 * s, 3 * s), Vec3::Zero());
}

// Two boxes, or two sheets, side by side.
void seam(Builder& in) {
  const double s = in.size();
  if (in.chance().happens(0.5)) {
    in.support(box({4 * s, 2 * s, 6 * s}), {-2 * s, -s, 0});
    in.support(box({4 * s, 2 * s, 6 * s}), {2 * s, -s, 0});
  } else {
    in.support(quad(4 * s, 0, 3 * s), Vec3::Zero());
    in.support(quad(0, 4 * s, 3 * s), Vec3::Zero());
  }
}

// Where a body stands on the plane y = 0 near the origin.
void on_the_plane(Builder& in, Shape shape) {
  const double s = in.size();
  const Vec3 place(s * in.chance().between(-0.4, 0.4), 0.5 * s + in.gap(), s * in.chance().between(-0.4, 0.4));
  in.body(shape, place, any_yaw(in));
}

// Two planes through the z axis, each at 45 degrees; a box lies in it face against face.
void wedge(Builder& in, Shape shape) {
  const double s = in.size(), angle = std::numbers::pi / 4;
  if (in.chance().happens(0.5)) {
    for (const double side : {-1.0, 1.0}) {
      const Quat turn = about(Vec3::UnitZ(), side * angle);
      in.support(box({6 * s, s, 6 * s}), turn * Vec3(side * 3 * s, -0.5 * s, 0), turn);
    }
  } else {
    std::string points;
    for (const double z : {-3 * s, 3 * s}) {
      for (const double x : {-4 * s, 0.0, 4 * s}) points += numbers({x, std::abs(x), z}) + ", ";
    }
    in.support("IndexedFaceSet { solid FALSE coord Coordinate { point [" + points +
                   "] } coordIndex [0 3 4 1 -1, 1 4 5 2 -1] }",
               Vec3::Zero());
  }
  in.body(shape, {0, (0.5 * s + in.gap()) * std::numbers::sqrt2, 0}, about(Vec3::UnitZ(), angle));
}

// A floor and two walls.
void corner(Builder& in, Shape shape) {
  const double s = in.size();
  floor_box(in);
  in.support(box({s, 8 * s, 8 * s}), {-1.0 * s - in.gap(), 0, 0});
  in.support(box({8 * s, 8 * s, s}), {0, 0, -1.0 * s - in.gap()});
  in.body(shape, {0, 0.5 * s + in.gap(), 0});
}

void stack(Builder& in, Shape shape) {
  const double s = in.size();
  floor_box(in);
  in.body(in.chance().happens(0.5) ? Shape::kBox : Shape::kMesh, {0, 0.5 * s + in.gap(), 0}, any_yaw(in));
  in.body(shape, {0.1 * s, 1.5 * s + 2.0 * in.gap(), -0.05 * s}, any_yaw(in));
}

}  // namespace

RestingPlace make_resting_place(std::uint64_t seed) {
  Chance chance(seed);
  // Twenty bits, so that small multiples of it are exact in binary32.
  int exponent = 0;
  const double mantissa = std::frexp(chance.of_magnitude(1e-3, 1e3), &exponent);
  const double size = std::ldexp(std::floor(std::ldexp(mantissa, 20)), exponent - 20);
  const std::size_t kind = chance.below(4);
  const double gap = kind == 0   ? 0.0
                     : kind == 1 ? 1e-6
                     : kind == 2 ? chance.of_magnitude(1e-15, 1e-6)
                                 : chance.between(0.0, 1e-6);
  const double far = chance.happens(0.3) ? 0.0 : chance.of_magnitude(1.0, 1e7);
  Pose frame;
  frame.position = Vec3(chance.between(-far, far), chance.between(-far, far), chance.between(-far, far));
  const auto turn = chance.below(3);
  if (turn == 1) frame.orientation = about(Vec3::UnitY(), chance.between(-3.0, 3.0));
  if (turn == 2) {
    const Vec3 axis(chance.between(-1, 1), chance.between(-1, 1), chance.between(-1, 1));
    frame.orientation = about(axis.normalized(), chance.between(-3.0, 3.0));
  }
  Builder in(chance, frame, size, gap);
  const auto shape = static_cast<Shape>(chance.below(3));
  const std::size_t where = chance.below(6);
  if (where == 0) floor_box(in);
  if (where == 1) floor_triangles(in);
  if (where == 2) seam(in);
  if (where < 3) on_the_plane(in, shape);
  if (where == 3) wedge(in, shape);
  if (where == 4) corner(in, shape);
  if (where == 5) stack(in, shape);
  RestingPlace place;
  const std::array<const char*, 3> shapes{"sphere", "box", "mesh"};
  const std::array<const char*, 6> wheres{"box", "two triangles", "seam", "wedge", "corner", "resting body"};
  std::ostringstream what;
  what << shapes[static_cast<std::size_t>(shape)] << " over " << wheres[where] << ", size " << size << " m, gap " << gap
       << " m, at " << frame.position.transpose() << " m, turn " << turn;
  place.what = what.str();
  place.world = in.world();
  place.supports = in.supports();
  place.bodies = in.bodies();
  place.gap_m = where == 5 ? 2.0 * gap : where == 3 ? gap * std::numbers::sqrt2 : gap;
  place.size_m = size;
  place.coordinate_m = frame.position.cwiseAbs().maxCoeff() + 8.0 * size;
  return place;
}

}  // namespace peerd::stress
