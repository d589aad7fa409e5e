#pragma once
#include <array>
#include <vector>

#include "tests/sim/living/interval.hpp"

namespace peerd::living {

// A certain range of a number that is not known exactly.
struct Range {
  double lo = 0.0, hi = 0.0;
};

// The triangles of a Shape in some frame. The corners are known to be in boxes; what is said of them is true wherever
// in their boxes they are.
class Soup {
 public:
  // The triangles are sorted into a tree of boxes by where `points` are, and stay so as these move.
  Soup(std::vector<std::array<int, 3>> triangles, const std::vector<Point>& points);

  // The boxes are `slack_m` wider to all sides.
  void place(const std::vector<Point>& points, double slack_m);

  // Lowers `range` to the distance of two soups, where that is less.
  static void lower_distance(const Soup& a, const Soup& b, Range& range);
  // Whether some edge of one goes through a triangle of the other for certain.
  [[nodiscard]] static bool cross(const Soup& a, const Soup& b);

  // Pairs of triangles, one of each soup, each with a direction and the gap along it in a placement.
  struct Near {
    int a = 0, b = 0;
    std::array<double, 3> direction{};  // unit, but for rounding
    double gap_m = 0.0;                 // certain; 0: nothing certainly parts the two
  };
  // Adds all pairs that are not certainly farther apart than that.
  static void find_near(const Soup& a, const Soup& b, double distance_m, std::vector<Near>& near);
  // The gap of a pair along its direction, as the soups are placed now; negative where they overlap along it.
  [[nodiscard]] static double gap_m(const Soup& a, const Soup& b, const Near& near);

  // Widens the lower and the upper end of a box along an axis, each a range, to hold all corners.
  void extend(std::size_t axis, Range& lo, Range& hi) const;

  struct Box {
    std::array<double, 3> lo, hi;
  };

 private:
  struct Corner {
    std::array<double, 3> middle;
    double radius;  // along each axis
  };
  struct Node {
    Box box;
    int begin = 0, end = 0;  // triangles
    int right = 0;           // the left one stands right behind it; 0: a leaf
  };
  using Corners = std::array<const Corner*, 3>;
  void build(const std::vector<std::array<double, 3>>& centers, int begin, int end, std::vector<int>& order);
  [[nodiscard]] Corners corners(int triangle) const;
  static Range distance(const Corners& a, const Corners& b, std::array<double, 3>* direction = nullptr);
  static double gap_along(const Corners& a, const Corners& b, const std::array<double, 3>& n);
  static bool cross(const Corners& a, const Corners& b);
  // Visits pairs of triangles whose boxes are no farther apart than reach(), until `visit` is true; it takes the two
  // triangles.
  template <class Reach, class Visit>
  static bool visit_near(const Soup& a, const Soup& b, int node_a, int node_b, const Reach& reach, const Visit& visit);

  std::vector<std::array<int, 3>> triangles_;
  std::vector<Corner> corners_;
  std::vector<Node> nodes_;
};

}  // namespace peerd::living
