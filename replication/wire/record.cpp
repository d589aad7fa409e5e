#include "replication/wire/record.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>

#include "replication/wire/smallest_three.hpp"
#include "replication/wire/varint.hpp"
#include "replication/wire/vector_bits.hpp"
#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {
namespace {

constexpr int kKind_bits = 4, kStep_bits = 4;
constexpr std::uint64_t kExact = 15;       // in the step's field, which codes -23 to -9 by 0 to 14
constexpr std::uint64_t kUnknownKind = 8;  // a kind of a later version
constexpr std::uint64_t kCarried = 8;      // is added to the kind of a model in the frame of a carrier
static_assert(kStepMost_log2 - kStepLeast_log2 < static_cast<int>(kExact));
static_assert(kUnknownKind == std::size(kMotionKinds) + 1 && kCarried + std::size(kMotionKinds) < 1 << kKind_bits);

// The field of a vector begins with the number of bits of its longest component, in so many bits.
constexpr int kLongWidth_bits = 6, kWidth_bits = 5;
constexpr int kComponentMax_bits = 52;  // binary64 represents whole numbers of so many bits

bool is_zero_vector(const Vec3& v) { return v.isZero(0.0); }
bool has_acceleration(MotionKind kind) { return kind != MotionKind::kFirst; }
bool has_jerk(MotionKind kind) { return kind == MotionKind::kThird || kind == MotionKind::kOscillating; }
bool has_rate(MotionKind kind) { return kind == MotionKind::kTurning || kind == MotionKind::kOscillating; }

// The axes that a vector may have: none means any, and the vector has a mask of its own; else those of an object that
// moves level or turns upright.
using Axes = std::optional<unsigned>;
constexpr unsigned kAlong_y = 0b010, kAlong_xz = 0b101;

bool within(unsigned axes, const Vec3& v) {
  for (int i = 0; i < 3; ++i) {
    if ((axes >> i & 1) == 0 && v[i] != 0.0) return false;
  }
  return true;
}

unsigned rate_axes(MotionKind kind) { return kind == MotionKind::kTurning ? kAlong_y : kAlong_xz; }

// Whether the motion is in a horizontal plane, as of most objects that walk or drive.
bool is_level(const MotionModel& m) {
  return within(kAlong_xz, m.state.velocity) && within(kAlong_xz, m.state.acceleration) && within(kAlong_xz, m.jerk) &&
         within(rate_axes(m.kind), m.rate_rad_s);
}

// Whether the object is turned about the vertical alone, and turns about it.
bool is_upright(const MotionModel& m) {
  return m.state.orientation.x() == 0.0 && m.state.orientation.z() == 0.0 &&
         within(kAlong_y, m.state.angular_velocity_body) && within(kAlong_y, m.angular_acceleration_body);
}

double power_of_two(int exponent) {
  assert(exponent > -1023 && exponent < 1024);
  return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52);
}

// ---- steps, as exponents of two: all products and quotients by them are exact ----

struct Steps {
  int position, velocity, acceleration, jerk;
  int spin, spin_acceleration;
};

// With h the horizon: v h, a h^2 / 2 and j h^3 / 6 are each off by at most one step of the position, per axis. The
// orientation likewise by half a step of 2^-10 rad: 0.028 degrees per axis, 0.0485 in all.
Steps steps_of(MotionKind kind, int position_log2) {
  const int h = horizon_log2_s(kind);
  return {position_log2, position_log2 + 1 - h, position_log2 + 2 - 2 * h, position_log2 + 3 - 3 * h, -10 - h,
          -9 - 2 * h};
}

// The number of bits of the longest component, in steps. Each component is a whole number of steps.
int width_of(const Vec3& v, int step_log2) {
  const double most = v.cwiseAbs().maxCoeff() * power_of_two(-step_log2);
  return static_cast<int>(std::bit_width(static_cast<std::uint64_t>(most)));
}

