// Question: how far does an orientation drift, by how it is advanced, and what does that cost?
//
// orientation_bench [--quick] [--out DIR] [--commit NAME]: a body turns at a constant rate, ever faster about one axis
// (twice as fast in the end), or as a symmetric body does that nothing acts on: its axis goes round its angular
// momentum, and the rate in its own frame round its axis. After 60 s and after 24 h at 10, 60 and 240 Hz:
//
//   closed form       q(t) = q0 exp(w t + alpha t^2 / 2), evaluated from the one base: core's and motion_model's law;
//   of
//                     the body that nothing acts on two such turns, one after the other (no update names that law)
//   .. new base       the same, republished every 5 s, as a peer does of what nobody hears of else (time_threshold_s)
//   exponential       q <- q exp(w h), w of the step's middle
//   euler, midpoint,  q' = q w / 2, integrated and normalised at every step, as VRML browsers and many engines do; w is
//   rk4               not integrated but given as it is, which flatters them
//
// error: the largest angle [rad] between that and the truth at any tenth second so far; what is lost has one near pi.
// The truth is the law in long double, with the C library's sine: none of it is core's code. ns: of the thread, a step
// (with its w) or an evaluation, in turns. Writes orientation-drift.csv besides. Exit code 1:
// a closed form is beyond 8 units of rounding a radian turned; an integrator about one axis is not where its own
// formula, summed as complex numbers in long double, has it; another drift does not shrink with the step as its order
// says; a quaternion is not unit; this closed form is not, to the last bit, the library's.
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "collision_report.hpp"
#include "core/sin_cos.hpp"
#include "replication/physics/laws/motion_model.hpp"

namespace peerd::bench {
namespace {

using Real = long double;
static_assert(std::numeric_limits<Real>::digits >= 64, "the truth must be finer than binary64");
using RealVec3 = Eigen::Matrix<Real, 3, 1>;
using RealQuat = Eigen::Quaternion<Real>;

constexpr double kRounding = 0x1p-53;
// The terms t w and alpha t / 2, their sum, its norm and the rounding of 2 pi each contribute a rounding or two of the
// whole angle.
constexpr double kBoundPerRadian = 8.0 * kRounding, kBoundAtLeast = 4e-15;
constexpr double kLook_s = 10.0, kNewBase_s = 5.0;
constexpr std::array kRates_hz = {10, 60, 240};

// The rotation of a body from q0 at t = 0.
struct Spin {
  std::string name;
  Vec3 w_body = {0.7, -1.1, 1.5};  // [rad/s], at t = 0
  Vec3 alpha_body = Vec3::Zero();  // [rad/s^2], parallel to w
  double about_z_rad_s = 0.0;      // so fast w goes round the body's z; then alpha is zero
  Quat q0 = quat_exp({0.4, 0.1, -0.2});

