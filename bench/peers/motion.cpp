#include "bench/peers/motion.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "bench/peers/truth.hpp"

namespace peerd::bench::peers {
namespace {

// All lengths are radii of the mesh, all times frames.
constexpr int kWarmUp = 120;  // until they have met
constexpr double kFastest = 0.025, kFastestSpin = 0.03, kPull = 0.0020, kBounce = 0.65, kPush = 0.0015, kKick = 0.002;

using Rotation = double[3][3];

// The rotation is turned by the vector's length [rad] about its direction, from the left. Its rows are made orthonormal
// again.
void turn(Rotation& rotation, const Point& by) {
  const double angle = length(by);
  if (angle < 1e-12) return;
  const Point u = (1 / angle) * by;
  const double c = std::cos(angle), s = std::sin(angle);
  const Rotation q = {{c + u.x * u.x * (1 - c), u.x * u.y * (1 - c) - u.z * s, u.x * u.z * (1 - c) + u.y * s},
                      {u.y * u.x * (1 - c) + u.z * s, c + u.y * u.y * (1 - c), u.y * u.z * (1 - c) - u.x * s},
                      {u.z * u.x * (1 - c) - u.y * s, u.z * u.y * (1 - c) + u.x * s, c + u.z * u.z * (1 - c)}};
  Rotation product;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      product[i][j] = q[i][0] * rotation[0][j] + q[i][1] * rotation[1][j] + q[i][2] * rotation[2][j];
    }
  }
  const Point x = unit({product[0][0], product[0][1], product[0][2]});
  Point y{product[1][0], product[1][1], product[1][2]};
  y = unit(y - dot(x, y) * x);
  const Point rows[3] = {x, y, cross(x, y)};
  for (int i = 0; i < 3; ++i) {
    rotation[i][0] = rows[i].x;
    rotation[i][1] = rows[i].y;
    rotation[i][2] = rows[i].z;
  }
}

class Crowd {
 public:
  Crowd(const TriangleMesh& mesh, unsigned seed)
      : radius_(mesh.radius), generator_(seed * 7919 + 13), truth_(mesh, kBodies), bodies_(kBodies) {
    for (std::size_t i = 0; i < kBodies; ++i) {
      Placement& body = bodies_[i];
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) body.rotation[row][column] = row == column;
      }
      turn(body.rotation, 3.0 * random());
      const Point cell{static_cast<double>(i % 3) - 1, static_cast<double>(i / 3 % 2) - 0.5,
                       static_cast<double>(i / 6) - 0.5};
      body.position = 2.05 * cell + 0.01 * random();
      velocity_[i] = 0.02 * random();
      spin_[i] = 0.03 * random();
    }
  }

  void step() {
    for (std::size_t i = 0; i < kBodies; ++i) drift(i);
    truth_.move(bodies_);
    for (std::size_t i = 0; i < kBodies; ++i) {
      for (std::size_t j = i + 1; j < kBodies; ++j) bounce(i, j);
    }
  }

  // The frame is that of the last step.
  [[nodiscard]] Frame frame() const {
    Frame frame{bodies_, {}};
    for (std::size_t i = 0; i < kBodies; ++i) {
      for (std::size_t j = i + 1; j < kBodies; ++j) {
        if (length(bodies_[i].position - bodies_[j].position) < 2 * radius_ && truth_.boxes_overlap(i, j)) {
          frame.queries.push_back({i, j, truth_.count(i, j, std::numeric_limits<std::size_t>::max())});
        }
      }
    }
    return frame;
  }

 private:
  Point random() {  // of a cube of half side 1
    const auto number = [&] { return generator_() / 2147483648.0 - 1; };
    return {number(), number(), number()};
  }

  void drift(std::size_t i) {
    Placement& body = bodies_[i];
    Point& velocity = velocity_[i];
    const double far = length(body.position);
    velocity = velocity - (kPull * std::min(1.0, far) / std::max(1e-9, far)) * body.position;
    const double speed = length(velocity);
    if (speed > kFastest) velocity = (kFastest / speed) * velocity;
    body.position = body.position + velocity;
    turn(body.rotation, spin_[i]);
  }

  void bounce(std::size_t i, std::size_t j) {
    const Point between = bodies_[j].position - bodies_[i].position;
    const double distance = length(between);
    if (distance > 2 * radius_ || !truth_.touch(i, j)) return;
    const Point u = (1 / distance) * between;
    const double a = dot(velocity_[i], u), b = dot(velocity_[j], u);
    if (a - b > 0) {
      velocity_[i] = velocity_[i] + (kBounce * (b - a)) * u;
      velocity_[j] = velocity_[j] + (kBounce * (a - b)) * u;
    }
    velocity_[i] = velocity_[i] - kPush * u;
    velocity_[j] = velocity_[j] + kPush * u;
    spin_[i] = spin_[i] + kKick * random();
    spin_[j] = spin_[j] + kKick * random();
    for (const std::size_t k : {i, j}) {
      const double spin = length(spin_[k]);
      if (spin > kFastestSpin) spin_[k] = (kFastestSpin / spin) * spin_[k];
    }
  }

  double radius_;
  std::mt19937 generator_;
  Truth truth_;
  std::vector<Placement> bodies_;
  std::array<Point, kBodies> velocity_, spin_;
};

}  // namespace

std::vector<Frame> make_motion(const TriangleMesh& mesh, int frames, unsigned seed) {
  Crowd crowd(mesh, seed);
  for (int i = 0; i < kWarmUp; ++i) crowd.step();
  std::vector<Frame> all;
  for (int i = 0; i < frames; ++i) {
    crowd.step();
    all.push_back(crowd.frame());
  }
  return all;
}

}  // namespace peerd::bench::peers
