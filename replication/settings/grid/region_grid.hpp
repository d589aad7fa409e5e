#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/ids.hpp"
#include "core/math.hpp"

namespace peerd::replication {

// The region of the session itself: hellos, decisions, and everything where the scene is not cut into regions.
inline constexpr RegionId kWholeScene{0};
// No region: by this the datagrams are numbered that go to the regions where their sender publishes (Message::nearby).
inline constexpr RegionId kNearby{0xFFFF'FFFF};

// Cuts space into cubic cells and gives each a region, out of so many that there is one multicast group for each. The
// regions repeat: along an axis with n of them, cells n apart share one, so that a scene of any size needs no more
// groups than are configured. A peer that listens to a region then also receives what is n cells away, which costs
// bytes and nothing else. An axis with 1 region is not cut: by default the height, for scenes are flat and groups are
// few.
//
// The grid is pure: all peers with the same settings put a position into the same region, to the last bit.
class RegionGrid {
 public:
  RegionGrid() = default;  // a grid that does not cut
  // cell_m > 0; regions >= 1 along x, y, z.
  RegionGrid(double cell_m, const std::array<std::uint32_t, 3>& regions);

  [[nodiscard]] bool cuts() const { return cell_m_ > 0.0; }
  // The number of regions without kWholeScene; they are 1 .. count(). 0: the scene is not cut.
  [[nodiscard]] std::uint32_t count() const;
  [[nodiscard]] RegionId region_of(const Vec3& position) const;
  // The regions that contain a position no farther than radius_m from `center`, sorted. Distances count along the axes
  // that are cut: where the height is not cut, a ball becomes a pillar. The cost is as many steps as there are regions
  // along each axis, and one for each region found, whatever the radius.
  [[nodiscard]] std::vector<RegionId> touched(const Vec3& center, double radius_m) const;
  // The distance [m] of `position` from the cell that contains `home`; 0 inside.
  [[nodiscard]] double outside_m(const Vec3& position, const Vec3& home) const;

 private:
  double cell_m_ = 0.0;
  std::array<std::uint32_t, 3> regions_{1, 1, 1};
};

}  // namespace peerd::replication
