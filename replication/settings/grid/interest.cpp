#include "replication/settings/grid/interest.hpp"

#include <algorithm>
#include <bit>
#include <cassert>

#include "core/fnv1a.hpp"

namespace peerd::replication {
namespace {

std::vector<RegionId> touched(const RegionGrid& grid, std::span<const Area> areas, double grown_by_m) {
  std::vector<RegionId> all;
  for (const Area& area : areas) {
    assert(!(area.radius_m < 0.0));
    const std::vector<RegionId> some = grid.touched(area.center, area.radius_m + grown_by_m);
    all.insert(all.end(), some.begin(), some.end());
  }
  std::ranges::sort(all);
  const auto rest = std::ranges::unique(all);
  all.erase(rest.begin(), rest.end());
  return all;
}

}  // namespace

// The hash goes on with that of the world's files, which is FNV-1a 64 as well.
std::uint64_t RegionSettings::session_hash(std::uint64_t world_hash) const {
  if (cell_m == 0.0) return world_hash;
  std::uint64_t hash = world_hash;
  for (const std::uint64_t part :
       {std::bit_cast<std::uint64_t>(cell_m), std::bit_cast<std::uint64_t>(hysteresis.margin_m),
        std::uint64_t{regions[0]}, std::uint64_t{regions[1]}, std::uint64_t{regions[2]}}) {
    hash = fnv1a(hash, part);
  }
  return hash;
}

std::vector<Interest::Change> Interest::follow(SimTime now, std::span<const Area> areas) {
  return change(now, touched(grid_, areas, hysteresis_.margin_m), touched(grid_, areas, 2.0 * hysteresis_.margin_m));
}

std::vector<Interest::Change> Interest::follow_all(SimTime now) {
  std::vector<RegionId> all;
  for (std::uint32_t region = 1; region <= grid_.count(); ++region) all.push_back(RegionId{region});
  return change(now, all, all);
}

std::vector<Interest::Change> Interest::change(SimTime now, std::span<const RegionId> wanted,
                                               std::span<const RegionId> kept) {
  assert(std::ranges::is_sorted(wanted) && std::ranges::is_sorted(kept) && std::ranges::includes(kept, wanted));
  std::vector<Change> changes;
  for (const RegionId region : wanted) {
    if (since_.try_emplace(region, now).second) changes.push_back({region, true});
  }
  for (auto at = since_.begin(); at != since_.end();) {
    if (std::ranges::binary_search(kept, at->first) || now - at->second < hysteresis_.stay) {
      ++at;
    } else {
      changes.push_back({at->first, false});
      at = since_.erase(at);
    }
  }
  return changes;
}

void Interest::restart_at(SimTime now) {
  for (auto& [region, since] : since_) since = now;
}

}  // namespace peerd::replication