// The log2 of the step of a rate. A rate that is off by d moves an axis by at most d (|a| h^3 / 6 + |j| h^4 / 24);
// about an axis, with vectors for d and a, by |d| |a| h^3 / 6. Below, |a| < 2^A and |j| < 2^J on each axis, and d is
// half a step (of a vector: sqrt(3) halves). None: without acceleration and jerk the rate moves nothing.
std::optional<int> rate_step_log2(const MotionModel& m, const Steps& steps) {
  const int a = width_of(m.state.acceleration, steps.acceleration), j = width_of(m.jerk, steps.jerk);
  if (a == 0 && j == 0) return std::nullopt;
  const int h = horizon_log2_s(m.kind);
  const int by_a = a + steps.acceleration + 3 * h, by_j = j + steps.jerk + 4 * h - 2;
  return steps.position + 2 - (j == 0 ? by_a : a == 0 ? by_j : std::max(by_a, by_j));
}

// ---- rounding ----

// Rounds a vector to steps; false where it does not fit its field.
bool round_to_steps(Vec3& v, int step_log2, int width_bits) {
  if (is_zero_vector(v)) {  // most vectors are zero
    v.setZero();
    return true;
  }
  const double per_step = power_of_two(-step_log2), step = power_of_two(step_log2);
  const double most = power_of_two(std::min((1 << width_bits) - 1, kComponentMax_bits));
  for (double& component : v) {
    const double n = std::nearbyint(component * per_step);
    if (!(std::abs(n) < most)) return false;
    component = n * step + 0.0;  // adding 0 removes -0, which has no bits of its own
  }
  return true;
}

bool round_to_steps(MotionModel& m, int position_log2) {
  const Steps steps = steps_of(m.kind, position_log2);
  KinematicState& s = m.state;
  if (!round_to_steps(s.position, steps.position, kLongWidth_bits) ||
      !round_to_steps(s.velocity, steps.velocity, kWidth_bits) ||
      !round_to_steps(s.acceleration, steps.acceleration, kWidth_bits) ||
      !round_to_steps(m.jerk, steps.jerk, kWidth_bits) ||
      !round_to_steps(s.angular_velocity_body, steps.spin, kWidth_bits) ||
      !round_to_steps(m.angular_acceleration_body, steps.spin_acceleration, kWidth_bits)) {
    return false;
  }
  s.orientation = is_identity(s.orientation) ? Quat::Identity() : to_orientation(smallest_three(s.orientation)).value();
  if (m.kind == MotionKind::kSliding) {  // a speed that rounds to zero counts as stopped
    if (is_zero_vector(s.velocity)) s.acceleration.setZero();
    if (is_zero_vector(s.angular_velocity_body)) m.angular_acceleration_body.setZero();
  }
  if (!has_rate(m.kind)) return true;
  const auto rate_log2 = rate_step_log2(m, steps);
  if (rate_log2) return round_to_steps(m.rate_rad_s, *rate_log2, kLongWidth_bits);
  m.rate_rad_s.setZero();
  return true;
}

bool rounds_to_first(const MotionModel& m, int position_log2) {
  if (m.kind != MotionKind::kSecond && m.kind != MotionKind::kHistory) return false;
  const double half_a_step = 0.5 * power_of_two(steps_of(m.kind, position_log2).acceleration);
  return m.state.acceleration.cwiseAbs().maxCoeff() <= half_a_step;
}

// Whether friction stops the rounded motion as it stops the exact one: friction that no longer points against the
// motion would stop it at once, and no friction would never.
bool brakes_alike(const Vec3& v, const Vec3& friction, const Vec3& v_rounded, const Vec3& friction_rounded) {
  return is_zero_vector(v_rounded) || ((v.dot(friction) < 0.0) == (v_rounded.dot(friction_rounded) < 0.0) &&
                                       is_zero_vector(friction) == is_zero_vector(friction_rounded));
}
bool stops_alike(const MotionModel& a, const MotionModel& b) {
  const KinematicState &s = a.state, &r = b.state;
  return a.kind != MotionKind::kSliding || (brakes_alike(s.velocity, s.acceleration, r.velocity, r.acceleration) &&
                                            brakes_alike(s.angular_velocity_body, a.angular_acceleration_body,
                                                         r.angular_velocity_body, b.angular_acceleration_body));
}

