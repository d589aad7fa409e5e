#include "bench/scale/standing_world.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>

#include "bench/own_process.hpp"
#include "bench/wire_objects.hpp"
#include "core/scene/reader.hpp"
#include "replication/peer/peer.hpp"

namespace peerd::bench {
namespace {

using namespace replication;
using namespace std::chrono_literals;

constexpr std::size_t kMovers = 100, kNear = 10;

Vec3 home_of(std::size_t mover) { return {20.0 * static_cast<double>(mover), 0.0, 0.0}; }

std::string transform(const std::string& name, const Vec3& at, const char* geometry) {
  return "DEF " + name + " Transform { translation " + std::to_string(at.x()) + ' ' + std::to_string(at.y()) + ' ' +
         std::to_string(at.z()) + " children Shape { geometry " + geometry + " } }\n";
}

// The bodies that move stand first; then for each of them ten nodes near its way; then all others, in groups of a
// hundred.
std::string world_text(std::size_t nodes, Named named) {
  std::mt19937_64 rng(7);
  std::string text = "#VRML V2.0 utf8\n";
  for (std::size_t i = 0; i < kMovers; ++i) {
    text += transform("M" + std::to_string(i), home_of(i), i == 0 ? "DEF BOX Box { size 1 1 1 }" : "USE BOX");
  }
  const std::size_t standing = nodes - kMovers;
  for (std::size_t k = 0; k < standing; ++k) {
    const std::size_t mover = k % kMovers;
    if (k < kMovers * kNear) {
      const Vec3 at = home_of(mover) + Vec3(draw(rng, -6, 6), draw(rng, -1, 1), draw(rng, -6, 6));
      text += transform("S" + std::to_string(k), at, "USE BOX");
      continue;
    }
    if (k % kMovers == 0) text += "DEF G" + std::to_string(k) + " Group { children [\n";
    const Vec3 at(draw(rng, -2000, 2000), draw(rng, 100, 200), draw(rng, -2000, 2000));
    text += transform("S" + std::to_string(k), at, "USE BOX");
    if (k % kMovers == kMovers - 1 || k + 1 == standing) text += "] }\n";
  }
  const std::size_t ends = named == Named::kAll ? standing : std::min(standing, kMovers * kNear);
  for (std::size_t i = 0; i < kMovers; ++i) {
    text += "CollisionInterest { objectPath \"M" + std::to_string(i) + "\" collisionType 1 interests [";
    for (std::size_t k = i; k < ends; k += kMovers) {
      const std::string group = k < kMovers * kNear ? "" : "G" + std::to_string(k - k % kMovers) + "/";
      text += " \"" + group + "S" + std::to_string(k) + '"';
    }
    text += "] }\n";
  }
  return text;
}

KinematicState way_of(std::size_t mover, SimTime t) {
  const double phase = 0.5 * to_seconds(t - SimTime{}) + static_cast<double>(mover), rate = 0.5, size_m = 5.0;
  KinematicState s;
  s.position = home_of(mover) + Vec3(size_m * std::cos(phase), 0.0, size_m * std::sin(phase));
  s.velocity = size_m * rate * Vec3(-std::sin(phase), 0.0, std::cos(phase));
  s.acceleration = rate * rate * (home_of(mover) - s.position);
  return s;
}

void drain(Peer& peer) {
  while (peer.poll_output()) {
  }
}

StandingCost measure_here(std::size_t nodes, Named named, bool moves, std::size_t ticks) {
  assert(nodes >= kMovers);
  StandingCost cost;
  const std::string text = world_text(nodes, named);
  ReadResult read;
  cost.read_s = seconds_of([&] { read = read_world(text); });
  if (!read.scene || !read.diagnostics.empty()) throw std::runtime_error("the generated world has problems");
  const Scene& scene = *read.scene;
  const ObjectId first = scene.find("M0").value();
  const std::uint32_t stride = scene.at(first).subtree_end - first.number;
  const auto object = [&](std::size_t i) { return ObjectId{first.number + stride * static_cast<std::uint32_t>(i)}; };
  PeerConfig config;
  config.world_hash = 1;
  std::vector<ObjectId> owned;
  for (std::size_t i = 0; i < kMovers; ++i) {
    owned.push_back(object(i));
    config.owned.push_back({object(i), moves, {}});
  }
  std::unique_ptr<const WorldModel> model;
  cost.model_s = seconds_of([&] { model = make_world_model(scene, owned); });
  std::unique_ptr<Peer> peer;
  HostTime now{};
  const auto tick = [&] {
    std::vector<OwnSample> samples;
    if (const auto due = peer->due_tick(now); due && moves) {
      for (std::size_t i = 0; i < kMovers; ++i) samples.push_back({object(i), way_of(i, *due), true});
    }
    return seconds_of([&] {
      peer->on_tick(now, samples);
      drain(*peer);
    });
  };
  cost.enter_s = seconds_of([&] {
    peer = std::make_unique<Peer>(std::move(config), *model);
    while (peer->counters().ticks == 0) {
      now = std::max(now, peer->next_deadline());
      tick();
    }
  });
  const auto one = [&] {
    for (const std::uint64_t before = peer->counters().ticks; peer->counters().ticks == before;) {
      now = std::max(now, peer->next_deadline());
      if (const double s = tick(); peer->counters().ticks > before) return s;
    }
    return 0.0;
  };
  for (int warm = 0; warm < 90 && ticks > 0; ++warm) one();
  const MotionWorld::Counters motion = peer->motion_counters();
  const std::uint64_t looked_at = peer->counters().objects_looked_at;
  std::vector<double> seconds;
  for (std::size_t i = 0; i < ticks; ++i) seconds.push_back(one());
  std::ranges::sort(seconds);
  if (!seconds.empty()) cost.tick_s = seconds[seconds.size() / 2];
  cost.searches = peer->motion_counters().contact_searches - motion.contact_searches;
  cost.checks = peer->motion_counters().searches_far - motion.searches_far + cost.searches;
  cost.objects_checked = peer->counters().objects_looked_at - looked_at;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  cost.memory_mb = static_cast<double>(usage.ru_maxrss) / 1024.0;
  return cost;
}

}  // namespace

StandingCost measure_standing(std::size_t nodes, Named named, bool moves, std::size_t ticks) {
  return in_own_process("standing", [&] { return measure_here(nodes, named, moves, ticks); });
}

}  // namespace peerd::bench
