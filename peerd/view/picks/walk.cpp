#include "peerd/view/picks/walk.hpp"

#include <algorithm>
#include <limits>

namespace peerd::view {
namespace {

constexpr double kGravity_m_s2 = 9.80665;
// A body that slides leaves the wall by that part of what presses it there, so that no rounding holds it.
constexpr double kAside = 1.0 / (1 << 20);
constexpr double kBeside = 0.7;  // the places of rays across the way [radii]

struct Way {
  double free_m = 0;           // without a wall
  Vec3 normal = Vec3::Zero();  // of the wall at its end; of who walks, level
};

// How far a round body goes from there before it touches the plane of a wall, which is perpendicular to the normal.
double way_to(const Vec3& wall, const Vec3& normal, const Vec3& eye, const Vec3& ahead, double radius_m) {
  const double away_m = (eye - wall).dot(normal), nearing = -ahead.dot(normal);
  return nearing > 0.0 ? std::max(0.0, away_m - radius_m) / nearing : std::numeric_limits<double>::infinity();
}

std::expected<Way, std::string> free_way(const RayCaster& cast, const AvatarSize& size, const Vec3& eye,
                                         const Vec3& ahead, double wanted_m, bool level) {
  const Vec3 across_way(-ahead.z(), 0.0, ahead.x());
  const Vec3 beside = across_way.squaredNorm() > 0.0 ? across_way.normalized() : Vec3(Vec3::UnitX());
  const double knee_m = std::min(size.step_m, size.height_m) - size.height_m;
  Way way{wanted_m, Vec3::Zero()};
  for (const double height_m : {0.0, knee_m / 2.0, knee_m}) {
    const Vec3 middle = eye + Vec3(0.0, height_m, 0.0);
    for (const double across : {0.0, -kBeside, kBeside}) {
      const Vec3 from = middle + across * size.radius_m * beside;
      const auto hit = cast(from, ahead);
      if (!hit) return std::unexpected(hit.error());
      if (!*hit) continue;
      Vec3 normal = (*hit)->normal;
      if (level) normal.y() = 0.0;
      if (normal.squaredNorm() == 0.0) continue;  // a ceiling or a floor, which nobody who goes level meets
      normal.normalize();
      const double free_m = way_to(from + (*hit)->distance_m * ahead, normal, middle, ahead, size.radius_m);
      if (free_m < way.free_m) way = {free_m, normal};
    }
  }
  return way;
}

}  // namespace

std::expected<Stand, std::string> walk(const RayCaster& cast, const AvatarSize& size, const Stride& stride) {
  Stand stand{stride.eye, false, 0.0};
  Vec3 left = stride.by;
  if (stride.falls) left.y() = 0.0;
  for (int turn = 0; turn < 2 && left.squaredNorm() > 0.0; ++turn) {
    const double wanted_m = left.norm();
    const Vec3 ahead = left / wanted_m;
    const auto way = free_way(cast, size, stand.eye, ahead, wanted_m, stride.falls);
    if (!way) return std::unexpected(way.error());
    stand.eye += way->free_m * ahead;
    left = (wanted_m - way->free_m) * ahead;
    left -= (1.0 + kAside) * left.dot(way->normal) * way->normal;
  }
  if (!stride.falls) return stand;
  const double step_m = std::min(size.step_m, size.height_m);
  const auto below = cast(stand.eye - Vec3(0.0, size.height_m - step_m, 0.0), -Vec3::UnitY());
  if (!below) return std::unexpected(below.error());
  if (!*below) return stand;
  const double gap_m = (*below)->distance_m - step_m;
  const double fall_m_s = stride.fall_m_s + kGravity_m_s2 * stride.for_s;
  stand.on_ground = gap_m <= fall_m_s * stride.for_s;
  stand.eye.y() -= stand.on_ground ? gap_m : fall_m_s * stride.for_s;
  stand.fall_m_s = stand.on_ground ? 0.0 : fall_m_s;
  return stand;
}

}  // namespace peerd::view