// Removes the signs of zeros: a component that is absent on the wire has no sign.
void drop_signs_of_zero(MotionModel& m) {
  for (Vec3* v : {&m.state.position, &m.state.velocity, &m.state.acceleration, &m.state.angular_velocity_body, &m.jerk,
                  &m.rate_rad_s, &m.angular_acceleration_body}) {
    if (is_zero_vector(*v)) v->setZero();
  }
  if (is_identity(m.state.orientation)) m.state.orientation = Quat::Identity();
}

// ---- to bits ----

// The axes that the vectors of a record have.
struct Form {
  Axes moves, rate, turns;
};
Form form_of(MotionKind kind, bool level, bool upright) {
  Form form;
  if (level) form.moves = kAlong_xz, form.rate = rate_axes(kind);
  if (upright) form.turns = kAlong_y;
  return form;
}

void put_sign_and_magnitude(BitWriter& out, std::int64_t n, int magnitude_bits) {
  out.put((static_cast<std::uint64_t>(std::abs(n)) << 1) | (n < 0 ? 1 : 0), magnitude_bits + 1);
}

void put_steps(BitWriter& out, const Vec3& v, int step_log2, int width_bits, Axes axes = {}) {
  const double per_step = power_of_two(-step_log2);
  std::array<std::int64_t, 3> n{};
  std::uint64_t all = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    n[i] = static_cast<std::int64_t>(v[static_cast<Eigen::Index>(i)] * per_step);
    assert(static_cast<double>(n[i]) == v[static_cast<Eigen::Index>(i)] * per_step);
    all |= static_cast<std::uint64_t>(std::abs(n[i]));
  }
  const int width = static_cast<int>(std::bit_width(all));
  out.put(static_cast<std::uint64_t>(width), width_bits);
  if (width == 0) return;
  const unsigned mask = axes ? *axes : put_mask(out, n);
  for (std::size_t i = 0; i < 3; ++i) {
    if ((mask >> i & 1) != 0) put_sign_and_magnitude(out, n[i], width);
  }
}

// For an upright orientation w or y is the largest component, and of the other three this is the one that is not x or
// z.
constexpr int kLargestIs_y = 2;
std::int32_t& other_of_wy(SmallestThree& three) { return three.steps[three.largest == kLargestIs_y ? 0 : 1]; }

void put_orientation(BitWriter& out, const Quat& q, bool upright) {
  SmallestThree three = smallest_three(q);
  if (upright) {
    assert(three.largest == 0 || three.largest == kLargestIs_y);
    out.put(three.largest == kLargestIs_y ? 1 : 0, 1);
    put_sign_and_magnitude(out, other_of_wy(three), SmallestThree::kMagnitude_bits);
    return;
  }
  out.put(static_cast<std::uint64_t>(three.largest), 2);
  const unsigned mask = put_mask(out, three.steps);
  for (std::size_t i = 0; i < 3; ++i) {
    if ((mask >> i & 1) != 0) put_sign_and_magnitude(out, three.steps[i], SmallestThree::kMagnitude_bits);
  }
}

void put_exact(BitWriter& out, const MotionModel& m) {
  put_exact(out, m.state.position);
  put_exact(out, m.state.velocity);
  if (has_acceleration(m.kind)) put_exact(out, m.state.acceleration);
  if (has_jerk(m.kind)) put_exact(out, m.jerk);
  if (has_rate(m.kind)) put_exact(out, m.rate_rad_s);
  const Quat& q = m.state.orientation;
  if (!is_identity(q)) put_exact(out, q);
  put_exact(out, m.state.angular_velocity_body);
  if (!is_zero_vector(m.angular_acceleration_body)) put_exact(out, m.angular_acceleration_body);
}

