#include "core/least_change.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <utility>

namespace peerd {
namespace {

// A bound of the rounding of a few sums and products, relative to their largest term.
constexpr double kSumRounding = 0x1p-48;
// Rounding, multiplied by the condition of a set of constraints, mostly stays below so many times its bound; what
// contradicts the others is far above.
constexpr double kContradiction = 0x1p10;
// A constraint of which the others leave less than this part (a square) depends on them, but for rounding. Where that
// is too little, and the multipliers grow until they hide what they are to make, the next one is tried.
constexpr std::array kIndependent = {0x1p-36, 0x1p-24, 0x1p-14};

// A guess at which constraints are held pays off where there are more than this.
constexpr std::size_t kFew = 6;
constexpr int kSweeps = 30;

// The inner product, as four sums: one sum would wait for each of its additions.
double product(const double* a, const double* b, std::size_t count) {
  double sums[4] = {};
  std::size_t k = 0;
  for (; k + 4 <= count; k += 4) {
    for (std::size_t i = 0; i < 4; ++i) sums[i] += a[k + i] * b[k + i];
  }
  for (; k < count; ++k) sums[0] += a[k] * b[k];
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

// The multipliers l >= 0 for which all slacks, s + G l, are >= 0, and those with a multiplier 0. G is the matrix of the
// constraints, scaled so that it has ones on its diagonal: masses of any ratio are as good as equal ones.
class ActiveSet {
 public:
  ActiveSet(std::span<const ConstrainedBody> bodies, std::span<const OneSided> constraints, double independent)
      : independent_(independent),
        scale_(constraints.size(), 0.0),
        gram_(constraints.size()),
        slack_(constraints.size()),
        tolerance_(constraints.size()),
        multiplier_(constraints.size(), 0.0),
        place_(constraints.size(), kNowhere),
        refused_(constraints.size(), false),
        is_held_(constraints.size(), false) {
    std::vector<std::vector<std::uint32_t>> of_body(bodies.size());
    for (std::uint32_t i = 0; i < constraints.size(); ++i) {
      const OneSided& c = constraints[i];
      assert(c.a != c.b && c.a < bodies.size() && c.b < bodies.size() && std::abs(c.normal.norm() - 1.0) < 1e-9);
      const double gives = bodies[c.a].inverse_mass + bodies[c.b].inverse_mass;
      scale_[i] = gives > 0.0 ? 1.0 / std::sqrt(gives) : 1.0;
      const Vec3 &a = bodies[c.a].value, &b = bodies[c.b].value;
      slack_[i] = scale_[i] * (c.normal.dot(a - b) - c.least);
      is_held_[i] = c.is_held;
      tolerance_[i] = scale_[i] * kSumRounding * (a.norm() + b.norm() - c.least);
      for (const std::uint32_t body : {c.a, c.b}) {
        if (bodies[body].inverse_mass > 0.0) of_body[body].push_back(i);
      }
    }
    for (std::uint32_t i = 0; i < constraints.size(); ++i) {
      const OneSided& c = constraints[i];
      for (const std::uint32_t body : {c.a, c.b}) {
        for (const std::uint32_t j : of_body[body]) {
          const double sign = (constraints[j].a == body) == (c.a == body) ? 1.0 : -1.0;
          const double part = sign * bodies[body].inverse_mass * c.normal.dot(constraints[j].normal);
          add_to_gram(i, j, scale_[i] * part * scale_[j]);
        }
      }
    }
    first_slack_ = slack_;
  }

  [[nodiscard]] bool is_met() const {
    for (std::uint32_t i = 0; i < slack_.size(); ++i) {
      if (slack_[i] < -tolerance_[i] || (is_held_[i] && slack_[i] > tolerance_[i])) return false;
    }
    return true;
  }

  // Meets what is held together first, and for good. One that depends on the others is met with them.
  void begin_with_what_is_held() {
    for (std::uint32_t i = 0; i < slack_.size(); ++i) {
      if (is_held_[i] && row_of(i) > independent_) append(i);
    }
    held_ = active_.size();
    if (held_ == 0) return;
    set_multipliers();
    set_slacks();
  }

  // Begins with the constraints that push after some sweeps of Gauss and Seidel's method, as far as each of them has
  // to.
  void begin_with_a_guess() {
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (std::uint32_t i = 0; i < slack_.size(); ++i) {
        const double by = is_held_[i] ? -slack_[i] : std::max(-slack_[i], -multiplier_[i]);
        if (by != 0.0) change_multiplier(i, by);
      }
    }
    for (std::uint32_t i = 0; i < slack_.size(); ++i) {
      const bool pushes = std::exchange(multiplier_[i], 0.0) > 0.0;
      if (pushes && !is_held_[i] && row_of(i) > independent_) append(i);
    }
    for (;;) {
      set_multipliers();
      const auto pulls = [&](std::uint32_t i) { return !is_held_[i] && multiplier_[i] <= 0.0; };
      const auto first = std::ranges::find_if(active_, pulls);
      if (first == active_.end()) break;
      const std::vector<std::uint32_t> after(first, active_.end());
      cut(static_cast<std::size_t>(first - active_.begin()));
      for (const std::uint32_t i : after) {
        const bool keeps = !pulls(i);
        multiplier_[i] = 0.0;
        if (keeps && row_of(i) > independent_) append(i);
      }
    }
    set_slacks();
  }

  // None: it is solved.
  [[nodiscard]] std::optional<LeastChangeError> solve() {
    std::size_t left = 64 + 32 * scale_.size();  // rounding could go round in circles
    for (std::uint32_t p = most_violated(); p != kNowhere; p = most_violated()) {
      for (;;) {
        if (left-- == 0) return LeastChangeError::kRounding;
        const double independent = row_of(p);
        const std::vector<double> step = back_substituted();
        // The multiplier of p rises until p is met, or one that is held has to push no more.
        const double to_meet = independent > independent_ ? -slack_[p] / independent : kInfinity;
        double to_drop = kInfinity;
        std::uint32_t drops = kNowhere;
        for (std::uint32_t k = 0; k < active_.size(); ++k) {
          if (k < held_ || step[k] <= kSumRounding) continue;
          const double rise = multiplier_[active_[k]] / step[k];
          if (rise >= to_drop) continue;
          to_drop = rise;
          drops = k;
        }
        const double rise = std::min(to_meet, to_drop);
        if (rise == kInfinity) {  // p is a combination of active constraints
          if (slack_[p] < -kContradiction * rounding(p)) return LeastChangeError::kNoRoom;
          refused_[p] = true;
          break;
        }
        change_multiplier(p, rise);
        for (std::uint32_t k = 0; k < active_.size(); ++k) change_multiplier(active_[k], -rise * step[k]);
        if (to_meet <= to_drop) {
          append(p);  // row_ is still its own
          refused_.assign(refused_.size(), false);
          break;
        }
        drop(drops);
      }
    }
    set_multipliers();
    for (const std::uint32_t i : active_) multiplier_[i] = is_held_[i] ? multiplier_[i] : std::max(multiplier_[i], 0.0);
    set_slacks();
    for (std::uint32_t i = 0; i < slack_.size(); ++i) {
      const double most = kContradiction * rounding(i);
      if (slack_[i] < -most || (is_held_[i] && slack_[i] > most)) return LeastChangeError::kRounding;
    }
    return std::nullopt;
  }

  [[nodiscard]] double multiplier(std::uint32_t i) const { return scale_[i] * multiplier_[i]; }

 private:
  static constexpr std::uint32_t kNowhere = std::numeric_limits<std::uint32_t>::max();
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  struct Entry {
    std::uint32_t column;
    double value;
  };
  // A row of the Cholesky factor of what is held, from its first column that is not zero.
  struct Row {
    std::uint32_t first;
    std::vector<double> values;
    double diagonal;
  };

  void add_to_gram(std::uint32_t i, std::uint32_t j, double value) {
    const auto known = std::ranges::find(gram_[i], j, &Entry::column);
    if (known == gram_[i].end()) {
      gram_[i].push_back({j, value});
    } else {
      known->value += value;
    }
  }

  // A bound of the rounding of a slack.
  [[nodiscard]] double rounding(std::uint32_t i) const { return tolerance_[i] + kSumRounding * pushed_; }

  [[nodiscard]] std::uint32_t most_violated() const {
    std::uint32_t worst = kNowhere;
    for (std::uint32_t i = 0; i < slack_.size(); ++i) {
      if (refused_[i] || is_held_[i] || place_[i] != kNowhere || slack_[i] >= -rounding(i)) continue;
      if (worst == kNowhere || slack_[i] < slack_[worst]) worst = i;
    }
    return worst;
  }

  // Sets row_ to the row that i would have in the factor. Returns its diagonal's square: the part of i that is
  // independent of what is held.
  double row_of(std::uint32_t i) {
    const auto size = static_cast<std::uint32_t>(active_.size());
    row_.first = size;
    double square = 0.0;
    for (const Entry& e : gram_[i]) {
      if (e.column == i) square = e.value;
      if (place_[e.column] != kNowhere) row_.first = std::min(row_.first, place_[e.column]);
    }
    row_.values.assign(size - row_.first, 0.0);
    for (const Entry& e : gram_[i]) {
      if (place_[e.column] != kNowhere) row_.values[place_[e.column] - row_.first] = e.value;
    }
    for (std::uint32_t j = row_.first; j < size; ++j) {
      const Row& other = rows_[j];
      const std::uint32_t from = std::max(row_.first, other.first);
      const double value =
          (row_.values[j - row_.first] -
           product(row_.values.data() + (from - row_.first), other.values.data() + (from - other.first), j - from)) /
          other.diagonal;
      row_.values[j - row_.first] = value;
      square -= value * value;
    }
    row_.diagonal = square > 0.0 ? std::sqrt(square) : 0.0;
    return square;
  }

  void append(std::uint32_t i) {
    place_[i] = static_cast<std::uint32_t>(active_.size());
    active_.push_back(i);
    rows_.push_back(row_);
  }

  // All from that place on are active no more.
  void cut(std::size_t place) {
    assert(place >= held_);
    for (std::size_t k = place; k < active_.size(); ++k) place_[active_[k]] = kNowhere;
    active_.resize(place);
    rows_.resize(place);
  }

  void drop(std::uint32_t place) {
    const std::vector<std::uint32_t> later(active_.begin() + place + 1, active_.end());
    change_multiplier(active_[place], -multiplier_[active_[place]]);
    cut(place);
    for (const std::uint32_t i : later) {
      if (row_of(i) > independent_) {
        append(i);
      } else {
        change_multiplier(i, -multiplier_[i]);
      }
    }
  }

  // Solves L' x = row_.
  [[nodiscard]] std::vector<double> back_substituted() const {
    std::vector<double> x(active_.size(), 0.0);
    std::ranges::copy(row_.values, x.begin() + row_.first);
    substitute_back(x);
    return x;
  }
  void substitute_back(std::vector<double>& x) const {
    for (std::size_t i = x.size(); i-- > 0;) {
      const Row& row = rows_[i];
      x[i] /= row.diagonal;
      for (std::size_t k = 0; k < row.values.size(); ++k) x[row.first + k] -= row.values[k] * x[i];
    }
  }
  // Solves L L' x = x.
  void substitute(std::vector<double>& x) const {
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Row& row = rows_[i];
      for (std::size_t k = 0; k < row.values.size(); ++k) x[i] -= row.values[k] * x[row.first + k];
      x[i] /= row.diagonal;
    }
    substitute_back(x);
  }

