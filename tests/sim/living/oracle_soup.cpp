#include "tests/sim/living/oracle_soup.hpp"

#include <limits>

namespace peerd::living {
namespace {

using Vector = std::array<double, 3>;

// What sums and products of a few coordinates below 1 km round by, many times over [m].
constexpr double kArithmetic_m = 1e-11;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Vector minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector along(const Vector& p, const Vector& d, double s) { return {p[0] + s * d[0], p[1] + s * d[1], p[2] + s * d[2]}; }
double dot_of(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector cross_of(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length_of(const Vector& a) { return std::sqrt(dot_of(a, a)); }

// Two points, one of each triangle, and their distance.
struct Nearest {
  Vector p{}, q{};
  double distance_m = kInfinity;
  void take(const Vector& of_a, const Vector& of_b) {
    const double d = length_of(minus(of_b, of_a));
    if (d < distance_m) *this = {of_a, of_b, d};
  }
};

// The nearest points of two segments (Ericson, Real-Time Collision Detection, 2005, 5.1.9).
void take_edges(const Vector& p, const Vector& p_end, const Vector& q, const Vector& q_end, Nearest& nearest) {
  const Vector d = minus(p_end, p), e = minus(q_end, q), r = minus(p, q);
  const double a = dot_of(d, d), b = dot_of(d, e), c = dot_of(d, r), f = dot_of(e, e), g = dot_of(e, r);
  const double whole = a * f - b * b;
  double s = whole > 0.0 ? std::clamp((b * g - c * f) / whole, 0.0, 1.0) : 0.0;
  double t = f > 0.0 ? (b * s + g) / f : 0.0;
  if (t < 0.0 || t > 1.0) {
    t = std::clamp(t, 0.0, 1.0);
    s = a > 0.0 ? std::clamp((b * t - c) / a, 0.0, 1.0) : 0.0;
  }
  nearest.take(along(p, d, s), along(q, e, t));
}

// The foot of p on the plane of a triangle, where that is in it. `turned`: the triangle is the first one's.
void take_foot(const Vector& p, const std::array<Vector, 3>& t, bool turned, Nearest& nearest) {
  const Vector n = cross_of(minus(t[1], t[0]), minus(t[2], t[0]));
  const double square = dot_of(n, n);
  if (!(square > 0.0)) return;
  for (std::size_t i = 0; i < 3; ++i) {
    if (dot_of(cross_of(minus(t[(i + 1) % 3], t[i]), minus(p, t[i])), n) < 0.0) return;
  }
  const Vector foot = along(p, n, -dot_of(minus(p, t[0]), n) / square);
  turned ? nearest.take(foot, p) : nearest.take(p, foot);
}

double distance_of(const Soup::Box& a, const Soup::Box& b) {
  double square = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double gap = std::max({0.0, b.lo[k] - a.hi[k], a.lo[k] - b.hi[k]});
    square += gap * gap;
  }
  return std::sqrt(square);
}

Interval orientation(const Point& a, const Point& b, const Point& c, const Point& d) {
  return dot(cross(a - d, b - d), c - d);
}
int sign_of(const Interval& x) { return x.lo > 0.0 ? 1 : x.hi < 0.0 ? -1 : 0; }

}  // namespace

Soup::Soup(std::vector<std::array<int, 3>> triangles, const std::vector<Point>& points) {
  std::vector<Vector> centers;
  std::vector<int> order;
  for (const auto& triangle : triangles) {
    order.push_back(int(order.size()));
    Vector& center = centers.emplace_back(Vector{});
    for (const int corner : triangle) {
      for (std::size_t k = 0; k < 3; ++k) center[k] += points[std::size_t(corner)][k].mid();
    }
  }
  build(centers, 0, int(order.size()), order);
  for (const int i : order) triangles_.push_back(triangles[std::size_t(i)]);
  place(points, 0.0);
}

// Halves along the widest side, down to four triangles.
void Soup::build(const std::vector<Vector>& centers, int begin, int end, std::vector<int>& order) {
  const std::size_t node = nodes_.size();
  nodes_.push_back({{}, begin, end, 0});
  if (end - begin <= 4) return;
  Vector lo{kInfinity, kInfinity, kInfinity}, hi{-kInfinity, -kInfinity, -kInfinity};
  for (int i = begin; i < end; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      const double at = centers[std::size_t(order[std::size_t(i)])][k];
      lo[k] = std::min(lo[k], at), hi[k] = std::max(hi[k], at);
    }
  }
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (hi[k] - lo[k] > hi[axis] - lo[axis]) axis = k;
  }
  const int middle = begin + (end - begin) / 2;
  std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end,
                   [&](int i, int k) { return centers[std::size_t(i)][axis] < centers[std::size_t(k)][axis]; });
  build(centers, begin, middle, order);
  nodes_[node].right = int(nodes_.size());
  build(centers, middle, end, order);
}

