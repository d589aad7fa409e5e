#include "replication/settings/grid/region_grid.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace peerd::replication {
namespace {

// The number of a cell along an axis, from the origin. It is exact in binary64 for positions up to 1e12 m and cells
// from 1e-3 m on.
double cell_of(double x, double cell_m) { return std::floor(x / cell_m); }

// The region, 0 .. n - 1, of an axis to which a cell belongs.
std::uint32_t region_along(double cell, std::uint32_t n) {
  assert(n >= 1);
  const double rest = std::fmod(cell, n);  // exact
  return static_cast<std::uint32_t>(rest < 0.0 ? rest + n : rest);
}

struct Near {
  std::uint32_t region;
  double distance_m;
};

// The regions along one axis of which some cell is within radius_m of x, with the distance of the nearest one.
std::vector<Near> near_along(double x, double radius_m, double cell_m, std::uint32_t n) {
  assert(cell_m > 0.0 && n >= 1);
  if (n == 1) return {{0, 0.0}};
  const double cell = cell_of(x, cell_m);
  const std::uint32_t here = region_along(cell, n);
  std::vector<Near> near;
  for (std::uint32_t region = 0; region < n; ++region) {
    const std::uint32_t ahead = (region + n - here) % n, behind = n - ahead;  // in cells
    double distance_m = 0.0;
    if (ahead > 0) distance_m = std::min((cell + ahead) * cell_m - x, x - (cell - behind + 1.0) * cell_m);
    if (distance_m <= radius_m) near.push_back({region, std::max(distance_m, 0.0)});
  }
  return near;
}

}  // namespace

RegionGrid::RegionGrid(double cell_m, const std::array<std::uint32_t, 3>& regions)
    : cell_m_(cell_m), regions_(regions) {
  assert(cell_m > 0.0 && std::ranges::min(regions) >= 1);
}

std::uint32_t RegionGrid::count() const { return cuts() ? regions_[0] * regions_[1] * regions_[2] : 0; }

RegionId RegionGrid::region_of(const Vec3& position) const {
  if (!cuts()) return kWholeScene;
  std::uint32_t region = 0;
  for (int axis = 2; axis >= 0; --axis) {
    const std::uint32_t n = regions_[static_cast<std::size_t>(axis)];
    region = region * n + (n == 1 ? 0 : region_along(cell_of(position[axis], cell_m_), n));
  }
  return RegionId{region + 1};
}

std::vector<RegionId> RegionGrid::touched(const Vec3& center, double radius_m) const {
  if (!cuts()) return {};
  std::array<std::vector<Near>, 3> near;
  for (int axis = 0; axis < 3; ++axis) {
    const auto a = static_cast<std::size_t>(axis);
    near[a] = near_along(center[axis], radius_m, cell_m_, regions_[a]);
  }
  std::vector<RegionId> found;  // in order: x counts fastest, as in region_of()
  for (const Near& z : near[2]) {
    for (const Near& y : near[1]) {
      for (const Near& x : near[0]) {
        if (Vec3(x.distance_m, y.distance_m, z.distance_m).norm() > radius_m) continue;
        found.push_back(RegionId{(z.region * regions_[1] + y.region) * regions_[0] + x.region + 1});
      }
    }
  }
  assert(std::ranges::is_sorted(found));
  return found;
}

double RegionGrid::outside_m(const Vec3& position, const Vec3& home) const {
  Vec3 outside = Vec3::Zero();
  for (int axis = 0; cuts() && axis < 3; ++axis) {
    if (regions_[static_cast<std::size_t>(axis)] == 1) continue;
    const double low = cell_of(home[axis], cell_m_) * cell_m_;
    outside[axis] = std::max({0.0, low - position[axis], position[axis] - (low + cell_m_)});
  }
  return outside.norm();
}

}  // namespace peerd::replication