  void change_multiplier(std::uint32_t i, double by) {
    pushed_ += std::abs(multiplier_[i] + by) - std::abs(multiplier_[i]);
    multiplier_[i] += by;
    for (const Entry& e : gram_[i]) slack_[e.column] += e.value * by;
  }

  // Solves for the multipliers of the active constraints: their slacks become zero, to the last bits.
  void set_multipliers() {
    for (const std::uint32_t i : active_) multiplier_[i] = 0.0;
    for (int pass = 0; pass < 2; ++pass) {  // the second one mends the rounding of the first
      std::vector<double> x;
      for (const std::uint32_t i : active_) {
        double slack = first_slack_[i];
        for (const Entry& e : gram_[i]) slack += e.value * multiplier_[e.column];
        x.push_back(-slack);
      }
      substitute(x);
      for (std::size_t k = 0; k < active_.size(); ++k) multiplier_[active_[k]] += x[k];
    }
  }
  void set_slacks() {
    pushed_ = 0.0;
    for (std::uint32_t i = 0; i < slack_.size(); ++i) {
      slack_[i] = first_slack_[i];
      for (const Entry& e : gram_[i]) slack_[i] += e.value * multiplier_[e.column];
      pushed_ += std::abs(multiplier_[i]);
    }
  }

  double independent_;
  std::vector<double> scale_;
  std::vector<std::vector<Entry>> gram_;
  std::vector<double> first_slack_, slack_, tolerance_, multiplier_;
  double pushed_ = 0.0;  // the sum of all multipliers
  std::vector<std::uint32_t> active_, place_;
  std::vector<Row> rows_;
  Row row_;
  std::vector<bool> refused_;  // combinations of active constraints
  std::vector<bool> is_held_;
  std::size_t held_ = 0;  // the first ones of active_
};

// The part of the constraint in what `body` changes by: the inverse mass along the normal, with the sign of the side.
Vec3 pull(const OneSided& c, std::uint32_t body, std::span<const ConstrainedBody> bodies) {
  return (body == c.a ? bodies[body].inverse_mass : -bodies[body].inverse_mass) * c.normal;
}

void change(std::span<ConstrainedBody> bodies, std::span<const OneSided> constraints,
            std::span<const double> multipliers) {
  std::vector<bool> changed(bodies.size(), false);
  double largest = 0.0;  // of all that went into the sums: what the others are given depends on each of them
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const OneSided& c = constraints[i];
    if (multipliers[i] == 0.0) continue;
    for (const std::uint32_t body : {c.a, c.b}) {
      const Vec3 change = multipliers[i] * pull(c, body, bodies);
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
}

// Whether no constraint is violated, and each with a multiplier > 0 is met exactly. The change is the least one then
// (the conditions of Karush, Kuhn and Tucker).
bool are_least(std::span<const ConstrainedBody> bodies, std::span<const OneSided> constraints,
               std::span<const double> multipliers, double rounding) {
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    const OneSided& c = constraints[i];
    const double rate = c.normal.dot(bodies[c.a].value - bodies[c.b].value) - c.least;
    if (rate < -rounding || ((c.is_held || multipliers[i] > 0.0) && rate > rounding)) return false;
  }
  return true;
}

}  // namespace

std::expected<std::vector<double>, LeastChangeError> change_least(std::span<ConstrainedBody> bodies,
                                                                  std::span<const OneSided> constraints) {
  double largest = 0.0;
  for (const ConstrainedBody& body : bodies) largest = std::max(largest, body.value.norm());
  std::vector<double> multipliers(constraints.size(), 0.0);
  for (const double independent : kIndependent) {
    ActiveSet set(bodies, constraints, independent);
    if (set.is_met()) return multipliers;
    set.begin_with_what_is_held();
    if (constraints.size() > kFew) set.begin_with_a_guess();
    if (const auto error = set.solve()) {
      if (error == LeastChangeError::kNoRoom) return std::unexpected(*error);
      continue;
    }
    for (std::uint32_t i = 0; i < constraints.size(); ++i) multipliers[i] = set.multiplier(i);
    std::vector<ConstrainedBody> changed(bodies.begin(), bodies.end());
    change(changed, constraints, multipliers);
    if (!are_least(changed, constraints, multipliers, kSolverRounding * largest)) continue;
    std::ranges::copy(changed, bodies.begin());
    return multipliers;
  }
  return std::unexpected(LeastChangeError::kRounding);
}

}  // namespace peerd