  [[nodiscard]] Vec3 w_at(double t) const {
    if (about_z_rad_s == 0.0) return w_body + t * alpha_body;
    const auto [sin, cos] = sin_cos(about_z_rad_s * t);
    return {cos * w_body.x() - sin * w_body.y(), sin * w_body.x() + cos * w_body.y(), w_body.z()};
  }
  // Angular momentum over the moment of inertia across z: it stands in the world.
  [[nodiscard]] Vec3 momentum() const { return w_body + Vec3(0, 0, about_z_rad_s); }
  // The angle that the body has turned until then.
  [[nodiscard]] double angle_rad(double t) const {
    return t * (momentum() + (0.5 * t) * alpha_body).norm() + t * about_z_rad_s;
  }
};

// It is about twice as fast at the end of the duration. A power of two: the axis is the same to the last bit.
std::vector<Spin> spins(double duration_s) {
  Spin steady{"constant rate"}, faster{"ever faster"}, free{"nothing acts on it"};
  faster.alpha_body = std::ldexp(1.0, -std::ilogb(duration_s)) * faster.w_body;
  free.about_z_rad_s = 0.75;  // half of what it turns about z: a disc that is half as hard again to turn about its axis
  return {steady, faster, free};
}

// ---- the truth ----

RealQuat real_exp(const RealVec3& rotation) {
  const Real angle = rotation.norm();
  if (angle == 0) return RealQuat::Identity();
  const RealVec3 v = (std::sin(angle / 2) / angle) * rotation;
  return {std::cos(angle / 2), v.x(), v.y(), v.z()};
}

RealQuat truth(const Spin& spin, Real t) {
  const Real n = spin.about_z_rad_s;
  const RealVec3 first = spin.w_body.cast<Real>() + RealVec3(0, 0, n);
  const RealVec3 turned = t * first + (t * t / 2) * spin.alpha_body.cast<Real>();
  return spin.q0.cast<Real>() * real_exp(turned) * real_exp(RealVec3(0, 0, -n * t));
}

double error_rad(const Quat& q, const RealQuat& is) {
  const RealQuat apart = is.conjugate() * q.cast<Real>();
  return static_cast<double>(2 * std::atan2(apart.vec().norm(), std::abs(apart.w())));
}

// ---- what is compared ----

Quat closed_form(const Spin& spin, double t) {
  if (spin.about_z_rad_s == 0.0) {
    return (spin.q0 * quat_exp(t * (spin.w_body + (0.5 * t) * spin.alpha_body))).normalized();
  }
  return (spin.q0 * quat_exp(t * spin.momentum()) * quat_exp({0, 0, -t * spin.about_z_rad_s})).normalized();
}

replication::MotionModel model_of(const Spin& spin) {
  replication::MotionModel model;
  model.state.orientation = spin.q0;
  model.state.angular_velocity_body = spin.w_body;
  model.angular_acceleration_body = spin.alpha_body;
  return model;
}

enum class Method { kEuler, kMidpoint, kRk4, kExponential };
struct MethodInfo {
  Method method;
  const char* name;
  double order;  // by which the drift shrinks with the step, where the axis turns
};
constexpr std::array<MethodInfo, 4> kMethods = {{{Method::kEuler, "euler", 1.0},
                                                 {Method::kMidpoint, "midpoint", 2.0},
                                                 {Method::kRk4, "rk4", 4.0},
                                                 {Method::kExponential, "exponential", 2.0}}};

Quat plus(const Quat& q, double h, const Quat& rate) { return Quat(q.coeffs() + h * rate.coeffs()); }
Quat rate_of(const Quat& q, const Vec3& w) {  // q' = q w / 2
  const Vec3 half = 0.5 * w;
  return q * Quat(0.0, half.x(), half.y(), half.z());
}

template <Method kMethod>
Quat step(const Quat& q, const Spin& spin, double t, double h) {
  if constexpr (kMethod == Method::kEuler) return plus(q, h, rate_of(q, spin.w_at(t))).normalized();
  const Vec3 w_middle = spin.w_at(t + 0.5 * h);
  if constexpr (kMethod == Method::kExponential) return (q * quat_exp(h * w_middle)).normalized();
  const Quat k1 = rate_of(q, spin.w_at(t)), k2 = rate_of(plus(q, 0.5 * h, k1), w_middle);
  if constexpr (kMethod == Method::kMidpoint) return plus(q, h, k2).normalized();
  const Quat k3 = rate_of(plus(q, 0.5 * h, k2), w_middle), k4 = rate_of(plus(q, h, k3), spin.w_at(t + h));
  return Quat(q.coeffs() + (h / 6.0) * (k1.coeffs() + 2.0 * (k2.coeffs() + k3.coeffs()) + k4.coeffs())).normalized();
}

// The angle of the same step about one axis, where quaternions are complex numbers.
Real angle_of_step(Method method, Real x0, Real xm, Real x1) {  // half of w h: at the step's begin, middle and end
  const std::complex<Real> i(0, 1), one = 1;
  if (method == Method::kExponential) return 2 * xm;
  if (method == Method::kEuler) return 2 * std::arg(one + i * x0);
  const std::complex<Real> k1 = i * x0, k2 = i * xm * (one + k1 / Real(2));
  if (method == Method::kMidpoint) return 2 * std::arg(one + k2);
  const std::complex<Real> k3 = i * xm * (one + k2 / Real(2)), k4 = i * x1 * (one + k3);
  return 2 * std::arg(one + (k1 + Real(2) * (k2 + k3) + k4) / Real(6));
}

// The predicted drift is the angle by which the integrator must be off at the end [rad], in [0, pi].
double predicted_rad(Method method, const Spin& spin, int hz, double duration_s) {
  const Real w = spin.w_body.cast<Real>().norm(), alpha = spin.alpha_body.cast<Real>().norm(), h = Real(1) / hz;
  const auto steps = static_cast<std::int64_t>(duration_s * hz);
  Real turned = 0;
  if (alpha == 0) {
    turned = static_cast<Real>(steps) * angle_of_step(method, w * h / 2, w * h / 2, w * h / 2);
  } else {
    for (std::int64_t k = 0; k < steps; ++k) {
      const auto x = [&](Real t) { return (w + alpha * t) * h / 2; };
      const Real t = static_cast<Real>(k) * h;
      turned += angle_of_step(method, x(t), x(t + h / 2), x(t + h));
    }
  }
  const Real t = duration_s;
  return static_cast<double>(
      std::abs(std::remainder(turned - (w * t + alpha * t * t / 2), 2 * std::numbers::pi_v<Real>)));
}

// ---- drift ----

struct Drift {
  double largest_rad = 0.0, last_rad = 0.0;
  double norm_error = 0.0;
  void look(const Quat& q, const RealQuat& is) {
    last_rad = error_rad(q, is);
    largest_rad = std::max(largest_rad, last_rad);
    norm_error = std::max(norm_error, std::abs(q.norm() - 1.0));
  }
};

template <Method kMethod>
Drift integrate(const Spin& spin, int hz, double duration_s) {
  Drift drift;
  Quat q = spin.q0;
  const double h = 1.0 / hz;
  const auto steps = static_cast<std::int64_t>(duration_s * hz), look = static_cast<std::int64_t>(kLook_s * hz);
  for (std::int64_t k = 0; k < steps; ++k) {
    q = step<kMethod>(q, spin, static_cast<double>(k) * h, h);
    if ((k + 1) % look == 0) drift.look(q, truth(spin, static_cast<Real>(k + 1) / hz));
  }
  return drift;
}

Drift integrate(Method method, const Spin& spin, int hz, double duration_s) {
  switch (method) {
    case Method::kEuler:
      return integrate<Method::kEuler>(spin, hz, duration_s);
    case Method::kMidpoint:
      return integrate<Method::kMidpoint>(spin, hz, duration_s);
    case Method::kRk4:
      return integrate<Method::kRk4>(spin, hz, duration_s);
    case Method::kExponential:
      break;
  }
  return integrate<Method::kExponential>(spin, hz, duration_s);
}

Drift from_one_base(const Spin& spin, double duration_s) {
  Drift drift;
  for (double t = kLook_s; t <= duration_s; t += kLook_s) drift.look(closed_form(spin, t), truth(spin, t));
  return drift;
}

Drift from_new_bases(const Spin& spin, double duration_s) {
  Drift drift;
  replication::MotionModel model = model_of(spin);
  for (double t = kNewBase_s; t <= duration_s; t += kNewBase_s) {
    model = replication::rebased(model, kNewBase_s);
    if (std::fmod(t, kLook_s) == 0.0) drift.look(model.state.orientation, truth(spin, t));
  }
  return drift;
}

// ---- cost ----

struct Costs {
  std::array<double, kMethods.size()> step_ns{};
  double closed_ns = 0.0;
};

template <Method kMethod>
void step_often(const Spin& spin, int steps) {
  Quat q = spin.q0;
  const double h = 1.0 / 60.0;
  for (int k = 0; k < steps; ++k) q = step<kMethod>(q, spin, k * h, h);
  use(q);
}

Costs measure_costs(const Spin& spin, bool quick) {
  const int steps = quick ? 1'000 : 1'000'000;
  const std::vector<std::function<void()>> runners = {
      [&] { step_often<Method::kEuler>(spin, steps); }, [&] { step_often<Method::kMidpoint>(spin, steps); },
      [&] { step_often<Method::kRk4>(spin, steps); }, [&] { step_often<Method::kExponential>(spin, steps); },
      [&] {
        for (int k = 0; k < steps; ++k) use(closed_form(spin, k / 60.0));
      }};
  const std::vector<Quartiles> times = race(quick ? 1 : 9, runners);
  Costs costs;
  for (std::size_t i = 0; i < kMethods.size(); ++i) costs.step_ns[i] = 1e9 * times[i].median / steps;
  costs.closed_ns = 1e9 * times.back().median / steps;
  return costs;
}

// ---- all together ----

class Bench {
 public:
  explicit Bench(const Options& options) : report_(options) {}

