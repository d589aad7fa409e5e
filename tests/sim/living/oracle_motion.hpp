#pragma once
#include <vector>

#include "tests/sim/living/interval.hpp"
#include "tests/sim/living/world.hpp"

namespace peerd::living {

// Where the nodes of a world are, in intervals, after ISO/IEC 14772-1: 6.50 (TimeSensor), 4.6.8 (interpolators, linear
// and along the shorter arc) and 6.52 (Transform), with a velocityVector times the time beside the translation.
//
// Between two of its breaks nothing jumps and no interpolator changes its segment. What is asked at a break has two
// answers, one of each side: a time comes with another one, `within`, that lies inside of the side that is meant.
class OracleMotion {
 public:
  explicit OracleMotion(const World& world);  // the world outlives it

  [[nodiscard]] std::vector<double> breaks_of_clock(int clock) const;  // 0 and the end of the world included, sorted

  // The map from the frame of a node's children to that of its parent.
  [[nodiscard]] Map parent_from_local(int node, double t_s, double within_s) const;
  // The points of a form, those of curved ones cut into 24 slices and 12 stacks, in the frame of its Shape.
  [[nodiscard]] std::vector<Point> points(int form, double t_s, double within_s) const;

  // Bounds of how fast a point of the frame of a node's children goes in that of its parent, and how fast that changes,
  // if it is within `radius_m` of the origin and moves by `speed_m_s` and `acceleration_m_s2` itself, and of how far it
  // is from the origin there; between the breaks around `within_s`.
  struct Bound {
    double radius_m = 0.0, speed_m_s = 0.0, acceleration_m_s2 = 0.0;
  };
  [[nodiscard]] Bound bound(int node, const Bound& below, double within_s) const;
  [[nodiscard]] Bound bound_of_form(int form, double within_s) const;

  // The triangles of a form, by its points.
  [[nodiscard]] const std::vector<std::array<int, 3>>& triangles(int form) const {
    return solids_[std::size_t(form)].triangles;
  }

 private:
  using Quaternion = std::array<Interval, 4>;  // w x y z
  // The place on a path: from value `from` to value `to` by `weight`.
  struct Place {
    std::size_t from = 0, to = 0;
    Interval weight;
    double seconds = 0.0;  // from one to the other; 0: it stands there
  };
  struct Solid {
    std::vector<Three> points;
    std::vector<std::array<int, 3>> triangles;
  };
  // False where the clock has not begun, so that fields are as the file has them.
  [[nodiscard]] bool fraction(const Clock& clock, double t_s, double within_s, Interval& out, double& middle,
                              bool& runs) const;
  template <class V>
  [[nodiscard]] bool place(const Path<V>& path, double t_s, double within_s, Place& out) const;
  [[nodiscard]] Point vector(const Path<Three>& path, const Three& in_file, double t_s, double within_s) const;
  [[nodiscard]] Matrix rotation(int node, double t_s, double within_s) const;
  [[nodiscard]] static Quaternion quaternion(const Turn& turn);
  [[nodiscard]] static Quaternion between(const Quaternion& a, const Quaternion& b, const Interval& weight);
  [[nodiscard]] static Matrix matrix(const Quaternion& q);
  [[nodiscard]] static Solid solid(const Form& form);

  const World& world_;
  std::vector<Solid> solids_;                    // by form
  std::vector<std::vector<Quaternion>> turns_;   // by node, of the values of its rotations
  std::vector<Matrix> still_turns_, stretches_;  // by node: the file's rotation and scaleOrientation
};

}  // namespace peerd::living
