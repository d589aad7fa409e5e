#pragma once
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/time.hpp"
#include "replication/settings/grid/region_grid.hpp"

namespace peerd::replication {

// Everything within radius_m of center [m, world] matters to this peer.
struct Area {
  Vec3 center;
  double radius_m;
};

// The reluctance with which regions are left.
struct Hysteresis {
  // Regions are joined when an area comes within margin_m, and left beyond twice that. An object that is up to
  // margin_m outside of the cell in which it was last published need not be published anew; this is why an area is
  // grown by it.
  double margin_m = 1.0;
  Duration stay = std::chrono::seconds(
      1);  // a joined region stays joined for at least this long, so no region is joined more often than once in it
};

// The cutting of a session's scene into regions. All peers must have the same grid.
struct RegionSettings {
  double cell_m = 0.0;  // the edge of a cell; 0: the scene is not cut, everything is kWholeScene
  std::array<std::uint32_t, 3> regions{8, 1, 8};  // along x, y, z
  Hysteresis hysteresis;
  // Regions are joined so long before a peer's own movement makes them matter; none: as long as it takes to receive
  // their states, by measured latencies.
  std::optional<Duration> lookahead;
  double fastest_m_s = 30.0;  // no object that own objects could collide with moves faster

  // A world's hash with the cutting in it: peers that cut the scene otherwise would miss each other's updates, so they
  // are in another session. The world's own hash where the scene is not cut.
  [[nodiscard]] std::uint64_t session_hash(std::uint64_t world_hash) const;
  [[nodiscard]] RegionGrid grid() const { return cell_m > 0.0 ? RegionGrid(cell_m, regions) : RegionGrid(); }
};

// The regions that a peer listens to, as its areas of interest move.
class Interest {
 public:
  struct Change {
    RegionId region;
    bool joined;  // else left
  };

  Interest(const RegionGrid& grid, const Hysteresis& hysteresis) : grid_(grid), hysteresis_(hysteresis) {}

  // The regions to join, then those to leave, each in ascending order; the change has been made once this returns.
  [[nodiscard]] std::vector<Change> follow(SimTime now, std::span<const Area> areas);
  // Does the same for a peer that listens to everything.
  [[nodiscard]] std::vector<Change> follow_all(SimTime now);

  [[nodiscard]] bool joined(RegionId region) const { return since_.contains(region); }
  // Whether an object at that position is published in a region that this peer listens to; always true where the scene
  // is not cut.
  [[nodiscard]] bool receives(const Vec3& position) const { return !grid_.cuts() || joined(grid_.region_of(position)); }
  [[nodiscard]] const std::map<RegionId, SimTime>& regions() const {
    return since_;
  }  // the joined regions, with the time at which each was joined
  // Session time has stepped: all regions count as joined at `now`.
  void restart_at(SimTime now);

 private:
  [[nodiscard]] std::vector<Change> change(SimTime now, std::span<const RegionId> wanted,
                                           std::span<const RegionId> kept);

  RegionGrid grid_;
  Hysteresis hysteresis_;
  std::map<RegionId, SimTime> since_;
};

}  // namespace peerd::replication