  int run() {
    std::vector<Costs> costs;
    for (const Spin& spin : spins(60.0)) {
      costs.push_back(measure_costs(spin, report_.quick()));
      for (std::size_t i = 0; i < kMethods.size(); ++i) {
        report_.figure(name_of(spin.name) + "step." + kMethods[i].name, costs.back().step_ns[i], "ns",
                       "an evaluation in closed form", costs.back().step_ns[i] / costs.back().closed_ns);
      }
      report_.figure(name_of(spin.name) + "evaluation.closed_form", costs.back().closed_ns, "ns");
    }
    const std::vector<double> durations_s = report_.quick() ? std::vector<double>{60} : std::vector<double>{60, 86'400};
    for (const double duration_s : durations_s) {
      const std::vector<Spin> all = spins(duration_s);
      for (std::size_t i = 0; i < all.size(); ++i) compare({all[i], duration_s, costs[i]});
    }
    report_.print(table_);
    return report_.finish();
  }

 private:
  struct Case {
    Spin spin;
    double duration_s;
    Costs costs;
    [[nodiscard]] std::string lasts() const {
      return duration_s < 3600.0 ? text(duration_s, 0) + " s" : text(duration_s / 3600.0, 0) + " h";
    }
    [[nodiscard]] std::string title() const { return spin.name + ", " + lasts(); }
    [[nodiscard]] bool one_axis() const { return spin.about_z_rad_s == 0.0; }
  };

  void compare(const Case& c) {
    for (std::size_t i = 0; i < kMethods.size(); ++i) integrators(kMethods[i], c.costs.step_ns[i], c);
    const Drift one = from_one_base(c.spin, c.duration_s);
    const double bound_rad = kBoundAtLeast + kBoundPerRadian * c.spin.angle_rad(c.duration_s);
    report_.check(one.largest_rad <= bound_rad, c.title() + ": the closed form is beyond its bound");
    report_.figure(name_of(c) + "closed_form.drift", one.largest_rad, "rad", "its bound", one.largest_rad / bound_rad);
    in_closed_form("closed form", one, c);
    if (c.one_axis()) {
      check_is_the_librarys(c);
      const Drift anew = from_new_bases(c.spin, c.duration_s);
      report_.figure(name_of(c) + "new_bases.drift", anew.largest_rad, "rad", "closed form",
                     anew.largest_rad / one.largest_rad);
      in_closed_form(".. new base each 5 s", anew, c);
    }
  }

  void integrators(const MethodInfo& info, double step_ns, const Case& c) {
    std::vector<double> drifts;
    for (const int hz : kRates_hz) {
      const Drift drift = integrate(info.method, c.spin, hz, c.duration_s);
      const std::string at = c.title() + ", " + info.name + " at " + std::to_string(hz) + " Hz";
      note(drift, at);
      if (c.one_axis()) check_predicted(info.method, c, hz, drift, at);
      add_row(c, info.name, std::to_string(hz), drift.largest_rad, step_ns);
      report_.figure(name_of(c) + info.name + '.' + std::to_string(hz) + "hz.drift", drift.largest_rad, "rad");
      drifts.push_back(drift.largest_rad);
    }
    if (!c.one_axis()) check_order(info, c, drifts);
  }

  // The rate is a peer's tick rate.
  void in_closed_form(const std::string& name, const Drift& drift, const Case& c) {
    note(drift, c.title() + ", " + name);
    add_row(c, name, "any", drift.largest_rad, c.costs.closed_ns);
  }

  void note(const Drift& drift, const std::string& of) {
    report_.check(drift.norm_error <= 1e-15, of + ": a quaternion is not unit");
  }

  // A product and a norm round a few times a step, and h itself is rounded.
  static double rounding_rad(const Case& c, int hz) {
    return kBoundAtLeast + kBoundPerRadian * (c.duration_s * hz + c.spin.angle_rad(c.duration_s));
  }

  void check_predicted(Method method, const Case& c, int hz, const Drift& drift, const std::string& at) {
    const double predicted = predicted_rad(method, c.spin, hz, c.duration_s);
    report_.check(std::abs(drift.last_rad - predicted) <= rounding_rad(c, hz),
                  at + ": off by " + in_rad(drift.last_rad) + " rad and not " + in_rad(predicted));
  }

  // The order is checked where the drift at 60 Hz is still small, and that at 240 Hz is more than rounding.
  void check_order(const MethodInfo& info, const Case& c, const std::vector<double>& drifts) {
    if (drifts[1] > 0.1 || drifts[2] <= rounding_rad(c, kRates_hz[2])) return;
    const double order = std::log(drifts[1] / drifts[2]) / std::log(static_cast<double>(kRates_hz[2]) / kRates_hz[1]);
    report_.check(order >= info.order - 0.5, c.title() + ", " + info.name + ": order " + text(order, 2));
  }

  void check_is_the_librarys(const Case& c) {
    const replication::MotionModel model = model_of(c.spin);
    bool same = true;
    for (double t = 0.0; t <= replication::kModelLasts_s; t += 0.0625) {
      same = same && replication::orientation_after(model, t).coeffs() == closed_form(c.spin, t).coeffs();
    }
    report_.check(same, c.title() + ": this is not the library's closed form");
  }

  void add_row(const Case& c, const std::string& method, const std::string& rate, double error, double ns) {
    table_.rows.push_back(
        {c.spin.name, c.lasts(), method, rate, in_rad(error), text(ns, 1), text(ns / c.costs.closed_ns, 2)});
  }

  static std::string in_rad(double error) {
    char shown[32];
    std::snprintf(shown, sizeof shown, "%.2e", error);
    return shown;
  }
  static std::string name_of(std::string name) {
    std::ranges::replace(name, ' ', '_');
    return name + '.';
  }
  static std::string name_of(const Case& c) { return name_of(c.spin.name) + name_of(c.lasts()); }

  Report report_;
  Table table_{
      "drift",
      "By how an orientation is advanced: largest error [rad]; a step or evaluation in ns, over the closed form's",
      {"spin", "after", "method", "hz", "error_rad", "ns", "over_closed"}};
};

}  // namespace
}  // namespace peerd::bench

int main(int argc, char** argv) {
  using namespace peerd::bench;
  return run_main(argc, argv, [](const Options& options) { return Bench(options).run(); });
}
