#include "core/least_change.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>

#include <Eigen/Dense>

namespace peerd {
namespace {

// A bound of the rounding of a few sums and products, relative to their largest term.
constexpr double kSumRounding = 0x1p-48;
// Rounding, multiplied by the condition of a set of constraints, mostly stays below so many times its bound; what
// contradicts the others is far above.
constexpr double kContradiction = 0x1p10;

// The multipliers (impulses, forces) l >= 0 that minimise l.A l / 2 + b.l. The constraints are scaled so that A has
// ones on its diagonal: masses of any ratio are as good as equal ones.
class ActiveSet {
 public:
  ActiveSet(const Eigen::MatrixXd& gram, const Eigen::VectorXd& rates, const Eigen::VectorXd& tolerances)
      : scale_(gram.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse()),
        gram_(scale_.asDiagonal() * gram * scale_.asDiagonal()),
        rates_(scale_.cwiseProduct(rates)),
        tolerances_(scale_.cwiseProduct(tolerances)),
        multipliers_(Eigen::VectorXd::Zero(rates_.size())),
        refused_(static_cast<std::size_t>(rates_.size()), false) {}

  // False where the constraints contradict each other.
  [[nodiscard]] bool solve() {
    for (Eigen::Index i = most_violated(); i >= 0; i = most_violated()) {
      const std::vector<Eigen::Index> active_before = active_;
      const Eigen::VectorXd multipliers_before = multipliers_;
      active_.push_back(i);
      const double sum_before = sum();
      if (descend(i) && sum() < sum_before) {  // a sum that falls comes back to no set it had
        refused_.assign(refused_.size(), false);
        continue;
      }
      active_ = active_before;
      multipliers_ = multipliers_before;
      refused_[static_cast<std::size_t>(i)] = true;
    }
    // One that could not be added is met but for the rounding of the others, or it contradicts them.
    const Eigen::VectorXd after = gram_ * multipliers_ + rates_;
    return (after.array() >= -kContradiction * rounding().array()).all();
  }

  [[nodiscard]] double multiplier(Eigen::Index i) const { return scale_[i] * multipliers_[i]; }

 private:
  [[nodiscard]] double sum() const { return multipliers_.dot(0.5 * (gram_ * multipliers_) + rates_); }

  // A bound of the rounding of what the multipliers make of the rates.
  [[nodiscard]] Eigen::VectorXd rounding() const {
    return (tolerances_.array() + kSumRounding * multipliers_.lpNorm<1>()).matrix();
  }

  // -1: none is.
  [[nodiscard]] Eigen::Index most_violated() const {
    const Eigen::VectorXd after = gram_ * multipliers_ + rates_, tolerances = rounding();
    Eigen::Index worst = -1;
    for (Eigen::Index i = 0; i < after.size(); ++i) {
      const bool candidate = !refused_[static_cast<std::size_t>(i)] && std::ranges::find(active_, i) == active_.end();
      if (!candidate || after[i] >= -tolerances[i] || (worst >= 0 && after[i] >= after[worst])) continue;
      worst = i;
    }
    return worst;
  }

  // Goes to the least sum of the active constraints, and drops those that would pull. False where the constraint that
  // was added last would have to be dropped itself: it depends on the others, but for rounding.
  [[nodiscard]] bool descend(Eigen::Index added) {
    while (!active_.empty()) {
      const Eigen::MatrixXd gram = gram_(active_, active_);
      const Eigen::VectorXd target = gram.completeOrthogonalDecomposition().solve(-rates_(active_));
      double step = 1.0;
      for (Eigen::Index k = 0; k < target.size(); ++k) {
        const double now = multipliers_[active_[static_cast<std::size_t>(k)]];
        if (target[k] <= 0.0) step = std::min(step, now / (now - target[k]));
      }
      if (!(target.array() <= 0.0).any()) {
        multipliers_(active_) = target;
        const Eigen::VectorXd left = gram * target + rates_(active_), tolerances = rounding();
        return (left.array().abs() <= tolerances(active_).array()).all();
      }
      if (!std::isfinite(step)) return false;  // the new constraint has no multiplier yet, and would get none
      for (Eigen::Index k = 0; k < target.size(); ++k) {
        double& multiplier = multipliers_[active_[static_cast<std::size_t>(k)]];
        multiplier += step * (target[k] - multiplier);
        if (target[k] <= 0.0 && multiplier <= kSumRounding * std::abs(target[k])) multiplier = 0.0;
      }
      const std::size_t before = active_.size();
      std::erase_if(active_, [&](Eigen::Index i) { return multipliers_[i] <= 0.0; });
      if (active_.size() == before || std::ranges::find(active_, added) == active_.end()) return false;
    }
    return false;
  }

  Eigen::VectorXd scale_;
  Eigen::MatrixXd gram_;
  Eigen::VectorXd rates_, tolerances_, multipliers_;
  std::vector<bool> refused_;  // those that could not be added to the present set
  std::vector<Eigen::Index> active_;
};

// The part of the constraint in what `body` changes by: the inverse mass along the normal, with the sign of the side.
Vec3 pull(const OneSided& c, std::uint32_t body, std::span<const ConstrainedBody> bodies) {
  if (body != c.a && body != c.b) return Vec3::Zero();
  return (body == c.a ? bodies[body].inverse_mass : -bodies[body].inverse_mass) * c.normal;
}

}  // namespace

bool change_least(std::span<ConstrainedBody> bodies, std::span<const OneSided> constraints) {
  const auto count = static_cast<Eigen::Index>(constraints.size());
  Eigen::MatrixXd gram(count, count);
  Eigen::VectorXd rates(count), tolerances(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const OneSided& c = constraints[static_cast<std::size_t>(i)];
    assert(c.a != c.b && c.a < bodies.size() && c.b < bodies.size() && std::abs(c.normal.norm() - 1.0) < 1e-9);
    const Vec3 &a = bodies[c.a].value, &b = bodies[c.b].value;
    rates[i] = c.normal.dot(a - b);
    tolerances[i] = kSumRounding * (a.norm() + b.norm());
    for (Eigen::Index j = 0; j < count; ++j) {
      const OneSided& other = constraints[static_cast<std::size_t>(j)];
      gram(i, j) = c.normal.dot(pull(other, c.a, bodies) - pull(other, c.b, bodies));
    }
  }
  if ((rates.array() >= -tolerances.array()).all()) return true;
  ActiveSet set(gram, rates, tolerances);
  if (!set.solve()) return false;
  std::vector<bool> changed(bodies.size(), false);
  double largest = 0.0;  // of all that went into the sums: what the others are given depends on each of them
  for (Eigen::Index i = 0; i < count; ++i) {
    const OneSided& c = constraints[static_cast<std::size_t>(i)];
    const double multiplier = set.multiplier(i);
    if (multiplier == 0.0) continue;
    for (const std::uint32_t body : {c.a, c.b}) {
      const Vec3 change = multiplier * pull(c, body, bodies);
      Vec3& value = bodies[body].value;
      largest = std::max({largest, value.cwiseAbs().maxCoeff(), change.cwiseAbs().maxCoeff()});
      value += change;
      changed[body] = true;
    }
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!changed[i] || bodies[i].inverse_mass == 0.0) continue;
    for (double& x : bodies[i].value) {
      if (std::abs(x) <= kSumRounding * largest) x = 0.0;
    }
  }
  return true;
}

}  // namespace peerd
