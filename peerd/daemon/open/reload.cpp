#include "peerd/daemon/open/reload.hpp"

#include <algorithm>
#include <numbers>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"
#include "peerd/peer/config/changed_keys.hpp"

namespace peerd {
namespace {

const config::PeerSettings* find_peer(const config::RunSettings& run, const std::string& name) {
  const auto found = std::ranges::find(run.peers, name, &config::PeerSettings::name);
  return found == run.peers.end() ? nullptr : &*found;
}

std::string viewpoint_request(const config::ViewpointSettings& v) {
  constexpr double kRadians = std::numbers::pi / 180.0;
  const Eigen::Vector3d axis(v.axis.at(0), v.axis.at(1), v.axis.at(2));
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(v.angle_deg * kRadians, axis.normalized()));
  nlohmann::json request{{"do", "viewpoint"},
                         {"position_m", v.position},
                         {"orientation_xyzw", {turned.x(), turned.y(), turned.z(), turned.w()}},
                         {"field_of_view_rad", v.field_of_view_deg * kRadians},
                         {"aspect", v.aspect}};
  if (!v.object.empty()) request["object"] = v.object;
  return json_line(request);
}

// Requests for the paths that one list has and the other one does not. False: some of them is a pattern, which only the
// start of a peer resolves.
bool add_requests(const char* what, const std::vector<config::NodePattern>& has,
                  const std::vector<config::NodePattern>& has_not, std::vector<std::string>& requests) {
  for (const config::NodePattern& path : has) {
    if (std::ranges::find(has_not, path.text, &config::NodePattern::text) != has_not.end()) continue;
    if (!path.is_path()) return false;
    requests.push_back(json_line({{"do", what}, {"path", path.text}}));
  }
  return true;
}

}  // namespace

Reload reload_of(const config::RunSettings& before, const config::RunSettings& after, const std::string& peer) {
  Reload reload;
  const config::PeerSettings* const old = find_peer(before, peer);
  const config::PeerSettings* const now = find_peer(after, peer);
  const std::string owns = "peer." + peer + ".owns", viewpoint = "peer." + peer + ".viewpoint.";
  bool looks_elsewhere = false;
  for (const std::string& key : config::changed_keys(before.toml, after.toml)) {
    std::vector<std::string> requests;
    bool counts_now = key.starts_with("log.");
    if (old != nullptr && now != nullptr && key == owns) {
      counts_now = add_requests("release", old->owns, now->owns, requests) &&
                   add_requests("own", now->owns, old->owns, requests);
    } else if (now != nullptr && now->viewpoint && key.starts_with(viewpoint) && key != viewpoint + "far_m") {
      counts_now = looks_elsewhere = true;
    }
    (counts_now ? reload.now : reload.later).push_back(key);
    if (counts_now) reload.requests.insert(reload.requests.end(), requests.begin(), requests.end());
  }
  if (looks_elsewhere) reload.requests.push_back(viewpoint_request(*now->viewpoint));
  return reload;
}

}  // namespace peerd
