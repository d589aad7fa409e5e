// swarm WORLD COUNT [NAME VALUE]..: writes a world of COUNT birds to the file WORLD, and flies them: sixty times a
// second all of them move by the rules of Reynolds' boids (1987), and one call says where they are. There is no thread:
// between two frames the peer does its work. Once a second it prints what that cost. More options are those of
// peerd_options_set(), and trace FILE, which writes each frame; seconds S ends it after S seconds of session time.
//
// Others watch them by `peerd join swarm --view`, or by a program of their own.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <limits>
#include <peerd/peerd.hpp>
#include <random>
#include <string>
#include <vector>

using namespace peerd::embed;
using Clock = std::chrono::steady_clock;

namespace {

constexpr double kFrame_s = 1.0 / 60.0;
constexpr double kSees_m = 3.0, kKeepsAway_m = 1.0, kHome_m = 15.0;  // of a bird, and around the origin
constexpr double kSpeedLeast = 2.0, kSpeedMost = 5.0;                // [m/s]

Vector operator+(const Vector& a, const Vector& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector operator*(double s, const Vector& a) { return {s * a[0], s * a[1], s * a[2]}; }
double length(const Vector& a) { return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }

struct Bird {
  Object object = PEERD_NO_OBJECT;
  Vector position{}, velocity{};
};

std::string name_of(std::size_t index) { return "BIRD_" + std::to_string(index); }

// Their first places are part of the world's file, so that all peers agree on it before the first update.
std::vector<Bird> make_world(const std::string& file, std::size_t count) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> place(-kHome_m / 2.0, kHome_m / 2.0), speed(-kSpeedLeast, kSpeedLeast);
  std::vector<Bird> birds(count);
  std::ofstream world(file);
  world << "#VRML V2.0 utf8\n";
  for (std::size_t i = 0; i < count; ++i) {
    birds[i].position = {place(random), place(random), place(random)};
    birds[i].velocity = {speed(random), speed(random), speed(random)};
    const auto& [x, y, z] = birds[i].position;
    world << "DEF " << name_of(i) << " Transform { translation " << x << ' ' << y << ' ' << z
          << " children Shape { geometry Cone { height 0.3 bottomRadius 0.1 } } }\n";
  }
  if (!world.flush()) throw Error("can't write " + file);
  return birds;
}

// How a bird wants to fly: with those near it, towards their middle, not too near to any, and not too far from home.
Vector acceleration(const std::vector<Bird>& birds, const Bird& bird) {
  Vector away{}, middle{}, with{};
  double near = 0.0;
  for (const Bird& other : birds) {
    const Vector to = other.position - bird.position;
    const double distance = length(to);
    if (&other == &bird || distance > kSees_m) continue;
    near += 1.0;
    middle = middle + to;
    with = with + (other.velocity - bird.velocity);
    if (distance < kKeepsAway_m) away = away - (1.0 / (distance + 0.1)) * to;
  }
  Vector sum = 2.0 * away;
  if (near > 0.0) sum = sum + (0.3 / near) * middle + (0.5 / near) * with;
  const double from_home = length(bird.position);
  if (from_home > kHome_m) sum = sum - ((from_home - kHome_m) / from_home) * bird.position;
  return sum;
}

void fly(std::vector<Bird>& birds, double step_s) {
  std::vector<Vector> accelerations;
  for (const Bird& bird : birds) accelerations.push_back(acceleration(birds, bird));
  for (std::size_t i = 0; i < birds.size(); ++i) {
    Bird& bird = birds[i];
    bird.velocity = bird.velocity + step_s * accelerations[i];
    const double speed = std::max(length(bird.velocity), 1e-6);
    bird.velocity = (std::clamp(speed, kSpeedLeast, kSpeedMost) / speed) * bird.velocity;
    bird.position = bird.position + step_s * bird.velocity;
  }
}

// The turn of the cone's axis, +y, into the direction of flight.
void point(const Vector& velocity, double (&orientation)[4]) {
  const Vector d = (1.0 / length(velocity)) * velocity;
  const Vector turn = d[1] > -0.9999 ? Vector{d[2], 0.0, -d[0]} : Vector{1.0, 0.0, 0.0};
  const double w = d[1] > -0.9999 ? 1.0 + d[1] : 0.0;
  const double size = std::sqrt(w * w + turn[0] * turn[0] + turn[2] * turn[2]);
  orientation[0] = turn[0] / size, orientation[1] = 0.0, orientation[2] = turn[2] / size, orientation[3] = w / size;
}

std::vector<peerd_motion> motions_of(const std::vector<Bird>& birds) {
  std::vector<peerd_motion> motions(birds.size());
  for (std::size_t i = 0; i < birds.size(); ++i) {
    motions[i].object = birds[i].object;
    std::copy(birds[i].position.begin(), birds[i].position.end(), motions[i].pose.position);
    std::copy(birds[i].velocity.begin(), birds[i].velocity.end(), motions[i].velocity);
    point(birds[i].velocity, motions[i].pose.orientation);
  }
  return motions;
}

// The costs of the frames since the last line.
struct Cost {
  std::size_t frames = 0, late = 0;
  double flying_s = 0.0, moving_s = 0.0;
};

double seconds_since(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

void run(Peer& peer, std::vector<Bird>& birds, std::ostream& trace, double ends_after_s) {
  for (std::size_t i = 0; i < birds.size(); ++i) birds[i].object = peer.find(name_of(i)).value();
  Cost cost;
  double began = std::numeric_limits<double>::quiet_NaN(), last = began;
  for (auto next = Clock::now();;) {
    next += std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(kFrame_s));
    if (Clock::now() > next) {
      ++cost.late;
      next = Clock::now();  // a frame that is lost is lost; the flight goes by the session's time
    }
    do {
      if (!peer.poll(std::max(-seconds_since(next), 0.0))) return;
    } while (Clock::now() < next);
    const auto now = peer.session_time();
    if (!now) continue;
    if (std::isnan(began)) {
      began = last = *now;
      for (const Bird& bird : birds) peer.take(bird.object);
    }

    const auto flown = Clock::now();
    fly(birds, *now - last);
    last = *now;
    cost.flying_s += seconds_since(flown);
    const auto moved = Clock::now();
    const std::vector<peerd_motion> motions = motions_of(birds);
    const double at = peer.session_time().value();
    const std::size_t taken = peer.move(motions.data(), motions.size());
    cost.moving_s += seconds_since(moved);
    for (std::size_t i = 0; i < taken && trace; ++i) {
      trace << at << ' ' << i;
      for (const double number : motions[i].pose.position) trace << ' ' << number;
      for (const double number : motions[i].velocity) trace << ' ' << number;
      trace << '\n';
    }
    if (++cost.frames == 60) {
      std::cout << birds.size() << " birds: " << 1e3 * cost.flying_s / 60.0 << " ms a frame to fly, "
                << 1e3 * cost.moving_s / 60.0 << " ms to move them in peerd, " << cost.late << " frames late, "
                << peer.member_count() << " other peers" << std::endl;
      trace.flush();
      cost = {};
    }
    if (*now - began > ends_after_s) return;
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::cerr << "usage: swarm WORLD COUNT [NAME VALUE]..\n";
    return 2;
  }
  try {
    std::vector<Bird> birds = make_world(argv[1], std::strtoul(argv[2], nullptr, 10));
    Options options;
    options.set("world", argv[1]).set("name", "swarm").set("world-name", "swarm");
    for (std::size_t i = 0; i < birds.size(); ++i) options.set("own", name_of(i));
    std::ofstream trace;
    double ends_after_s = std::numeric_limits<double>::infinity();
    for (int i = 3; i + 1 < argc; i += 2) {
      const std::string name = argv[i];
      if (name == "trace") {
        trace.open(argv[i + 1]);
        trace << std::setprecision(17);
      } else if (name == "seconds") {
        ends_after_s = std::strtod(argv[i + 1], nullptr);
      } else {
        options.set(name, argv[i + 1]);
      }
    }
    if (!trace.is_open()) trace.setstate(std::ios::failbit);
    Peer peer(options);
    std::cout << std::setprecision(3);
    run(peer, birds, trace, ends_after_s);
  } catch (const std::exception& error) {
    std::cerr << "swarm: " << error.what() << '\n';
    return 1;
  }
}