void Soup::place(const std::vector<Point>& points, double slack_m) {
  corners_.clear();
  for (const Point& p : points) {
    Corner corner{{p[0].mid(), p[1].mid(), p[2].mid()}, 0.0};
    for (const Interval& x : p) corner.radius = std::max(corner.radius, up(x.radius() + slack_m));
    corners_.push_back(corner);
  }
  for (std::size_t i = nodes_.size(); i-- > 0;) {  // children stand behind their parents
    Node& node = nodes_[i];
    Box& box = node.box;
    if (node.right != 0) {
      const Box &left = nodes_[i + 1].box, &right = nodes_[std::size_t(node.right)].box;
      for (std::size_t k = 0; k < 3; ++k) {
        box.lo[k] = std::min(left.lo[k], right.lo[k]), box.hi[k] = std::max(left.hi[k], right.hi[k]);
      }
      continue;
    }
    box = {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
    for (int t = node.begin; t < node.end; ++t) {
      for (const Corner* corner : corners(t)) {
        for (std::size_t k = 0; k < 3; ++k) {
          box.lo[k] = std::min(box.lo[k], down(corner->middle[k] - corner->radius));
          box.hi[k] = std::max(box.hi[k], up(corner->middle[k] + corner->radius));
        }
      }
    }
  }
}

void Soup::extend(std::size_t axis, Range& lo, Range& hi) const {
  for (const Corner& corner : corners_) {
    const Range at{down(corner.middle[axis] - corner.radius), up(corner.middle[axis] + corner.radius)};
    lo = {std::min(lo.lo, at.lo), std::min(lo.hi, at.hi)};
    hi = {std::max(hi.lo, at.lo), std::max(hi.hi, at.hi)};
  }
}

Soup::Corners Soup::corners(int triangle) const {
  const auto& [a, b, c] = triangles_[std::size_t(triangle)];
  return {&corners_[std::size_t(a)], &corners_[std::size_t(b)], &corners_[std::size_t(c)]};
}

template <class Reach, class Visit>
bool Soup::visit_near(const Soup& a, const Soup& b, int node_a, int node_b, const Reach& reach, const Visit& visit) {
  const Node &of_a = a.nodes_[std::size_t(node_a)], &of_b = b.nodes_[std::size_t(node_b)];
  if (distance_of(of_a.box, of_b.box) > reach()) return false;
  if (of_a.right == 0 && of_b.right == 0) {
    for (int i = of_a.begin; i < of_a.end; ++i) {
      for (int k = of_b.begin; k < of_b.end; ++k) {
        if (visit(i, k)) return true;
      }
    }
    return false;
  }
  // The larger one is split, and the nearer half comes first, for it brings the reach down.
  const bool split_a = of_b.right == 0 || (of_a.right != 0 && of_a.end - of_a.begin >= of_b.end - of_b.begin);
  std::array<std::array<int, 2>, 2> halves;
  if (split_a) {
    halves = {{{node_a + 1, node_b}, {of_a.right, node_b}}};
  } else {
    halves = {{{node_a, node_b + 1}, {node_a, of_b.right}}};
  }
  const auto distance_of_half = [&](const std::array<int, 2>& half) {
    return distance_of(a.nodes_[std::size_t(half[0])].box, b.nodes_[std::size_t(half[1])].box);
  };
  if (distance_of_half(halves[1]) < distance_of_half(halves[0])) std::swap(halves[0], halves[1]);
  return visit_near(a, b, halves[0][0], halves[0][1], reach, visit) ||
         visit_near(a, b, halves[1][0], halves[1][1], reach, visit);
}

void Soup::lower_distance(const Soup& a, const Soup& b, Range& range) {
  visit_near(
      a, b, 0, 0, [&] { return range.hi; },
      [&](int i, int k) {
        const Range pair = distance(a.corners(i), b.corners(k));
        range.lo = std::min(range.lo, pair.lo);
        range.hi = std::min(range.hi, pair.hi);
        return range.hi == 0.0;
      });
}

// How far b is beyond a along n, wherever in their boxes the corners are.
double Soup::gap_along(const Corners& a, const Corners& b, const Vector& n) {
  double top_a = -kInfinity, bottom_b = kInfinity, radius_a = 0.0, radius_b = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    top_a = std::max(top_a, dot_of(a[i]->middle, n)), bottom_b = std::min(bottom_b, dot_of(b[i]->middle, n));
    radius_a = std::max(radius_a, a[i]->radius), radius_b = std::max(radius_b, b[i]->radius);
  }
  const double spread = std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2]);
  return bottom_b - top_a - spread * (radius_a + radius_b) - kArithmetic_m;
}

