#include "peerd/lab/live/crossing.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <vector>

#include "collision/contact/box_contact.hpp"
#include "collision/contact/contact_time.hpp"
#include "collision/contact/mesh_contact.hpp"
#include "collision/contact/separating_axis.hpp"
#include "collision/query/collect_faces.hpp"

namespace peerd {
namespace {

using collision::Body, collision::ConvexPiece, collision::MovingBody, collision::Solid;

constexpr double kUnbounded_m = std::numeric_limits<double>::infinity();
// Two pieces with more pairs of edges, or two bodies with more pairs of pieces, take longer than their polygons.
constexpr std::size_t kEdgePairsMax = 1024, kPiecePairsMax = 64;

// How far the points of one piece are outside of another one, in whose frame they are given; +inf for one without an
// inside.
double sticks_out_m(const std::vector<Vec3>& points, const ConvexPiece& piece) {
  if (piece.faces.size() == 1) return kUnbounded_m;
  double most = -kUnbounded_m;
  for (std::size_t i = 0; i < piece.faces.size(); ++i) {
    const Vec3& n = piece.face_normals[i];
    most = std::max(
        most, collision::extent_along(n, points).high - collision::dot(n, piece.vertices[piece.faces[i].front()]));
  }
  return most;
}

std::vector<Vec3> points_of(const ConvexPiece& piece, const Pose& from, const Pose& to) {
  std::vector<Vec3> points;
  for (const Vec3& v : piece.vertices) points.push_back(to.orientation.conjugate() * (from * v - to.position));
  return points;
}

double depth_of_pieces_m(const ConvexPiece& piece_a, const KinematicState& a, const Mat3& R_a,
                         const ConvexPiece& piece_b, const KinematicState& b, const Mat3& R_b) {
  const Solid solid_a{piece_a.vertices, &piece_a, piece_a.shape}, solid_b{piece_b.vertices, &piece_b, piece_b.shape};
  double widest = -kUnbounded_m;
  for_each_gap(solid_a, R_a, solid_b, R_b, a.position - b.position, [&](const Vec3&, double gap_m) {
    widest = std::max(widest, gap_m);
    return widest < 0.0;  // else they are apart
  });
  if (widest >= 0.0) return 0.0;
  const double out = std::min(sticks_out_m(points_of(piece_a, a.pose(), b.pose()), piece_b),
                              sticks_out_m(points_of(piece_b, b.pose(), a.pose()), piece_a));
  return std::max(0.0, std::min(-widest, out));
}

double depth_of_boxes_m(const WorldBox& a, const WorldBox& b) {
  if (a.is_empty() || b.is_empty()) return 0.0;
  double overlap = kUnbounded_m, a_out = -kUnbounded_m, b_out = -kUnbounded_m;
  for (int k = 0; k < 3; ++k) {
    overlap = std::min({overlap, a.hi[k] - b.lo[k], b.hi[k] - a.lo[k]});
    a_out = std::max({a_out, b.lo[k] - a.lo[k], a.hi[k] - b.hi[k]});
    b_out = std::max({b_out, a.lo[k] - b.lo[k], b.hi[k] - a.hi[k]});
  }
  return std::max(0.0, std::min({overlap, a_out, b_out}));
}

double distance_m(const collision::Triangle& t, const Vec3& p) {
  const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]);
  bool over = !n.isZero(0.0);
  double least = kUnbounded_m;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 edge = t[(i + 1) % 3] - t[i], from = p - t[i];
    over = over && n.cross(edge).dot(from) >= 0.0;
    const double size = edge.squaredNorm();
    least = std::min(least, (from - (size > 0.0 ? std::clamp(edge.dot(from) / size, 0.0, 1.0) : 0.0) * edge).norm());
  }
  return over ? std::abs(n.normalized().dot(p - t[0])) : least;
}

double depth_in_surface_m(const MovingBody& sphere, const MovingBody& other) {
  collision::Surface& surface = *other.body.surface;
  const double radius = sphere.body.sphere->radius_m;
  const Vec3 center = other.motion.orientation.conjugate() *
                      (sphere.motion.pose() * sphere.body.sphere->center - other.motion.position);
  const Vec3 reach = Vec3::Constant(radius);
  thread_local std::vector<std::uint32_t> faces;
  collect_faces(surface.tree(), WorldBox{center - reach, center + reach}, faces);
  double nearest = radius;
  for (const std::uint32_t face : faces) nearest = std::min(nearest, distance_m(surface.soup().triangle(face), center));
  return radius - nearest;
}

bool are_few(const Body& a, const Body& b) {
  if (!a.not_convex_reason.empty() || !b.not_convex_reason.empty()) return false;
  if (a.pieces.size() * b.pieces.size() > kPiecePairsMax) return false;
  const auto edges = [](const Body& body) {
    std::size_t most = 0;
    for (const ConvexPiece& piece : body.pieces) most = std::max(most, piece.edge_axes.size());
    return most;
  };
  return edges(a) * edges(b) <= kEdgePairsMax;
}

}  // namespace

Crossing crossing(const MovingBody& a, const MovingBody& b, CollisionType type) {
  if (type == CollisionType::kBox) return {depth_of_boxes_m(tight_box(a), tight_box(b))};
  assert(has_exact_answer(a.body, b.body));
  if (a.body.sphere && b.body.sphere) {
    const double r_a = a.body.sphere->radius_m, r_b = b.body.sphere->radius_m;
    const double d = (a.motion.pose() * a.body.sphere->center - b.motion.pose() * b.body.sphere->center).norm();
    return {std::max(0.0, std::min(r_a + r_b - d, d - std::abs(r_a - r_b)))};
  }
  if (!a.body.surface || !b.body.surface || a.body.vertices().empty() || b.body.vertices().empty()) return {};
  if (a.body.sphere) return {depth_in_surface_m(a, b)};
  if (b.body.sphere) return {depth_in_surface_m(b, a)};
  if (!are_few(a.body, b.body)) return {touch_depth_m(a, b), true};
  const Mat3 R_a = a.motion.orientation.toRotationMatrix(), R_b = b.motion.orientation.toRotationMatrix();
  Crossing deepest;
  for (const ConvexPiece& piece_a : a.body.pieces) {
    for (const ConvexPiece& piece_b : b.body.pieces) {
      deepest.depth_m = std::max(deepest.depth_m, depth_of_pieces_m(piece_a, a.motion, R_a, piece_b, b.motion, R_b));
    }
  }
  return deepest;
}

}  // namespace peerd
