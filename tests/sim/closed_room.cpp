#include "tests/sim/closed_room.hpp"

#include <array>
#include <cmath>
#include <span>
#include <sstream>
#include <vector>

#include "tests/sim/chance.hpp"

namespace peerd::sim::testing_support {
namespace {

std::string three(double x, double y, double z) {
  std::ostringstream text;
  text.precision(17);
  text << x << ' ' << y << ' ' << z;
  return text.str();
}

std::string shape(Chance& chance) {
  std::ostringstream text;
  text.precision(17);
  const double r = chance.between(0.1, 0.35), h = chance.between(0.1, 0.35);
  switch (chance.below(5)) {
    case 0:
      text << "Sphere { radius " << r << " }";
      break;
    case 1:
      text << "Box { size " << three(2.0 * r / std::sqrt(3.0), h, r) << " }";
      break;
    case 2:
      text << "Cone { bottomRadius " << 0.7 * r << " height " << h << " }";
      break;
    case 3:
      text << "Cylinder { radius " << 0.7 * r << " height " << h << " }";
      break;
    default: {  // a prism over an L: not convex
      const std::array<std::array<double, 2>, 6> outline{{{-1, -1}, {1, -1}, {1, 0}, {0, 0}, {0, 1}, {-1, 1}}};
      text << "IndexedFaceSet { convex FALSE coord Coordinate { point [";
      for (const double z : {-0.5, 0.5}) {
        for (const auto& [x, y] : outline) text << three(0.6 * r * x, 0.6 * r * y, 0.6 * r * z) << ", ";
      }
      text << "] } coordIndex [5 4 3 2 1 0 -1, 6 7 8 9 10 11 -1";
      for (int i = 0; i < 6; ++i) {
        const int next = (i + 1) % 6;
        text << ", " << i << ' ' << next << ' ' << next + 6 << ' ' << i + 6 << " -1";
      }
      text << "] }";
    }
  }
  return text.str();
}

std::string response(Chance& chance) {
  std::ostringstream text;
  const std::size_t type = chance.one_of<std::size_t>({0, 0, 1, 2, 2, 2, 2, 2, 2, 2});
  text << "CollisionResponse { responseType " << type;
  if (type == 2) {
    text << " mass " << chance.one_of({1.0, 1.0, 5.0, 100.0, 1e5}) << " restitution "
         << chance.one_of({0.0, 0.5, 0.9, 1.0, 1.0}) << " friction " << chance.one_of({0.0, 0.0, 0.3, 2.0});
  }
  return text.str() + " }";
}

std::string walls() {
  std::ostringstream text;
  const double at = kRoomHalf_m + 0.5, width = 2.0 * kRoomHalf_m + 2.0;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {-1, 1}) {
      std::array<double, 3> centre{}, size{width, width, width};
      centre[std::size_t(axis)] = side * at;
      size[std::size_t(axis)] = 1.0;
      text << "DEF W" << axis << (side < 0 ? 'm' : 'p') << " Transform { translation "
           << three(centre[0], centre[1], centre[2]) << " children Shape { geometry Box { size "
           << three(size[0], size[1], size[2]) << " } } }\n";
    }
  }
  return text.str();
}

// The places of bodies: a grid on which none touches another, shuffled.
std::vector<std::array<double, 3>> places(Chance& chance) {
  std::vector<std::array<double, 3>> all;
  for (const double x : {-2.0, 0.0, 2.0}) {
    for (const double y : {-2.0, 0.0, 2.0}) {
      for (const double z : {-2.0, 0.0, 2.0}) all.push_back({x, y, z});
    }
  }
  for (std::size_t i = all.size() - 1; i > 0; --i) std::swap(all[i], all[chance.below(i + 1)]);
  return all;
}

void add_bodies(Chance& chance, std::size_t count, std::ostream& world) {
  const auto place = places(chance);
  const double speed = chance.one_of({1.0, 10.0, 10.0, 40.0});
  const int type = chance.happens(0.8) ? 1 : 2;
  for (std::size_t i = 0; i < count; ++i) {
    const auto any = [&] { return chance.between(-speed, speed); };
    const double vx = any(), vy = any(), vz = any();
    world << "DEF O" << i << " Transform { translation " << three(place[i][0], place[i][1], place[i][2])
          << " distanceThreshold 0.01 velocityVector " << three(vx, vy, vz) << " collisionResponse "
          << response(chance);
    if (chance.happens(0.4)) {
      const double a = chance.between(0.6, 1.2), b = chance.between(0.6, 1.2), c = chance.between(0.6, 1.2);
      world << " scale " << three(a, b, c);
    }
    if (chance.happens(0.4)) {
      const double x = chance.between(-1, 1), z = chance.between(-1, 1), angle = chance.between(0, 6.28);
      world << " rotation " << three(x, 1.0, z) << ' ' << angle;
    }
    world << " children Shape { geometry " << shape(chance) << " } }\n";
  }
  for (std::size_t i = 0; i < count; ++i) {
    world << "CollisionInterest { collisionType " << type << " objectPath \"O" << i << "\" interests [";
    for (std::size_t k = 0; k < count; ++k) {
      if (k != i && chance.happens(0.9)) world << "\"O" << k << "\" ";
    }
    world << R"("W0m" "W0p" "W1m" "W1p" "W2m" "W2p"] })" << '\n';
  }
}

