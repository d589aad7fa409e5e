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
};

}  // namespace peerd::collision::test
