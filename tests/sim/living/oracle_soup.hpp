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
  // How far apart the planes and edges of two crossing triangles would have to go to part them [m], the most of all
  // pairs: a figure for statistics, without certainty. 0: none cross.
  [[nodiscard]] static double depth_m(const Soup& a, const Soup& b);

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
  static Range distance(const Corners& a, const Corners& b);
  static bool cross(const Corners& a, const Corners& b);
  static double depth_m(const Corners& a, const Corners& b);
  // Visits pairs of triangles whose boxes are no farther apart than reach(), until `visit` is true.
  template <class Reach, class Visit>
  static bool visit_near(const Soup& a, const Soup& b, int node_a, int node_b, const Reach& reach, const Visit& visit);

  std::vector<std::array<int, 3>> triangles_;
  std::vector<Corner> corners_;
  std::vector<Node> nodes_;
};

}  // namespace peerd::living
