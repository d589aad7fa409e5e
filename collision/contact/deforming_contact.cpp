#include "collision/contact/deforming_contact.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <tuple>

#include "collision/exact/triangle_pair.hpp"

namespace peerd::collision {
namespace {

template <class SweptFaces>
WorldBox box_of(const SweptFaces& faces) {
  WorldBox box;
  for (const auto& swept : faces) box.merge(swept.box);
  return box;
}

template <class SweptFaces>
void sweep_faces(const SoupStep& soup, SweptFaces& out) {
  assert(soup.at_begin.size() == soup.at_end.size());
  out.clear();
  for (std::uint32_t face = 0; face < soup.faces.size(); ++face) out.push_back({swept_box(soup.triangle(face)), face});
}

template <class SweptFaces>
void drop_far(SweptFaces& faces, const WorldBox& other, double margin_m) {
  std::erase_if(faces, [&](const auto& swept) { return !boxes_near(swept.box, other, margin_m); });
}

int longest_axis(const WorldBox& box) {
  Eigen::Index axis = 0;
  (box.hi - box.lo).maxCoeff(&axis);
  return static_cast<int>(axis);
}

// Calls visit(a, b) for all pairs of boxes that are near along an axis. Both lists are sorted by their lower sides, so
// of two near boxes the one that begins first finds the other before its own upper side and the margin are passed.
template <class SweptFaces, class Visit>
void for_near_pairs(const SweptFaces& a, const SweptFaces& b, int axis, double margin_m, Visit visit) {
  const auto for_those_after = [&](const auto& swept, const SweptFaces& others, std::size_t first, auto found) {
    for (std::size_t i = first; i < others.size(); ++i) {
      if (others[i].box.lo[axis] - swept.box.hi[axis] > margin_m) break;
      found(others[i]);
    }
  };
  std::size_t of_a = 0, of_b = 0;
  while (of_a < a.size() && of_b < b.size()) {
    if (a[of_a].box.lo[axis] <= b[of_b].box.lo[axis]) {
      for_those_after(a[of_a], b, of_b, [&](const auto& other) { visit(a[of_a], other); });
      ++of_a;
    } else {
      for_those_after(b[of_b], a, of_a, [&](const auto& other) { visit(other, b[of_b]); });
      ++of_b;
    }
  }
}

PolygonPair polygons_of(const SoupStep& a, const SoupStep& b, const FacePair& faces) {
  return {a.faces[faces.a].polygon, b.faces[faces.b].polygon};
}

}  // namespace

Triangle SoupStep::triangle_at_begin(std::uint32_t face) const {
  const auto& c = faces[face].corners;
  assert(c[0] < at_begin.size() && c[1] < at_begin.size() && c[2] < at_begin.size());
  return {at_begin[c[0]], at_begin[c[1]], at_begin[c[2]]};
}

MovingTriangle SoupStep::triangle(std::uint32_t face) const {
  const auto& c = faces[face].corners;
  assert(c[0] < at_begin.size() && c[1] < at_begin.size() && c[2] < at_begin.size());
  return {MovingPoint{at_begin[c[0]], at_end[c[0]]}, MovingPoint{at_begin[c[1]], at_end[c[1]]},
          MovingPoint{at_begin[c[2]], at_end[c[2]]}};
}

// Finds the candidates: all pairs whose boxes come as near as the margin, each with the time at which they do.
void SoupImpactQuery::sweep(const SoupStep& a, const SoupStep& b, double margin_m) {
  sweep_faces(a, swept_a_);
  sweep_faces(b, swept_b_);
  drop_far(swept_a_, box_of(swept_b_), margin_m);
  drop_far(swept_b_, box_of(swept_a_), margin_m);
  candidates_.clear();
  if (swept_a_.empty() || swept_b_.empty()) return;
  WorldBox all = box_of(swept_a_);
  all.merge(box_of(swept_b_));
  const int axis = longest_axis(all);
  for (auto* const faces : {&swept_a_, &swept_b_}) {
    std::ranges::sort(*faces, {},
                      [axis](const SweptFace& swept) { return std::tuple(swept.box.lo[axis], swept.face); });
  }
  for_near_pairs(swept_a_, swept_b_, axis, margin_m, [&](const SweptFace& of_a, const SweptFace& of_b) {
    if (!boxes_near(of_a.box, of_b.box, margin_m)) return;
    const auto from = first_box_contact(a.triangle(of_a.face), b.triangle(of_b.face), margin_m);
    const FacePair faces{of_a.face, of_b.face};
    if (from) candidates_.push_back({*from, polygons_of(a, b, faces), faces});
  });
  std::ranges::sort(candidates_);
}

// The boxes of a pair that touches at 0 meet then, and those candidates come first.
void SoupImpactQuery::find_touching(const SoupStep& a, const SoupStep& b) {
  touching_.clear();
  OrientationCounters counters;
  for (const Candidate& candidate : candidates_) {
    if (candidate.from > 0.0) break;
    const FacePair& faces = candidate.faces;
    if (touch(a.triangle_at_begin(faces.a), b.triangle_at_begin(faces.b), counters)) touching_.push_back(faces);
  }
}

SoupImpact SoupImpactQuery::first_impact(const SoupStep& a, const SoupStep& b, const SoupImpactOptions& options) {
  assert(options.margin_m >= 0.0 && options.tolerance_m > 0.0);
  sweep(a, b, options.margin_m);
  find_touching(a, b);
  SoupImpact first;
  first.candidates = static_cast<std::uint32_t>(candidates_.size());
  if (!touching_.empty()) {
    first.state = SoupImpactState::kTouching;
    first.fraction = 0.0;
    first.faces = touching_.front();
    first.polygons = polygons_of(a, b, first.faces);
    return first;
  }
  MovingTriangleOptions of_pair{.margin_m = options.margin_m,
                                .tolerance_m = options.tolerance_m,
                                .max_steps = options.max_steps,
                                .max_iterations = options.max_iterations};
  for (const Candidate& candidate : candidates_) {
    if (candidate.from > first.fraction) break;
    of_pair.last = first.fraction;
    const LinearImpact found =
        pair_query_.first_impact(a.triangle(candidate.faces.a), b.triangle(candidate.faces.b), of_pair);
    first.iterations += found.iterations;
    if (found.state == ImpactState::kSeparated) continue;
    assert(found.time <= first.fraction);
    const auto state = found.state == ImpactState::kHit ? SoupImpactState::kHit : SoupImpactState::kUnsure;
    // At the same fraction a hit is the answer rather than one that is unsure.
    const auto rank = [](const SoupImpact& impact) {
      return std::tuple(impact.fraction, impact.state, impact.polygons, impact.faces);
    };
    SoupImpact next = first;
    next.state = state;
    next.fraction = found.time;
    next.polygons = candidate.polygons;
    next.faces = candidate.faces;
    if (first.state == SoupImpactState::kSeparated || rank(next) < rank(first)) first = next;
  }
  return first;
}

}  // namespace peerd::collision
