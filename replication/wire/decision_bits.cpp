#include "replication/wire/decision_bits.hpp"

#include <array>
#include <bit>
#include <cassert>
#include <cmath>

#include "replication/wire/varint.hpp"
#include "replication/wire/vector_bits.hpp"
#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {
namespace {

constexpr int kRule_bits = 4;

std::array<std::uint64_t, 3> bits_of(const Vec3& v) {
  return std::bit_cast<std::array<std::uint64_t, 3>>(std::array{v.x(), v.y(), v.z()});
}
std::array<std::uint64_t, 4> bits_of(const Quat& q) {
  return std::bit_cast<std::array<std::uint64_t, 4>>(std::array{q.w(), q.x(), q.y(), q.z()});
}

// A mask says which components are not zero.
void put_all(BitWriter& out, const Quat& q) {
  const std::array bits = bits_of(q);
  for (const std::uint64_t component : bits) out.put(component != 0 ? 1 : 0, 1);
  for (const std::uint64_t component : bits) {
    if (component != 0) put_exact(out, std::bit_cast<double>(component));
  }
}
bool take_all(BitReader& in, Quat& q) {
  std::array<bool, 4> present{};
  for (bool& there : present) there = in.get(1) != 0;
  std::array<double, 4> components{};
  for (std::size_t i = 0; i < 4; ++i) {
    if (present[i] && std::bit_cast<std::uint64_t>(components[i] = take_exact(in)) == 0) return false;
  }
  q = Quat(components[0], components[1], components[2], components[3]);
  return true;
}
void put_all(BitWriter& out, const Vec3& v) { put_exact(out, v); }
bool take_all(BitReader& in, Vec3& v) {
  v.setZero();
  return take_exact(in, v);
}

// A bit 0 means that the value is unchanged; a bit 1 is followed by all of it, if any of its bits differs.
template <class T>
void put_change(BitWriter& out, const T& was, const T& is) {
  const bool changed = bits_of(was) != bits_of(is);
  out.put(changed ? 1 : 0, 1);
  if (changed) put_all(out, is);
}
template <class T>
bool take_change(BitReader& in, const T& was, T& is) {
  is = was;
  return in.get(1) == 0 || (take_all(in, is) && bits_of(was) != bits_of(is));
}

void put_change(BitWriter& out, const KinematicState& was, const KinematicState& is) {
  put_change(out, was.position, is.position);
  put_change(out, was.velocity, is.velocity);
  put_change(out, was.acceleration, is.acceleration);
  put_change(out, was.orientation, is.orientation);
  put_change(out, was.angular_velocity_body, is.angular_velocity_body);
}
bool take_change(BitReader& in, const KinematicState& was, KinematicState& is) {
  return take_change(in, was.position, is.position) && take_change(in, was.velocity, is.velocity) &&
         take_change(in, was.acceleration, is.acceleration) && take_change(in, was.orientation, is.orientation) &&
         take_change(in, was.angular_velocity_body, is.angular_velocity_body) && acceptable(is);
}

// A free acceleration, as a change of that before the contact.
void put_free(BitWriter& out, const KinematicState& before, const std::optional<Vec3>& free) {
  assert(!free || bits_of(*free) != bits_of(before.acceleration));
  put_change(out, before.acceleration, free.value_or(before.acceleration));
}
bool take_free(BitReader& in, const KinematicState& before, std::optional<Vec3>& free) {
  if (in.get(1) == 0) return true;
  Vec3& is = free.emplace();
  return take_all(in, is) && bits_of(is) != bits_of(before.acceleration) && acceptable(is);
}
bool take_rest(BitReader& in, DecisionRecord& d) {
  d.rests = in.get(1) != 0;
  return !d.rests ||
         (take_free(in, d.collider_before, d.collider_free) && take_free(in, d.collidee_before, d.collidee_free));
}

bool take(BitReader& in, SimTime near, DecisionRecord& d) {
  if (!take_low_time(in.get(kLowTime_bits), near, d.contact)) return false;
  if (!take_object(in, d.collider) || !take_object(in, d.collidee)) return false;
  if (d.collider == d.collidee) return false;
  const std::uint64_t rule = in.get(kRule_bits);
  if (rule < static_cast<std::uint64_t>(DecisionRule::kId) || rule > static_cast<std::uint64_t>(DecisionRule::kServer))
    return false;
  d.rule = static_cast<DecisionRule>(rule);
  if (in.get(1) != 0 && (!take_time(in, d.contact, d.known) || d.known == SimTime{})) return false;
  if (!take_exact(in, d.normal) || !acceptable(d.normal) || std::abs(d.normal.norm() - 1.0) > kUnitSlack) return false;
  return take_change(in, KinematicState{}, d.collider_before) && take_change(in, d.collider_before, d.collider_after) &&
         take_change(in, KinematicState{}, d.collidee_before) && take_change(in, d.collidee_before, d.collidee_after) &&
         take_rest(in, d) && in.good() && in.padded_with_zeros();
}

}  // namespace

std::size_t encode_decision(const DecisionRecord& d, std::span<std::byte, kDecisionMax_bytes> bytes) {
  BitWriter out(bytes);
  out.put(low_time(d.contact), kLowTime_bits);
  put_object(out, d.collider);
  put_object(out, d.collidee);
  out.put(static_cast<std::uint64_t>(d.rule), kRule_bits);
  const bool has_previous = d.known != SimTime{};
  out.put(has_previous ? 1 : 0, 1);
  if (has_previous) put_time(out, d.contact, d.known);
  put_exact(out, d.normal);
  put_change(out, KinematicState{}, d.collider_before);
  put_change(out, d.collider_before, d.collider_after);
  put_change(out, KinematicState{}, d.collidee_before);
  put_change(out, d.collidee_before, d.collidee_after);
  out.put(d.rests ? 1 : 0, 1);
  if (d.rests) {
    put_free(out, d.collider_before, d.collider_free);
    put_free(out, d.collidee_before, d.collidee_free);
  }
  return out.finish();
}

std::optional<DecisionRecord> decode_decision(std::span<const std::byte>& rest, SimTime near) {
  BitReader in(rest);
  DecisionRecord decision;
  if (!take(in, near, decision)) return std::nullopt;
  assert(in.size_bytes() <= rest.size());
  rest = rest.subspan(in.size_bytes());
  return decision;
}

}  // namespace peerd::replication
