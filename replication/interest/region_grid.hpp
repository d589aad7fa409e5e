#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "core/ids.hpp"
#include "core/math.hpp"

namespace peerd::replication {

// The session's own region: hellos, decisions, and everything where the scene is not cut into regions.
inline constexpr RegionId kWholeScene{0};

// Cuts space into cubic cells and gives each a region, out of so many that there is one multicast group for each. The
// regions repeat: along an axis with n of them, cells n apart share one, so that a scene of any size needs no more
// groups than are configured. Who listens to a region then also hears what is n cells away, which costs bytes and
// nothing else. An axis with 1 is not cut: by default the height, for scenes are flat and groups are few.
//
// Pure: all peers with the same settings put a position into the same region, to the last bit.
class RegionGrid {
 public:
  RegionGrid() = default;  // not cut
  // cell_m > 0; regions >= 1 along x, y, z.
  RegionGrid(double cell_m, const std::array<std::uint32_t, 3>& regions);

  [[nodiscard]] bool cuts() const { return cell_m_ > 0.0; }
  // How many regions there are, kWholeScene aside; they are 1 .. count(). 0: not cut.
  [[nodiscard]] std::uint32_t count() const;
  [[nodiscard]] RegionId region_of(const Vec3& position) const;
  // Those that hold a position no farther than radius_m from `center`, sorted. Distances count along the axes that are
  // cut: a grid that knows no height makes a ball a pillar. Costs as many steps as there are regions along each axis,
  // and one for each region found, whatever the radius.
  [[nodiscard]] std::vector<RegionId> touched(const Vec3& center, double radius_m) const;
  // How far [m] `position` is outside of the cell that holds `home`; 0 inside.
  [[nodiscard]] double outside_m(const Vec3& position, const Vec3& home) const;

 private:
  double cell_m_ = 0.0;
  std::array<std::uint32_t, 3> regions_{1, 1, 1};
};

}  // namespace peerd::replication