void put_steps(BitWriter& out, const MotionModel& m, int position_log2, const Form& form) {
  const Steps steps = steps_of(m.kind, position_log2);
  put_steps(out, m.state.position, steps.position, kLongWidth_bits);
  put_steps(out, m.state.velocity, steps.velocity, kWidth_bits, form.moves);
  if (has_acceleration(m.kind)) put_steps(out, m.state.acceleration, steps.acceleration, kWidth_bits, form.moves);
  if (has_jerk(m.kind)) put_steps(out, m.jerk, steps.jerk, kWidth_bits, form.moves);
  if (has_rate(m.kind)) {
    if (const auto log2 = rate_step_log2(m, steps)) put_steps(out, m.rate_rad_s, *log2, kLongWidth_bits, form.rate);
  }
  if (!is_identity(m.state.orientation)) put_orientation(out, m.state.orientation, form.turns.has_value());
  put_steps(out, m.state.angular_velocity_body, steps.spin, kWidth_bits, form.turns);
  if (!is_zero_vector(m.angular_acceleration_body)) {
    put_steps(out, m.angular_acceleration_body, steps.spin_acceleration, kWidth_bits, form.turns);
  }
}

// ---- from bits: each take() returns whether encode_record() could have made the bits; reading beyond the end is
// refused after everything has been read ----

// Takes a number. `may_be_zero`: no mask says that it is not zero. Zero has one sign.
bool take_sign_and_magnitude(BitReader& in, int magnitude_bits, bool may_be_zero, std::int64_t& n) {
  const std::uint64_t bits = in.get(magnitude_bits + 1);
  n = static_cast<std::int64_t>(bits >> 1);
  if ((bits & 1) != 0) n = -n;
  return n != 0 || (may_be_zero && bits == 0);
}

bool take_steps(BitReader& in, Vec3& v, int step_log2, int width_bits, Axes axes = {}) {
  const int width = static_cast<int>(in.get(width_bits));
  if (width == 0) return true;
  unsigned mask = axes.value_or(0);
  if (width > kComponentMax_bits || (!axes && !take_mask(in, false, mask))) return false;
  const double step = power_of_two(step_log2);
  std::uint64_t all = 0;
  for (int i = 0; i < 3; ++i) {
    std::int64_t n = 0;
    if ((mask >> i & 1) != 0 && !take_sign_and_magnitude(in, width, axes.has_value(), n)) return false;
    all |= static_cast<std::uint64_t>(std::abs(n));
    v[i] = static_cast<double>(n) * step;
  }
  return static_cast<int>(std::bit_width(all)) == width;
}

bool take_orientation(BitReader& in, Quat& q, bool upright) {
  SmallestThree three;
  if (upright) {
    three.largest = in.get(1) != 0 ? kLargestIs_y : 0;
    std::int64_t n = 0;
    const bool half_a_turn = three.largest == kLargestIs_y;  // w may be zero; with y it would be the identity
    if (!take_sign_and_magnitude(in, SmallestThree::kMagnitude_bits, half_a_turn, n)) return false;
    other_of_wy(three) = static_cast<std::int32_t>(n);
    q = to_orientation(three).value();
    return true;
  }
  three.largest = static_cast<int>(in.get(2));
  unsigned mask = 0;
  if (!take_mask(in, three.largest != 0, mask))
    return false;  // an empty mask with w is the identity, which is not sent
  for (std::size_t i = 0; i < 3; ++i) {
    std::int64_t n = 0;
    if ((mask >> i & 1) != 0 && !take_sign_and_magnitude(in, SmallestThree::kMagnitude_bits, false, n)) return false;
    three.steps[i] = static_cast<std::int32_t>(n);
  }
  const auto taken = to_orientation(three);
  if (taken) q = *taken;
  return taken.has_value();
}

struct Present {
  bool orientation, spin_acceleration, level, upright;
};

bool take_exact(BitReader& in, const Present& present, MotionModel& m) {
  if (!take_exact(in, m.state.position) || !take_exact(in, m.state.velocity)) return false;
  if (has_acceleration(m.kind) && !take_exact(in, m.state.acceleration)) return false;
  if (has_jerk(m.kind) && !take_exact(in, m.jerk)) return false;
  if (has_rate(m.kind) && !take_exact(in, m.rate_rad_s)) return false;
  if (present.orientation && !take_exact(in, m.state.orientation)) return false;
  if (!take_exact(in, m.state.angular_velocity_body)) return false;
  return !present.spin_acceleration ||
         (take_exact(in, m.angular_acceleration_body) && !is_zero_vector(m.angular_acceleration_body));
}

