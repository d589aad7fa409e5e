#include "peerd/view/picks/surroundings.hpp"

#include <cmath>
#include <cstddef>
#include <set>

#include <nlohmann/json.hpp>

#include "replication/peer/peer.hpp"

namespace peerd::view {
namespace {

using nlohmann::ordered_json;

constexpr std::size_t kRegionsMax = 4096, kObjectsMax = 1000;

ordered_json regions_json(const PeerNode& node, SimTime at) {
  const replication::Peer& peer = node.peer();
  const replication::RegionSettings& settings = peer.config().regions;
  const replication::RegionGrid grid = settings.grid();
  ordered_json joined = ordered_json::array(), published = ordered_json::array();
  for (const auto& [region, since] : peer.interest().regions()) {
    if (joined.size() < kRegionsMax) joined.push_back(region.value);
  }
  std::set<std::uint32_t> own;
  if (grid.cuts()) {
    for (const auto& [id, owner] : peer.owners()) {
      if (owner == peer.id() && own.size() < kRegionsMax) own.insert(grid.region_of(peer.truth(id, at).position).value);
    }
  }
  for (const std::uint32_t region : own) published.push_back(region);
  return {{"cell_m", settings.cell_m},
          {"counts", settings.regions},
          {"margin_m", settings.hysteresis.margin_m},
          {"joined", std::move(joined)},
          {"published", std::move(published)}};
}

// The sphere of an object reaches so far as the object goes within the time that counts as close: where no two spheres
// of two peers meet, no time to contact is below it.
ordered_json proximity_json(const PeerNode& node, SimTime at, std::span<const ObjectId> movers) {
  const replication::Peer& peer = node.peer();
  const replication::PublishPolicy& policy = peer.config().policy;
  ordered_json objects = ordered_json::array();
  std::size_t left_out = 0;
  for (std::size_t i = 0; i < movers.size(); ++i) {
    const ObjectId id = movers[i];
    const collision::Body* const body = peer.model().body(id);
    if (body == nullptr || peer.owner(id) == kNobody || peer.model().pairs_of(id).empty() || !peer.receives(id))
      continue;
    if (objects.size() == kObjectsMax) {
      ++left_out;
      continue;
    }
    const bool own = peer.owner(id) == peer.id();
    const double speed_m_s = (own ? peer.truth(id, at) : peer.ghost(id, at)).velocity.norm();
    const double usual_m = policy.error_threshold_m.value_or(node.scene().object(id).distance_threshold_m);
    const auto threshold_m = peer.threshold_m(id);
    objects.push_back({{"node", i},
                       {"center_m", {body->center.x(), body->center.y(), body->center.z()}},
                       {"radius_m", body->radius_m},
                       {"range_m", speed_m_s * policy.close_proximity_s},
                       {"tight", threshold_m && *threshold_m < usual_m}});
  }
  return {{"tracks", policy.track_proximity},
          {"close_s", policy.close_proximity_s},
          {"tight_m", policy.tight_threshold_m},
          {"objects", std::move(objects)},
          {"left_out", left_out}};
}

}  // namespace

ordered_json surroundings(const PeerNode& node, SimTime at, std::span<const ObjectId> movers) {
  return {{"ok", true}, {"regions", regions_json(node, at)}, {"proximity", proximity_json(node, at, movers)}};
}

}  // namespace peerd::view
