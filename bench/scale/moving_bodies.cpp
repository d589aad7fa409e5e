#include "bench/scale/moving_bodies.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <random>
#include <set>
#include <stdexcept>
#include <string>

#include "bench/wire_objects.hpp"
#include "core/scene/reader.hpp"

namespace peerd::bench {
namespace {

constexpr double kCubicMetresPerBody = 1000.0, kWander_m = 4.0;
constexpr std::size_t kInterestsPerBody = 10, kCompanionsIn = 100, kGroup = 2 * kInterestsPerBody + 1;

void append_mesh(std::string& text, const std::string& name, const collision::TriangleSoup& soup) {
  text += "geometry DEF " + name + " IndexedFaceSet { solid FALSE coord Coordinate { point [";
  for (const Vec3& v : soup.vertices) {
    for (int axis = 0; axis < 3; ++axis) text += ' ' + std::to_string(v[axis]);
    text += ',';
  }
  text += "] } coordIndex [";
  for (const auto& face : soup.faces) {
    for (const std::uint32_t corner : face.corners) text += ' ' + std::to_string(corner);
    text += " -1";
  }
  text += "] }";
}

Vec3 within(std::mt19937_64& rng, double radius_m) {
  for (;;) {
    const Vec3 v(draw(rng, -1.0, 1.0), draw(rng, -1.0, 1.0), draw(rng, -1.0, 1.0));
    if (v.norm() <= 1.0) return radius_m * v;
  }
}

// The instants at which legs begin: the first before 0, so that no two bodies change together.
std::vector<SimTime> turns(std::mt19937_64& rng, Duration lasts) {
  std::vector<SimTime> at{SimTime{} - from_seconds(draw(rng, 0.1, 1.0))};
  while (at.back() < SimTime{} + lasts) at.push_back(at.back() + from_seconds(draw(rng, 0.5, 1.5)));
  return at;
}

Legs legs_between(std::mt19937_64& rng, const std::vector<SimTime>& at, const std::vector<Vec3>& points) {
  assert(at.size() == points.size());
  std::vector<Legs::Leg> legs;
  KinematicState state;
  state.position = points.front();
  for (std::size_t i = 0; i + 1 < at.size(); ++i) {
    const double s = to_seconds(at[i + 1] - at[i]);
    state.velocity = (points[i + 1] - state.position) / s;
    state.angular_velocity_body = Vec3(0.0, draw(rng, -0.5, 0.5), 0.0);
    legs.push_back({at[i], state});
    state = replication::evaluate(legs.back().law, s);
  }
  return Legs(std::move(legs));
}

// `group` > 1: so many bodies have their homes in one cube.
std::vector<Legs> ways(std::mt19937_64& rng, std::size_t count, std::size_t companions, std::size_t group,
                       Duration lasts) {
  const auto anywhere = [&](std::size_t bodies) {
    const double half_m = 0.5 * std::cbrt(kCubicMetresPerBody * static_cast<double>(bodies));
    return Vec3(draw(rng, -half_m, half_m), draw(rng, -half_m, half_m), draw(rng, -half_m, half_m));
  };
  Vec3 middle = Vec3::Zero();
  std::vector<Legs> all;
  std::vector<SimTime> at;
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < count; ++i) {
    if (i < companions && i % 2 == 1) {
      for (Vec3& point : points) {
        const Vec3 aside = within(rng, 1.0);
        point += (2.0 + 2.0 * aside.norm()) * aside.normalized();
      }
    } else {
      if (group > 1 && i % group == 0) middle = anywhere(count);
      const Vec3 home = group > 1 ? Vec3(middle + anywhere(group)) : anywhere(count);
      at = turns(rng, lasts);
      points.clear();
      for (std::size_t k = 0; k < at.size(); ++k) points.push_back(home + within(rng, kWander_m));
    }
    all.push_back(legs_between(rng, at, points));
  }
  return all;
}

std::vector<std::pair<std::size_t, std::size_t>> drawn_pairs(std::mt19937_64& rng, std::size_t count,
                                                             std::size_t companions) {
  const std::size_t wanted = kInterestsPerBody * count;
  std::set<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 1; i < companions; i += 2) pairs.insert({i - 1, i});
  while (pairs.size() < wanted) {
    const std::size_t a = rng() % count, b = rng() % count;
    if (a != b) pairs.insert(std::minmax(a, b));
  }
  return {pairs.begin(), pairs.end()};
}

std::vector<std::pair<std::size_t, std::size_t>> group_pairs(std::size_t count) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t b = 0; b < count; ++b) {
    for (std::size_t a = b - b % kGroup; a < b; ++a) pairs.emplace_back(a, b);
  }
  return pairs;
}

}  // namespace

Legs::Legs(std::vector<Leg> legs) : legs_(std::move(legs)) { assert(!legs_.empty()); }

const Legs::Leg& Legs::at_time(SimTime t) const {
  const auto after = std::ranges::upper_bound(legs_, t, {}, &Leg::from);
  return after == legs_.begin() ? legs_.front() : *(after - 1);
}

KinematicState Legs::at(SimTime t) const {
  const Leg& leg = at_time(t);
  return replication::evaluate(leg.law, to_seconds(std::max(t, leg.from) - leg.from));
}

MovingBodies::MovingBodies(std::size_t count, std::span<const NamedSoup> meshes, Interests interests, Duration lasts) {
  std::mt19937_64 rng(count);
  const std::size_t companions = interests == Interests::kPairs ? 2 * (kInterestsPerBody * count / kCompanionsIn) : 0;
  legs = ways(rng, count, companions, interests == Interests::kGroups ? kGroup : 1, lasts);
  std::string text = "#VRML V2.0 utf8\n";
  for (std::size_t i = 0; i < count; ++i) {
    const NamedSoup& mesh = meshes[i % meshes.size()];
    const std::string name = "MESH" + std::to_string(i % meshes.size());
    const Vec3& at = legs[i].all().front().law.state.position;
    text += "DEF O" + std::to_string(i) + " Transform { translation " + std::to_string(at.x()) + ' ' +
            std::to_string(at.y()) + ' ' + std::to_string(at.z()) + " children Shape { ";
    if (i < meshes.size()) {
      append_mesh(text, name, mesh.soup);
    } else {
      text += "geometry USE " + name;
    }
    text += " } }\n";
  }
  ReadResult read = read_world(text);
  if (!read.scene) throw std::runtime_error("the generated world cannot be read");
  scene = std::move(*read.scene);
  first = scene.find("O0").value();
  stride = scene.at(first).subtree_end - first.number;
  const auto pairs = interests == Interests::kPairs ? drawn_pairs(rng, count, companions) : group_pairs(count);
  for (const auto& [a, b] : pairs) {
    CollisionInterest& interest = scene.interests.emplace_back();
    interest.colliders = {.ends = {object(a)}, .named = 1, .patterns = {}};
    interest.collidees = {.ends = {object(b)}, .named = 1, .patterns = {}};
    interest.type = CollisionType::kWitness;
  }
  model = replication::make_world_model(scene);
  if (!model->unsupported.empty()) throw std::runtime_error(model->unsupported.front());
}

}  // namespace peerd::bench