bool take_steps(BitReader& in, int position_log2, const Present& present, MotionModel& m) {
  const Steps steps = steps_of(m.kind, position_log2);
  const Form form = form_of(m.kind, present.level, present.upright);
  if (!take_steps(in, m.state.position, steps.position, kLongWidth_bits) ||
      !take_steps(in, m.state.velocity, steps.velocity, kWidth_bits, form.moves)) {
    return false;
  }
  if (has_acceleration(m.kind) && !take_steps(in, m.state.acceleration, steps.acceleration, kWidth_bits, form.moves)) {
    return false;
  }
  if (has_jerk(m.kind) && !take_steps(in, m.jerk, steps.jerk, kWidth_bits, form.moves)) return false;
  if (has_rate(m.kind)) {
    const auto log2 = rate_step_log2(m, steps);
    if (log2 && !take_steps(in, m.rate_rad_s, *log2, kLongWidth_bits, form.rate)) return false;
  }
  if (present.orientation && !take_orientation(in, m.state.orientation, present.upright)) return false;
  if (!take_steps(in, m.state.angular_velocity_body, steps.spin, kWidth_bits, form.turns)) return false;
  if (present.spin_acceleration &&
      (!take_steps(in, m.angular_acceleration_body, steps.spin_acceleration, kWidth_bits, form.turns) ||
       is_zero_vector(m.angular_acceleration_body))) {
    return false;
  }
  return present.level == is_level(m) && present.upright == is_upright(m);
}

bool take(BitReader& in, SimTime at, Drive& drive) {
  return take_exact(in, drive.acceleration) && acceptable(drive.acceleration) && take_time(in, at, drive.since) &&
         drive.since <= at;
}

bool take(BitReader& in, SimTime base, UpdateRecord& u) {
  const std::uint64_t kind = in.get(kKind_bits);
  u.model.kind = static_cast<MotionKind>(kind % kCarried);
  if (static_cast<int>(u.model.kind) == 0) return false;
  const std::uint64_t step = in.get(kStep_bits);
  const bool later = in.get(1) != 0, decided = in.get(1) != 0;
  const bool turned = in.get(1) != 0, spins_up = in.get(1) != 0;
  const bool level = in.get(1) != 0, upright = in.get(1) != 0, borne = in.get(1) != 0;
  if (!take_object(in, u.object) || !take_varint(in, u.sequence) || u.sequence == 0) return false;
  if (kind > kCarried && !take_object(in, u.carrier.emplace())) return false;
  u.at = base;
  if (later && (!take_time(in, base, u.at) || u.at == base)) return false;
  if (decided && (!take_time(in, u.at, u.decision) || u.decision == SimTime{})) return false;
  if (step != kExact) u.position_step_log2 = static_cast<int>(step) + kStepLeast_log2;
  const Present present{turned, spins_up, level, upright};
  if ((level || upright) && !u.position_step_log2) return false;
  const bool taken =
      u.position_step_log2 ? take_steps(in, *u.position_step_log2, present, u.model) : take_exact(in, present, u.model);
  if (borne && !take(in, u.at, u.drive.emplace())) return false;
  return taken && in.good() && in.padded_with_zeros() && acceptable(u.model.state) && within_limits(u.model);
}

}  // namespace

std::optional<int> position_step_log2(MotionKind kind, double tolerance_m) {
  if (!(tolerance_m > 0.0)) return std::nullopt;  // NaN, too
  const int step = std::ilogb(std::min(tolerance_m, 1.0)) - 4 - horizon_log2_s(kind);
  return step < kStepLeast_log2 ? std::nullopt : std::optional(std::min(step, kStepMost_log2));
}

int horizon_log2_s(MotionKind kind) {
  return kind == MotionKind::kSecond || kind == MotionKind::kHistory || kind == MotionKind::kThird ? 0 : 2;
}