// The nearest points of the corners' middles give a direction along which the triangles are apart, whatever the
// direction is: the lower end is certain. The upper end is the distance of two points that the triangles have.
Range Soup::distance(const Corners& a, const Corners& b, Vector* direction) {
  std::array<Vector, 3> p, q;
  double radius_a = 0.0, radius_b = 0.0;
  for (std::size_t i = 0; i < 3; ++i) {
    p[i] = a[i]->middle, q[i] = b[i]->middle;
    radius_a = std::max(radius_a, a[i]->radius), radius_b = std::max(radius_b, b[i]->radius);
  }
  Nearest nearest;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k) take_edges(p[i], p[(i + 1) % 3], q[k], q[(k + 1) % 3], nearest);
    take_foot(p[i], q, false, nearest);
    take_foot(q[i], p, true, nearest);
  }
  const double radius = radius_a + radius_b;
  Range range{0.0, nearest.distance_m + std::sqrt(3.0) * radius + kArithmetic_m};
  const Vector way = minus(nearest.q, nearest.p);
  const double length = length_of(way);
  if (length > 0.0) {
    const Vector n{way[0] / length, way[1] / length, way[2] / length};
    range.lo = std::max(0.0, gap_along(a, b, n));
    if (direction != nullptr) *direction = n;
  }
  if (range.lo == 0.0 && cross(a, b)) range.hi = 0.0;
  return range;
}

void Soup::find_near(const Soup& a, const Soup& b, double distance_m, std::vector<Near>& near) {
  visit_near(
      a, b, 0, 0, [&] { return distance_m; },
      [&](int i, int k) {
        Near pair{i, k, {}, 0.0};
        pair.gap_m = distance(a.corners(i), b.corners(k), &pair.direction).lo;
        if (pair.gap_m <= distance_m) near.push_back(pair);
        return false;
      });
}

double Soup::gap_m(const Soup& a, const Soup& b, const Near& near) {
  return gap_along(a.corners(near.a), b.corners(near.b), near.direction);
}

// An edge crosses a triangle where its ends are on two sides of the plane, and the line passes the triangle's edges on
// one side: signs of volumes, for all corners in their boxes.
bool Soup::cross(const Corners& a, const Corners& b) {
  const auto point = [](const Corner& corner) {
    Point p;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = {down(corner.middle[k] - corner.radius), up(corner.middle[k] + corner.radius)};
    }
    return p;
  };
  const std::array<Point, 3> of_a{point(*a[0]), point(*a[1]), point(*a[2])};
  const std::array<Point, 3> of_b{point(*b[0]), point(*b[1]), point(*b[2])};
  const auto goes_through = [](const std::array<Point, 3>& edges, const std::array<Point, 3>& t) {
    std::array<int, 3> side;
    for (std::size_t i = 0; i < 3; ++i) side[i] = sign_of(orientation(t[0], t[1], t[2], edges[i]));
    for (std::size_t i = 0; i < 3; ++i) {
      const Point &p = edges[i], &q = edges[(i + 1) % 3];
      if (side[i] * side[(i + 1) % 3] >= 0) continue;
      const int first = sign_of(orientation(p, q, t[0], t[1]));
      if (first == 0 || sign_of(orientation(p, q, t[1], t[2])) != first) continue;
      if (sign_of(orientation(p, q, t[2], t[0])) == first) return true;
    }
    return false;
  };
  return goes_through(of_a, of_b) || goes_through(of_b, of_a);
}

bool Soup::cross(const Soup& a, const Soup& b) {
  return visit_near(
      a, b, 0, 0, [] { return 0.0; }, [&](int i, int k) { return cross(a.corners(i), b.corners(k)); });
}

}  // namespace peerd::living