const std::array<std::string, 5> kPolicies{"id", "velocity", "field-of-view", "expected-error", "server"};

// What happens to the network and the peers on the way. Returns whether anything does.
bool add_events(Chance& chance, std::size_t peers, double duration_s, std::ostream& toml) {
  if (chance.happens(0.5)) return false;
  const auto name = [](std::size_t peer) { return std::string(1, static_cast<char>('a' + peer)); };
  const std::size_t count = 1 + chance.below(3);
  double at_s = chance.between(0.5, 2.0);
  for (std::size_t i = 0; i < count; ++i) {
    const auto event = [&](const char* half, const std::string& kind) -> std::ostream& {
      return toml << "[event.e" << i << half << "]\nat_s = " << at_s << "\nkind = \"" << kind << "\"\n";
    };
    const std::size_t kind = peers > 1 ? chance.below(4) : 0;
    if (kind == 0) {
      event("", "network") << "latency_ms = " << chance.one_of({0, 20, 100, 500, 800}) << '\n';
    } else if (kind == 1) {
      event("a", "partition") << "groups = [[\"" << name(chance.below(peers)) << "\"]]\n";
      at_s += chance.between(0.3, 3.0);
      event("b", "heal");
    } else {
      const std::string peer = name(chance.below(peers));
      event("a", kind == 2 ? "kill" : "leave") << "peer = \"" << peer << "\"\n";
      at_s += chance.between(0.3, 3.0);
      event("b", "join") << "peer = \"" << peer << "\"\n";
    }
    at_s += chance.between(0.3, 2.0);
    if (at_s > duration_s - 4.0) break;
  }
  return true;
}

}  // namespace

ClosedRoom make_closed_room(std::uint64_t seed) {
  Chance chance(seed);
  std::ostringstream world, toml;
  world.precision(17);
  const std::size_t bodies = 2 + chance.below(9);
  world << "#VRML V2.0 utf8\n" << walls();
  add_bodies(chance, bodies, world);

  const double duration_s = 14.0;
  const std::size_t peers = 1 + chance.below(5);
  const int latency_ms = chance.one_of({0, 0, 5, 50, 100, 300, 500, 800});
  const bool calm = chance.happens(0.4);
  toml << "world = \"room.wrl\"\nduration_s = " << duration_s << "\nsample_hz = 60\nseed = " << seed % 100'000
       << "\n[replication]\ntick_hz = " << chance.one_of({20, 33, 60}) << "\n[decisions]\npolicy = \""
       << kPolicies[chance.below(kPolicies.size())] << "\"\nserver = \"a\"\n[network]\nlatency_ms = " << latency_ms
       << '\n';
  if (!calm) {
    toml << "jitter_ms = " << chance.one_of({0, 10, 60}) << "\nloss = " << chance.one_of({0.0, 0.05, 0.2, 0.5})
         << "\nduplication = " << chance.one_of({0.0, 0.1}) << "\nreordering = " << chance.one_of({0.0, 0.1}) << '\n';
  }
  std::vector<std::string> owns(peers);
  std::vector<double> gravity;
  for (std::size_t i = 0; i < bodies; ++i) {
    std::string& list = owns[chance.below(peers)];
    list += (list.empty() ? "\"O" : ", \"O") + std::to_string(i) + '"';
    gravity.push_back(chance.happens(0.5) ? chance.one_of({-1.0, -9.81}) : 0.0);
    const double spin = chance.happens(0.3) ? chance.one_of({1.0, 10.0, 55.0}) : 0.0;  // 95 rad/s at most
    if (gravity.back() == 0.0 && spin == 0.0) continue;
    toml << "[motion.O" << i << "]\nphysics = { acceleration = [0, " << gravity.back() << ", 0]";
    if (spin != 0.0) {
      const double x = chance.between(-spin, spin), y = chance.between(-spin, spin), z = chance.between(-spin, spin);
      toml << ", angular_velocity = [" << x << ", " << y << ", " << z << ']';
    }
    toml << " }\n";
  }
  std::size_t owners = 0;
  for (std::size_t p = 0; p < peers; ++p) {
    owners += !owns[p].empty();
    toml << "[peer." << static_cast<char>('a' + p) << "]\nid = " << p + 1 << "\nowns = [" << owns[p] << "]\n";
  }
  const bool changes = add_events(chance, peers, duration_s, toml);
  return {world.str(), toml.str(), gravity, !changes && owners == 1, calm && !changes};
}

}  // namespace peerd::sim::testing_support
