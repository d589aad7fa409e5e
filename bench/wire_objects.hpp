#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <random>

#include "core/ids.hpp"
#include "core/kinematics.hpp"
#include "core/scene/scene.hpp"
#include "core/time.hpp"
#include "replication/peer/peer.hpp"
#include "replication/physics/world/world_model.hpp"
#include "replication/wire/wire.hpp"

// This header holds what the wire's benchmarks move, how they time it, and what they check.
namespace peerd::bench {

// The time is this thread's CPU time [s], so what else runs here doesn't count.
[[nodiscard]] double thread_s();

// The duration is this thread's CPU time to run f [s].
template <class F>
double seconds_of(const F& f) {
  const double begin = thread_s();
  f();
  return thread_s() - begin;
}

// Evenly between the two.
[[nodiscard]] double draw(std::mt19937_64& rng, double from, double to);

[[nodiscard]] bool same_bits(const KinematicState& a, const KinematicState& b);

// Whether the ghost is where the update says: but for the turn, which is normalised once more, to the last bit; pieces
// of laws that are cut may be off by kPieceError_m and kPieceError_rad.
[[nodiscard]] bool matches_update(const KinematicState& ghost, const replication::UpdateRecord& update, SimTime t);

// Objects without a shape or an interest, side by side in the file.
struct Crowd {
  explicit Crowd(std::size_t objects);
  [[nodiscard]] ObjectId object(std::size_t i) const { return ObjectId{first.number + static_cast<std::uint32_t>(i)}; }

  Scene scene;
  std::unique_ptr<const replication::WorldModel> model;
  ObjectId first;
};

// A peer that owns `count` objects of a file side by side, beginning with `first`.
[[nodiscard]] replication::PeerConfig config_of(std::uint32_t id, ObjectId first, std::size_t count,
                                                const replication::PublishPolicy& policy = {});

// Walks and drives: on each axis of the ground two waves of 5 to 60 s, at up to 12 m/s, looking where it goes.
class Path {
 public:
  explicit Path(std::mt19937_64& rng);
  [[nodiscard]] KinematicState at(SimTime time) const;

 private:
  struct Wave {
    double size_m = 0.0, rate = 0.0, phase = 0.0;
  };
  std::array<std::array<Wave, 2>, 2> waves_;
  Vec3 middle_;
};

}  // namespace peerd::bench
