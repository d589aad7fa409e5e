#include "peerd/lab/baselines/snapshot.hpp"

namespace peerd::baselines {
namespace {

using replication::BitReader;
using replication::BitWriter;

constexpr unsigned kPosition = 1, kVelocity = 2, kOrientation = 4;  // what has changed

// Differences wrap around, so that every difference has a form.
void put_difference(BitWriter& out, const Steps& from, const Steps& to) {
  for (std::size_t i = 0; i < 3; ++i) {
    put_signed(out, static_cast<std::int32_t>(static_cast<std::uint32_t>(to[i]) - static_cast<std::uint32_t>(from[i])));
  }
}
bool take_difference(BitReader& in, Steps& value) {
  for (std::int32_t& v : value) {
    std::int32_t difference = 0;
    if (!take_signed(in, difference)) return false;
    v = static_cast<std::int32_t>(static_cast<std::uint32_t>(v) + static_cast<std::uint32_t>(difference));
  }
  return true;
}

void put_orientation(BitWriter& out, const replication::SmallestThree& q) {
  out.put(static_cast<std::uint64_t>(q.largest), 2);
  for (const std::int32_t step : q.steps) {
    const std::uint64_t above_least = static_cast<std::uint32_t>(step + replication::SmallestThree::kMost);
    out.put(above_least, replication::SmallestThree::kMagnitude_bits + 1);
  }
  out.put(0, 7);  // so that what follows begins with a byte
}
bool take_orientation(BitReader& in, replication::SmallestThree& q) {
  q.largest = static_cast<int>(in.get(2));
  for (std::int32_t& step : q.steps) {
    step = static_cast<std::int32_t>(in.get(replication::SmallestThree::kMagnitude_bits + 1)) -
           replication::SmallestThree::kMost;
  }
  return in.get(7) == 0 && replication::to_orientation(q).has_value();
}

}  // namespace

SnapshotState snapshot_of(const KinematicState& state) {
  return {in_steps(state.position, kPositionStep_m), in_steps(state.velocity, kVelocityStep_m_s),
          replication::smallest_three(state.orientation)};
}

KinematicState state_of(const SnapshotState& snapshot) {
  KinematicState state;
  state.position = from_steps(snapshot.position, kPositionStep_m);
  state.velocity = from_steps(snapshot.velocity, kVelocityStep_m_s);
  state.orientation = *replication::to_orientation(snapshot.orientation);
  return state;
}

std::vector<std::uint32_t> put_changes(BitWriter& out, const Block& base, const Block& now) {
  std::vector<std::uint32_t> changed;
  for (std::uint32_t i = 0; i < now.size(); ++i) {
    if (base[i] != now[i]) changed.push_back(i);
  }
  replication::put_varint(out, changed.size());
  for (const std::uint32_t i : changed) {
    const SnapshotState &before = base[i], &after = now[i];
    const unsigned what = (before.position != after.position ? kPosition : 0u) |
                          (before.velocity != after.velocity ? kVelocity : 0u) |
                          (before.orientation != after.orientation ? kOrientation : 0u);
    out.put(i, 8);
    out.put(what, 8);
    if ((what & kPosition) != 0) put_difference(out, before.position, after.position);
    if ((what & kVelocity) != 0) put_difference(out, before.velocity, after.velocity);
    if ((what & kOrientation) != 0) put_orientation(out, after.orientation);
  }
  return changed;
}

bool take_changes(BitReader& in, Block& block) {
  std::uint32_t count = 0;
  if (!replication::take_varint(in, count) || count > block.size()) return false;
  for (std::uint32_t n = 0; n < count; ++n) {
    const std::uint64_t i = in.get(8), what = in.get(8);
    if (i >= block.size()) return false;
    if ((what & kPosition) != 0 && !take_difference(in, block[i].position)) return false;
    if ((what & kVelocity) != 0 && !take_difference(in, block[i].velocity)) return false;
    if ((what & kOrientation) != 0 && !take_orientation(in, block[i].orientation)) return false;
  }
  return true;
}

}  // namespace peerd::baselines
