#pragma once
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/time.hpp"
#include "replication/interest/region_grid.hpp"

namespace peerd::replication {

// Everything within radius_m of center [m, world] matters.
struct Area {
  Vec3 center;
  double radius_m;
};

// How eagerly regions are left.
struct Hysteresis {
  // Regions are joined when an area comes within margin_m, and left beyond twice that. An object that is up to margin_m
  // outside of the cell that it was last told in need not be told anew; this is why an area is grown by it.
  double margin_m = 1.0;
  Duration stay = std::chrono::seconds(1);  // at least, once joined: no region is joined more often than once in this
};

// How a session's scene is cut into regions. All peers must say the same of the grid.
struct RegionSettings {
  double cell_m = 0.0;                            // edge of a cell; 0: not cut, everything is kWholeScene
  std::array<std::uint32_t, 3> regions{8, 1, 8};  // along x, y, z
  Hysteresis hysteresis;
  // Regions are joined so long before a peer's own movement makes them matter; none: as long as their states take to
  // come, by what is measured.
  std::optional<Duration> lookahead;
  double fastest_m_s = 30.0;  // nothing that own objects could collide with moves faster

  // Peers that cut the scene otherwise would miss each other's updates, so they are in another session: a world's hash
  // with the cutting in it; the world's own where it is not cut.
  [[nodiscard]] std::uint64_t session_hash(std::uint64_t world_hash) const;
  [[nodiscard]] RegionGrid grid() const { return cell_m > 0.0 ? RegionGrid(cell_m, regions) : RegionGrid(); }
};

// Which regions a peer listens to, as its areas of interest move.
class Interest {
 public:
  struct Change {
    RegionId region;
    bool joined;  // else left
  };

  Interest(const RegionGrid& grid, const Hysteresis& hysteresis) : grid_(grid), hysteresis_(hysteresis) {}

  // What to join, then what to leave, each in ascending order; done once this returns.
  [[nodiscard]] std::vector<Change> follow(SimTime now, std::span<const Area> areas);
  // The same for who wants to hear everything.
  [[nodiscard]] std::vector<Change> follow_all(SimTime now);

  [[nodiscard]] bool joined(RegionId region) const { return since_.contains(region); }
  // Whether what is there is told of in a region that this peer listens to; always where nothing is cut.
  [[nodiscard]] bool receives(const Vec3& position) const { return !grid_.cuts() || joined(grid_.region_of(position)); }
  [[nodiscard]] const std::map<RegionId, SimTime>& regions() const { return since_; }  // and when each was joined
  // Time has stepped: all count as joined at `now`.
  void restart_at(SimTime now);

 private:
  [[nodiscard]] std::vector<Change> change(SimTime now, std::span<const RegionId> wanted,
                                           std::span<const RegionId> kept);

  RegionGrid grid_;
  Hysteresis hysteresis_;
  std::map<RegionId, SimTime> since_;
};

}  // namespace peerd::replication
