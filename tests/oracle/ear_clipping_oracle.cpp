#include "tests/oracle/ear_clipping_oracle.hpp"

#include <gmpxx.h>

#include <optional>

namespace peerd::oracle {
namespace {

struct Corner {
  mpq_class x, y;
  bool operator==(const Corner&) const = default;
};

class CutPolygon {
 public:
  explicit CutPolygon(const std::vector<std::pair<double, double>>& corners) {
    for (const auto& [x, y] : corners) at_.push_back({mpq_class(x), mpq_class(y)});
    for (std::uint32_t i = 0; i < at_.size(); ++i) left_.push_back(i);
  }

  [[nodiscard]] std::size_t size() const { return left_.size(); }

  // The place in the list of what is left of the corner that is cut next: the lowest spike, else the lowest ear, else
  // the lowest corner. The list is sorted, so the first one is the lowest.
  [[nodiscard]] std::size_t next() const {
    for (std::size_t k = 0; k < left_.size(); ++k) {
      if (is_spike(k)) return k;
    }
    for (std::size_t k = 0; k < left_.size(); ++k) {
      if (is_ear(k)) return k;
    }
    return 0;
  }
  [[nodiscard]] std::array<std::uint32_t, 3> cut(std::size_t k) {
    const std::array<std::uint32_t, 3> triangle{before(k), left_[k], after(k)};
    left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(k));
    return triangle;
  }
  [[nodiscard]] const std::vector<std::uint32_t>& left() const { return left_; }

 private:
  [[nodiscard]] std::uint32_t before(std::size_t k) const { return left_[(k + left_.size() - 1) % left_.size()]; }
  [[nodiscard]] std::uint32_t after(std::size_t k) const { return left_[(k + 1) % left_.size()]; }

  // Twice the signed area of the triangle: positive for a turn to the left.
  [[nodiscard]] static int turn(const Corner& a, const Corner& b, const Corner& c) {
    const mpq_class area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    return sgn(area);
  }

  // No area is between its edges, and it is not inside the segment between its neighbours.
  [[nodiscard]] bool is_spike(std::size_t k) const {
    const Corner &a = at_[before(k)], &b = at_[left_[k]], &c = at_[after(k)];
    if (turn(a, b, c) != 0) return false;
    const mpq_class along = (a.x - b.x) * (c.x - b.x) + (a.y - b.y) * (c.y - b.y);
    return sgn(along) >= 0;  // its neighbours lie in one direction from it, or one of them is where it is
  }

  [[nodiscard]] bool is_ear(std::size_t k) const {
    if (turn(at_[before(k)], at_[left_[k]], at_[after(k)]) <= 0) return false;
    for (const std::uint32_t other : left_) {
      if (other != before(k) && other != left_[k] && other != after(k) && blocks(other, k)) return false;
    }
    return true;
  }

  // A corner inside the triangle or on its new edge blocks it. One at the corner that would be cut, or on an edge that
  // the polygon has, does so only if one of its own edges leads inside. One where a neighbour is does not.
  [[nodiscard]] bool blocks(std::size_t other, std::size_t k) const {
    const Corner &a = at_[before(k)], &b = at_[left_[k]], &c = at_[after(k)], &p = at_[other];
    if (p == a || p == c || turn(a, b, p) < 0 || turn(b, c, p) < 0 || turn(c, a, p) < 0) return false;
    const bool on_ab = turn(a, b, p) == 0, on_bc = turn(b, c, p) == 0;
    const auto leads_inside = [&](const std::optional<Corner>& q) {
      const Corner& to = q ? *q : at_[0];
      return (!on_ab || turn(a, b, to) > 0) && (!on_bc || turn(b, c, to) > 0);
    };
    return leads_inside(nearest_other(other, at_.size() - 1)) || leads_inside(nearest_other(other, 1));
  }

  // The first corner of the whole polygon, in steps of `step`, that is not where corner `i` is.
  [[nodiscard]] std::optional<Corner> nearest_other(std::size_t i, std::size_t step) const {
    for (std::size_t j = (i + step) % at_.size(); j != i; j = (j + step) % at_.size()) {
      if (at_[j] != at_[i]) return at_[j];
    }
    return std::nullopt;
  }

  std::vector<Corner> at_;
  std::vector<std::uint32_t> left_;  // corners that are not cut, in their order
};

}  // namespace

std::vector<std::array<std::uint32_t, 3>> cut_ears(const std::vector<std::pair<double, double>>& polygon) {
  CutPolygon rest(polygon);
  std::vector<std::array<std::uint32_t, 3>> triangles;
  while (rest.size() > 3) triangles.push_back(rest.cut(rest.next()));
  triangles.push_back({rest.left()[0], rest.left()[1], rest.left()[2]});
  return triangles;
}

}  // namespace peerd::oracle