UpdateRecord quantised(const UpdateRecord& record, const Tolerance& tolerance) {
  assert(acceptable(record.model.state) && within_limits(record.model));
  UpdateRecord out = record;
  MotionModel& m = out.model;
  out.position_step_log2 = position_step_log2(m.kind, tolerance.distance_m);
  if (out.position_step_log2 && rounds_to_first(m, *out.position_step_log2)) {
    m.kind = MotionKind::kFirst;
    m.state.acceleration.setZero();
    out.position_step_log2 = position_step_log2(m.kind, tolerance.distance_m);
  }
  if (!(tolerance.angle_rad >= kCoarsestAngle_rad)) out.position_step_log2.reset();
  if (out.position_step_log2 && round_to_steps(m, *out.position_step_log2) && acceptable(m.state) && within_limits(m) &&
      stops_alike(record.model, m)) {
    return out;
  }
  out.position_step_log2.reset();
  m = record.model;
  drop_signs_of_zero(m);
  return out;
}

std::size_t encode_record(const UpdateRecord& u, SimTime base, std::span<std::byte, kRecordMax_bytes> bytes) {
  const auto kind = static_cast<std::uint64_t>(u.model.kind);
  assert(kind < kUnknownKind);
  assert(!u.position_step_log2 ||
         (*u.position_step_log2 >= kStepLeast_log2 && *u.position_step_log2 <= kStepMost_log2));
  BitWriter out(bytes);
  const bool later = u.at != base, decided = u.decision != SimTime{};
  out.put(u.carrier ? kind + kCarried : kind, kKind_bits);
  out.put(u.position_step_log2 ? static_cast<std::uint64_t>(*u.position_step_log2 - kStepLeast_log2) : kExact,
          kStep_bits);
  out.put(later ? 1 : 0, 1);
  out.put(decided ? 1 : 0, 1);
  out.put(is_identity(u.model.state.orientation) ? 0 : 1, 1);
  out.put(is_zero_vector(u.model.angular_acceleration_body) ? 0 : 1, 1);
  const Form form = u.position_step_log2 ? form_of(u.model.kind, is_level(u.model), is_upright(u.model)) : Form{};
  out.put(form.moves ? 1 : 0, 1);
  out.put(form.turns ? 1 : 0, 1);
  out.put(u.drive ? 1 : 0, 1);
  put_object(out, u.object);
  put_varint(out, u.sequence);
  if (u.carrier) put_object(out, *u.carrier);
  if (later) put_time(out, base, u.at);
  if (decided) put_time(out, u.at, u.decision);
  u.position_step_log2 ? put_steps(out, u.model, *u.position_step_log2, form) : put_exact(out, u.model);
  if (u.drive) {
    assert(u.drive->since <= u.at);
    put_exact(out, u.drive->acceleration);
    put_time(out, u.at, u.drive->since);
  }
  return out.finish();
}

EncodedUpdate::EncodedUpdate(const UpdateRecord& record, SimTime base)
    : record_(record), base_(base), size_bytes_(encode_record(record, base, bytes_)) {}

void EncodedUpdate::count_from(SimTime base) {
  if (base == base_) return;
  base_ = base;
  size_bytes_ = encode_record(record_, base, bytes_);
}

std::expected<UpdateRecord, RecordError> decode_record(std::span<const std::byte>& rest, SimTime base) {
  assert(!rest.empty());
  if ((std::to_integer<std::uint64_t>(rest[0]) & ((1 << kKind_bits) - 1)) == kUnknownKind) {
    const std::size_t size = rest.size() < 2 ? rest.size() : std::to_integer<std::size_t>(rest[1]);
    if (rest.size() < 2 + size) return std::unexpected(RecordError::kValue);
    rest = rest.subspan(2 + size);
    return std::unexpected(RecordError::kUnknownModel);
  }
  BitReader in(rest);
  std::expected<UpdateRecord, RecordError> out;
  if (!take(in, base, *out)) return std::unexpected(RecordError::kValue);
  assert(in.size_bytes() <= rest.size());
  rest = rest.subspan(in.size_bytes());
  return out;
}

}  // namespace peerd::replication
