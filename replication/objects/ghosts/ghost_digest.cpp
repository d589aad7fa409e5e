#include "replication/objects/ghosts/ghost_digest.hpp"

#include <algorithm>
#include <array>

#include "core/mixed_bits.hpp"

namespace peerd::replication {
namespace {

constexpr double kPlace_per_m = 0x1p20, kOrientation_per_1 = 0x1p20;

// Odd numbers without a pattern, one for each component: those of the fraction of the golden ratio times 2^64, on and
// on mixed.
constexpr std::array<std::uint64_t, 7> kFactors = [] {
  std::array<std::uint64_t, 7> factors{};
  std::uint64_t bits = 0x9E37'79B9'7F4A'7C15;
  for (std::uint64_t& factor : factors) factor = (bits = mixed_bits(bits)) | 1;
  return factors;
}();

// Rounded half away from 0. A ghost may have gone on beyond all limits: then one number stands for all such places.
std::uint64_t whole(double value) {
  if (!(value > -0x1p62 && value < 0x1p62)) return std::uint64_t{1} << 63;
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(value < 0.0 ? value - 0.5 : value + 0.5));
}

std::uint64_t number_of(ObjectId object, const KinematicState& s) {
  const Vec3& p = s.position;
  const Quat& q = s.orientation;
  const double turn = q.w() < 0.0 ? -kOrientation_per_1 : kOrientation_per_1;  // two quaternions are one orientation
  const std::array<std::uint64_t, 7> steps{
      whole(p.x() * kPlace_per_m), whole(p.y() * kPlace_per_m), whole(p.z() * kPlace_per_m), whole(q.w() * turn),
      whole(q.x() * turn),         whole(q.y() * turn),         whole(q.z() * turn)};
  std::uint64_t bits = mixed_bits(object.packed() + 1);
  for (std::size_t k = 0; k < steps.size(); ++k) bits += kFactors[k] * steps[k];
  return mixed_bits(bits);
}

// 0 is left for nothing.
std::uint16_t folded(std::uint64_t sum) {
  if (sum == 0) return 0;
  const std::uint64_t bits = mixed_bits(sum);
  return static_cast<std::uint16_t>(1 + bits % 0xFFFF);
}

}  // namespace

std::size_t ghost_group(ObjectId object) { return mixed_bits(object.packed()) % kGhostGroups; }
std::size_t ghost_bucket(ObjectId object) { return mixed_bits(object.packed()) / kGhostGroups % kGhostBuckets; }

void GhostSums::add(ObjectId object, const KinematicState& state) {
  sums_[ghost_group(object)][ghost_bucket(object)] += number_of(object, state);
  ++objects_;
}

std::uint16_t GhostSums::of_group(std::size_t group) const {
  std::uint64_t sum = 0;
  for (const std::uint64_t bucket : sums_[group]) sum += bucket;
  return folded(sum);
}

std::array<std::uint16_t, kGhostGroups> GhostSums::groups() const {
  std::array<std::uint16_t, kGhostGroups> all;
  for (std::size_t group = 0; group < kGhostGroups; ++group) all[group] = of_group(group);
  return all;
}

std::array<std::uint16_t, kGhostBuckets> GhostSums::buckets_of(std::size_t group) const {
  std::array<std::uint16_t, kGhostBuckets> all;
  std::ranges::transform(sums_[group], all.begin(), folded);
  return all;
}

}  // namespace peerd::replication
