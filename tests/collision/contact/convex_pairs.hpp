#pragma once
#include "collision/contact/convex_contact.hpp"
#include "tests/collision/shapes.hpp"

namespace peerd::collision::test {

inline Solid solid_of(const Body& body) {
  const ConvexPiece& piece = body.pieces.at(0);
  return {piece.vertices, &piece, piece.shape};
}

// Two bodies of one piece each, and the query about them.
struct ConvexPair {
  Body collider, collidee;
  KinematicState of_collider, of_collidee;
  double horizon_s = 10.0;

  template <class Answer>
  [[nodiscard]] Contact ask(Answer&& answer) const {
    const Solid a = solid_of(collider), b = solid_of(collidee);
    return answer(PairQuery{a, b, of_collider, of_collidee, horizon_s}, collider.radius_m + collidee.radius_m);
  }
  [[nodiscard]] Contact translational() const {
    return ask([&](const PairQuery& query, double radius_sum_m) {
      return translational_contact(query, radius_sum_m, of_collider.orientation.toRotationMatrix(),
                                   of_collidee.orientation.toRotationMatrix());
    });
  }
  [[nodiscard]] Contact rotational() const {
    return ask([](const PairQuery& query, double radius_sum_m) { return rotational_contact(query, radius_sum_m); });
  }
  // The largest gap along any separating axis at an instant: below 0 the two overlap.
  [[nodiscard]] double gap_m(double t) const {
    const KinematicState a = advance(of_collider, t), b = advance(of_collidee, t);
    const Mat3 R_a = a.orientation.toRotationMatrix(), R_b = b.orientation.toRotationMatrix();
    const Solid solid_a = solid_of(collider), solid_b = solid_of(collidee);
    double widest = -1e300;
    for_each_axis(solid_a, R_a, solid_b, R_b, [&](const Vec3& n, AxisKind) {
      const Extent of_a = extent_along(rotate_back(R_a, n), solid_a.vertices);
      const Extent of_b = extent_along(rotate_back(R_b, n), solid_b.vertices);
      const double along = dot(n, Vec3(a.position - b.position));
      widest = std::max({widest, along - (of_b.high - of_a.low), (of_b.low - of_a.high) - along});
      return true;
    });
    return widest;
  }
};

}  // namespace peerd::collision::test
