#include "peerd/lab/measure/lookup.hpp"

#include <algorithm>
#include <tuple>

namespace peerd::measure {

std::string peer_name(const RunRecord& run, PeerId peer) {
  const auto it = std::ranges::find(run.peers, peer, &PeerInfo::peer);
  return it != run.peers.end() ? it->name : "#" + std::to_string(peer.value);
}

std::string object_path(const RunRecord& run, ObjectId object) {
  const auto it = std::ranges::lower_bound(run.objects, object, {}, &ObjectInfo::object);
  if (it != run.objects.end() && it->object == object) return it->path;
  const auto scene = run.scene_paths.find(object);
  return scene != run.scene_paths.end() ? scene->second : "#" + std::to_string(object.packed());
}

bool same_side(const ContactRow& a, const ContactRow& b) {
  const double along = a.normal.dot(b.normal);
  return (a.collider == b.collider ? along : -along) > 0.0 || (a.normal.isZero(0.0) && b.normal.isZero(0.0));
}

bool was_present(const PeerInfo& peer, double t_s) {
  return peer.there_s.empty() || std::ranges::any_of(peer.there_s, [&](const auto& presence) {
           return presence.first <= t_s && t_s <= presence.second;
         });
}

std::span<const GhostSample> ghost_samples_of(const RunRecord& run, PeerId observer, ObjectId object) {
  const auto series = [](const GhostSample& s) { return std::tuple(s.observer, s.object); };
  const auto found = std::ranges::equal_range(run.ghost_samples, std::tuple(observer, object), {}, series);
  return {found.begin(), found.end()};
}

}  // namespace peerd::measure
