#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "collision/exact/moving_triangles.hpp"
#include "collision/exact/triangle_soup.hpp"
#include "collision/query/wide_query.hpp"

namespace peerd::collision {

// One step of a triangle soup, from fraction 0 to fraction 1: each vertex moves along a straight line at constant
// speed. A soup that deforms is given so, and a rigid one that moves is, too, as well as chords stand for the arcs of
// its vertices. Both soups of a question are in one common frame, that of the world, in binary64 [m].
struct SoupStep {
  std::span<const Vec3> at_begin, at_end;     // as many of both, within kLargestCoordinate_m
  std::span<const TriangleSoup::Face> faces;  // their corners are indices of vertices; vertices without a face are fine

  [[nodiscard]] Triangle triangle_at_begin(std::uint32_t face) const;
  [[nodiscard]] MovingTriangle triangle(std::uint32_t face) const;
};

enum class SoupImpactState : std::uint8_t {
  kSeparated,  // certainly nothing comes as near as the margin in [0, 1]
  kHit,        // nothing does before `fraction`; there a pair is as near as margin and tolerance along each axis
  kTouching,   // at 0 some triangles share a point: exact
  kUnsure,     // nothing does before `fraction`; what happens then is not known, the iterations ran out
};

struct SoupImpact {
  SoupImpactState state = SoupImpactState::kSeparated;
  double fraction = 1.0;  // of the step, in [0, 1]: never later than the first contact
  // The following are set where the state isn't kSeparated. Of pairs with that fraction, the one with the least
  // `polygons`, then with the least `faces`.
  PolygonPair polygons{};        // the `polygon`s of its faces
  FacePair faces{};              // indices of SoupStep::faces
  std::uint32_t candidates = 0;  // pairs of triangles whose boxes come near
  std::uint32_t iterations = 0;  // of all pairs: steps of advancement, and iterations of inclusion tests
};

struct SoupImpactOptions {
  double margin_m = 0.0;      // >= 0
  double tolerance_m = 1e-6;  // > 0; kAdvancementTolerance_m, or less for small bodies: advancement_tolerance_m()
  std::uint32_t max_steps = 512, max_iterations = 1u << 14;  // of each pair: moving_triangles.hpp
};

// Finds the first contact of two soups within a step: the least fraction of all pairs of their triangles by
// MovingTriangleQuery, whose certainties and tolerance these are. A soup has no inside.
//
// Boxes of all that a triangle sweeps are culled by the box of all that the other soup sweeps, then sorted and swept
// along the longest axis: O((n + m) log (n + m)) and the pairs that overlap along that axis. Pairs are then visited in
// the order of the times at which their boxes meet, until the first contact is earlier than that.
//
// Fraction and state have the same bits if the soups change places. An object keeps its memory, so that a question like
// one before allocates nothing. Not thread-safe.
class SoupImpactQuery {
 public:
  [[nodiscard]] SoupImpact first_impact(const SoupStep& a, const SoupStep& b, const SoupImpactOptions& options = {});

  // All pairs of triangles that shared a point at 0, ordered by polygons, then faces; valid until the next question.
  [[nodiscard]] std::span<const FacePair> touching_at_begin() const { return touching_; }

 private:
  struct SweptFace {
    WorldBox box;
    std::uint32_t face;
  };
  struct Candidate {
    double from;  // the boxes are apart before
    PolygonPair polygons;
    FacePair faces;
    friend auto operator<=>(const Candidate&, const Candidate&) = default;
  };

  void sweep(const SoupStep& a, const SoupStep& b, double margin_m);
  void find_touching(const SoupStep& a, const SoupStep& b);

  std::vector<SweptFace> swept_a_, swept_b_;
  std::vector<Candidate> candidates_;
  std::vector<FacePair> touching_;
  MovingTriangleQuery pair_query_;
};

}  // namespace peerd::collision
