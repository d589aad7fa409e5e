#include "replication/physics/laws/model_choice.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/atan2.hpp"
#include "replication/physics/laws/position_history.hpp"

namespace peerd::replication {
namespace {

// The samples that are kept of one object, whatever the tick rate: 2 s at 250 Hz, 90 kB.
constexpr std::size_t kSamplesMax = 512;
// The room for samples grows by so many at a time: room that is not needed would be walked through in memory all the
// same.
constexpr std::size_t kMoreSamples = 16;
// Derivatives are taken over this many samples on either side at most: more of them smooth noise, fewer show changes
// sooner.
constexpr std::size_t kSpanMax = 4;
constexpr std::size_t kTriplesMax = 8;
// Samples are kept so long beyond the horizon, for the derivatives at a horizon ago.
constexpr double kSpanMax_s = 0.25;
// Once a run has kYoung samples, predictions are judged kJudgedInMemory times within the memory: neighbours say nearly
// the same.
constexpr std::size_t kYoung = 16;
constexpr double kJudgedInMemory = 12.0;
// A model takes another's place if its expected error is this much smaller: enough not to flap between equals.
constexpr double kBetterBy = 0.8;
constexpr double kBetterBy_m = 1e-6;
// An acceleration of the spin, which an update saves bytes without, is taken where the error is this much smaller.
constexpr double kSpinBetterBy = 0.4;

std::size_t index_of(MotionKind kind) {
  assert(std::ranges::find(kMotionKinds, kind) != std::end(kMotionKinds));
  return static_cast<std::size_t>(std::ranges::find(kMotionKinds, kind) - std::begin(kMotionKinds));
}

// The kinds of models, the simplest first.
constexpr MotionKind kBySimplicity[] = {MotionKind::kFirst,      MotionKind::kSecond,  MotionKind::kSliding,
                                        MotionKind::kHistory,    MotionKind::kTurning, MotionKind::kThird,
                                        MotionKind::kOscillating};

// The first power of time that the model leaves out.
int leaves_out(MotionKind kind) {
  switch (kind) {
    case MotionKind::kFirst:
      return 2;
    case MotionKind::kSecond:
    case MotionKind::kHistory:
    case MotionKind::kTurning:
    case MotionKind::kSliding:
      return 3;
    case MotionKind::kThird:
      return 4;
    case MotionKind::kOscillating:
      return 5;
  }
  return 3;
}

double power(double x, int n) {
  assert(n >= 0);
  double p = 1.0;
  for (; n > 0; --n) p *= x;
  return p;
}

// The factor of an error of that kind of model, relative to one of second order: the square of the ratio of the bytes
// of their updates, which for the second order are some 34 with the share of a datagram's header. Between thresholds,
// errors and bytes are traded at the square (README.md).
double price(MotionKind kind) {
  switch (kind) {
    case MotionKind::kFirst:
      return 0.78;
    case MotionKind::kSecond:
    case MotionKind::kHistory:
      return 1.0;
    case MotionKind::kSliding:
      return 1.12;
    case MotionKind::kThird:
      return 1.25;
    case MotionKind::kTurning:
      return 1.53;
    case MotionKind::kOscillating:
      return 1.83;
  }
  return 1.0;
}

bool same_length(Duration a, Duration b) { return std::chrono::abs(a - b) <= (a + b) / 1'000'000; }

// The change of the velocity beyond what the accelerations explain [m/s].
double velocity_jump(const KinematicState& a, const KinematicState& b, double dt_s) {
  return (b.velocity - a.velocity - 0.5 * dt_s * (a.acceleration + b.acceleration)).norm();
}

}  // namespace

void ModelChooser::Score::add(double e, double share) {
  assert(share > 0.0 && share <= 1.0);
  weight = weight * (1.0 - share) + share;
  error += (e - error) * share / weight;
}

// Whether `now` does not go on from `before`: its velocity is not explained by the accelerations, or its acceleration
// changes as it never did. The usual changes are learnt, so that noisy samples are not all corners.
bool ModelChooser::is_corner(const Sample& before, const Sample& now) const {
  const double dt = to_seconds(now.at - before.at);
  const KinematicState &a = before.state, &b = now.state;
  const double strongest = std::max(a.acceleration.norm(), b.acceleration.norm());
  const double jump = velocity_jump(a, b, dt);
  const double speed = std::max(a.velocity.norm(), b.velocity.norm());
  if (jump > 8.0 * usual_jump_m_s_ + 0.1 * strongest * dt + 1e-4 * speed) return true;
  const double change = (b.acceleration - a.acceleration).norm();
  return change > 8.0 * usual_change_m_s2_ + 0.05 * strongest && strongest > 0.0;
}

void ModelChooser::push(SimTime t, const KinematicState& state, const Horizon& horizon) {
  Sample now{state, t, 1};
  if (!samples_.empty()) {
    const Sample& before = samples_.back();
    assert(t > before.at);
    const bool corner = is_corner(before, now);
    if (!corner) now.run = std::min(before.run + 1, kSamplesMax);
    if (corner) scores_ = {};
    learn_what_is_usual(before, now);
  }
  keep(now);
  judge(horizon);
}

void ModelChooser::keep(const Sample& now) {
  if (samples_.full()) samples_.set_capacity(std::min(samples_.size() + kMoreSamples, kSamplesMax));
  samples_.push_back(now);  // replaces the first sample where there are kSamplesMax
  while (samples_.size() > 2 && now.at - samples_[1].at > from_seconds(policy_.horizon_max_s + kSpanMax_s)) {
    samples_.pop_front();
  }
  assert(!samples_.empty() && samples_.size() <= kSamplesMax);
}

void ModelChooser::learn_what_is_usual(const Sample& before, const Sample& now) {
  const double share = std::min(1.0, to_seconds(now.at - before.at) / policy_.memory_s);
  const double change = (now.state.acceleration - before.state.acceleration).norm();
  usual_jump_m_s_ += (velocity_jump(before.state, now.state, to_seconds(now.at - before.at)) - usual_jump_m_s_) * share;
  usual_change_m_s2_ = now.run == 2 ? change : usual_change_m_s2_ + (change - usual_change_m_s2_) * share;
}

// d/dt of `what` at sample i, from samples of its run: second-order backward differences, or first-order in a run of 2.
Vec3 ModelChooser::rate_of_change(std::size_t i, Vec3 KinematicState::*what) const {
  const std::size_t back = std::min(samples_[i].run - 1, i);
  if (back == 0) return Vec3::Zero();
  const auto value = [&](std::size_t k) -> const Vec3& { return samples_[i - k].state.*what; };
  const auto age_s = [&](std::size_t k) { return to_seconds(samples_[i].at - samples_[i - k].at); };
  if (back == 1) return (value(0) - value(1)) / age_s(1);
  const std::size_t m = std::min(back / 2, kSpanMax);
  const double d1 = age_s(m), d2 = age_s(2 * m) - d1, sum = d1 + d2;
  assert(d1 > 0.0 && d2 > 0.0);
  const Vec3 b1 = value(m) - value(0), b2 = value(2 * m) - value(0);
  return d1 / (sum * d2) * b2 - (1.0 / d1 + 1.0 / d2) * b1;
}

bool ModelChooser::make_oscillating(std::size_t i, MotionModel& model) const {
  const std::size_t back = std::min(samples_[i].run - 1, i);
  if (back < 2) return false;
  const std::size_t m = std::min(back / 2, kSpanMax);
  const Duration step = samples_[i].at - samples_[i - m].at;
  // A wave has a(t-h) + a(t+h) = 2 cos(w h) a(t), whatever its phase.
  Vec3 products = Vec3::Zero(), squares = Vec3::Zero();
  for (std::size_t k = 0; k < kTriplesMax && k + 2 * m <= back; ++k) {
    const Sample &last = samples_[i - k], &middle = samples_[i - k - m], &first = samples_[i - k - 2 * m];
    if (!same_length(last.at - middle.at, step) || !same_length(middle.at - first.at, step)) break;
    products += middle.state.acceleration.cwiseProduct(last.state.acceleration + first.state.acceleration);
    squares += middle.state.acceleration.cwiseAbs2();
  }
  const double most = squares.maxCoeff();
  if (most == 0.0) return false;
  model.jerk = rate_of_change(i, &KinematicState::acceleration);
  for (int axis = 0; axis < 3; ++axis) {
    const double cos = 0.5 * products[axis] / squares[axis];
    if (squares[axis] < 1e-12 * most || cos >= 1.0) continue;  // no wave: a constant jerk
    if (cos < -0.5) return false;                              // faster than the samples can show
    const double sin = std::sqrt(1.0 - cos * cos);
    const double rate = peerd::atan2(sin, cos) / to_seconds(step);
    model.rate_rad_s[axis] = rate;
    const double a0 = samples_[i].state.acceleration[axis], a1 = samples_[i - m].state.acceleration[axis];
    if (sin > 1e-4) model.jerk[axis] = rate * (a0 * cos - a1) / sin;
  }
  return true;
}

bool ModelChooser::make_history(std::size_t i, MotionModel& model) const {
  const std::size_t back = std::min(samples_[i].run - 1, i);
  if (back < 2) return false;
  const std::size_t m = std::min(back / 2, kSpanMax);
  const Sample &s0 = samples_[i], &s1 = samples_[i - m], &s2 = samples_[i - 2 * m];
  const PositionHistory h = position_history(s0.state.position, s1.state.position, s2.state.position,
                                             to_seconds(s0.at - s1.at), to_seconds(s1.at - s2.at));
  model.state.velocity = h.velocity;
  model.state.acceleration = h.acceleration;
  return true;
}

// Makes `model`, which has the pose and spin of sample i, the one of that kind that the samples up to it give. False
// where they give none that receivers would take.
bool ModelChooser::make(MotionKind kind, std::size_t i, MotionModel& model) const {
  assert(i < samples_.size());
  const KinematicState& s = samples_[i].state;
  model.kind = kind;
  model.state.velocity = s.velocity;
  model.state.acceleration = s.acceleration;
  model.jerk.setZero();
  model.rate_rad_s.setZero();
  const double speed2 = s.velocity.squaredNorm();
  switch (kind) {
    case MotionKind::kFirst:
      model.state.acceleration.setZero();
      return true;
    case MotionKind::kSecond:
      return true;
    case MotionKind::kHistory:
      return make_history(i, model);
    case MotionKind::kThird:
      if (samples_[i].run < 2 || i == 0) return false;
      model.jerk = rate_of_change(i, &KinematicState::acceleration);
      return within_limits(model);
    case MotionKind::kTurning:
      if (speed2 == 0.0) return false;
      model.rate_rad_s = s.velocity.cross(s.acceleration) / speed2;
      return within_limits(model);
    case MotionKind::kOscillating:
      return make_oscillating(i, model) && within_limits(model);
    case MotionKind::kSliding: {
      const double closing = -s.velocity.dot(s.acceleration);
      return closing > 0.0 && s.velocity.cross(s.acceleration).norm() <= 1e-3 * closing;
    }
  }
  return false;
}

// Compares what would have been published half a run ago, or a horizon ago, with what has followed.
void ModelChooser::judge(const Horizon& horizon) {
  const std::size_t n = samples_.size() - 1, back = std::min(samples_[n].run - 1, n);
  if (back == 0) return;
  if (is_motionless(samples_[n].state) &&
      is_motionless(samples_[n - 1].state)) {  // a resting object costs nothing, whatever the model
    scores_[index_of(MotionKind::kFirst)].add(0.0, 1.0);
    return;
  }
  const SimTime now = samples_[n].at;
  const Duration since = now - std::max(judged_at_, samples_[n - back].at);
  if (back >= kYoung && since < from_seconds(policy_.memory_s / kJudgedInMemory)) return;
  judged_at_ = now;
  const double end_s = std::min(horizon.end_s(), policy_.horizon_max_s);
  const auto age_s = [&](std::size_t k) { return to_seconds(now - samples_[n - k].at); };
  const std::size_t half = std::max<std::size_t>(1, back / 2);
  std::size_t k = std::min(judged_ + 1, half);  // in most calls one more than in the last one
  while (k > 1 && age_s(k) > end_s) --k;
  while (k < half && age_s(k + 1) <= end_s) ++k;
  judged_ = k;
  assert(k >= 1 && k <= back);
  const std::size_t base = n - k;
  const double h = age_s(k), share = std::min(1.0, to_seconds(since) / policy_.memory_s);
  const double farther = std::max(1.0, end_s / h);
  MotionModel model = samples_[base].state;
  const Quat& truth = samples_[n].state.orientation;
  spin_constant_.add(angle_between(orientation_after(model, h), truth), share);
  model.angular_acceleration_body = rate_of_change(base, &KinematicState::angular_velocity_body);
  spin_accelerated_.add(angle_between(orientation_after(model, h), truth), share);
  model.angular_acceleration_body.setZero();
  for (const MotionKind kind : kMotionKinds) {
    if (!policy_.allowed[index_of(kind)] || !make(kind, base, model)) continue;
    const double error = (position_after(model, h) - samples_[n].state.position).norm();
    scores_[index_of(kind)].add(error * power(farther, leaves_out(kind)),
                                farther > 1.0 ? std::max(share, 0.25) : share);
  }
}

MotionModel ModelChooser::choose() {
  assert(!samples_.empty());
  const std::size_t n = samples_.size() - 1;
  MotionModel model = samples_[n].state;
  std::optional<MotionModel> best;
  double best_error = 0.0;
  for (const MotionKind kind : kBySimplicity) {
    const Score& score = scores_[index_of(kind)];
    if (!policy_.allowed[index_of(kind)] || score.weight == 0.0 || !make(kind, n, model)) continue;
    const double error = (kind == chosen_ ? kBetterBy : 1.0) * price(kind) * score.error;
    if (best && error > kBetterBy * best_error - kBetterBy_m) continue;
    best = model;
    best_error = error;
    expected_error_m_ = score.error;
  }
  if (!best) {
    expected_error_m_ = std::numeric_limits<double>::infinity();
    best = make(policy_.first, n, model) ? model : MotionModel(samples_[n].state);
  }
  chosen_ = best->kind;
  if (spin_accelerated_.weight > 0.0 && spin_accelerated_.error < kSpinBetterBy * spin_constant_.error - 1e-6) {
    const Vec3 acceleration = rate_of_change(n, &KinematicState::angular_velocity_body);
    if (acceleration.norm() <= kSpinAccelerationMax_rad_s2) best->angular_acceleration_body = acceleration;
  }
  return *best;
}

}  // namespace peerd::replication
