#include "peerd/api/answer.hpp"

#include <nlohmann/json.hpp>

#include "peerd/api/request.hpp"
#include "replication/decision.hpp"

namespace peerd::api {
namespace {

using nlohmann::ordered_json;

ordered_json numbers(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

// Where the request's text comes back in it, it may be no UTF-8.
std::string line_of(const ordered_json& reply) {
  return reply.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

ordered_json good() { return {{"v", kVersion}, {"ok", true}}; }

ordered_json object_row(const PeerNode& node, SimTime t, ObjectId object, PeerId owner) {
  const replication::Peer& peer = node.peer();
  const bool own = owner == peer.id();
  const KinematicState s = own ? peer.truth(object, t) : peer.ghost(object, t);
  ordered_json row = {
      {"id", object.value},
      {"path", node.scene().path_of(object)},
      {"owner", owner.value},
      {"own", own},
      {"driven", own && node.drives(object)},
      {"outside", own && node.feeds(object)},
      {"position_m", numbers(s.position)},
      {"orientation_xyzw", {s.orientation.x(), s.orientation.y(), s.orientation.z(), s.orientation.w()}},
      {"velocity_m_s", numbers(s.velocity)},
      {"angular_velocity_rad_s", numbers(s.angular_velocity_body)}};
  if (!peer.holds(object)) row["heard"] = false;
  return row;
}

// Objects that somebody runs, from a number on. `next` is where to go on; null where this was the last.
void add_objects(ordered_json& reply, const PeerNode& node, HostTime now, const ObjectsRequest& request, bool own) {
  reply["objects"] = ordered_json::array();
  reply["next"] = nullptr;
  if (!node.peer().clock().synchronised()) return;  // nothing moves yet
  const SimTime t = node.peer().clock().to_session(now);
  const auto& owners = node.peer().owners();
  for (auto at = owners.lower_bound(ObjectId{request.from}); at != owners.end(); ++at) {
    const auto& [object, owner] = *at;
    if (owner == replication::kNobody || (own && owner != node.peer().id())) continue;
    if (reply["objects"].size() == request.count) {
      reply["next"] = object.value;
      return;
    }
    reply["objects"].push_back(object_row(node, t, object, owner));
  }
}

ordered_json status(PeerNode& node, HostTime now) {
  const replication::Peer& peer = node.peer();
  const auto& clock = peer.clock();
  const auto since = [&](std::optional<SimTime> begin) -> ordered_json {
    if (!begin || !clock.synchronised()) return nullptr;
    return to_seconds(clock.to_session(now) - *begin);
  };
  ordered_json reply = good();
  reply["peer"] = {{"id", peer.id().value}, {"name", node.name()}};
  reply["session"] = {
      {"joined", clock.synchronised()},
      {"time_s", clock.synchronised() ? ordered_json(to_seconds(clock.to_session(now).time_since_epoch()))
                                      : ordered_json(nullptr)},
      {"clock_error_ms", to_seconds(clock.error_bound()) * 1e3}};
  reply["world_time_s"] = since(peer.world_zero());
  reply["since_start_s"] = since(node.start());
  reply["members"] = ordered_json::array();
  for (const auto& [id, member] : peer.members().all()) {
    reply["members"].push_back({{"id", id.value}, {"name", member.name}, {"joined", member.synchronised}});
  }
  add_objects(reply, node, now, {}, /*own=*/true);
  reply["counters"] = node.log().counters;
  return reply;
}

ordered_json key_reply(const KeyReport& report, const Scene& scene) {
  ordered_json reply = good();
  reply["key"] = name_of(report.key);
  reply["done"] = report.done();
  reply["hits"] = report.hits;
  reply["consumed"] = report.consumed;
  if (!report.refused.empty()) reply["refused"] = report.refused;
  reply["changes"] = ordered_json::array();
  for (const KeyReport::Change& c : report.changes) {
    ordered_json& change = reply["changes"].emplace_back();
    change = {{"sensor", name_of_sensor(scene, c.sensor)},
              {"recipient", scene.path_of(c.recipient)},
              {"velocity_m_s", numbers(c.velocity_world)},
              {"absolute", c.absolute},
              {"done", c.refused.empty()}};
    if (!c.refused.empty()) change["refused"] = c.refused;
  }
  return reply;
}

ordered_json pose_reply(const feed::Outcome& outcome) {
  ordered_json reply = good();
  reply["done"] = outcome.refused.empty();
  reply["taken"] = outcome.taken;
  reply["refused"] = ordered_json::array();
  for (const auto& [object, why] : outcome.refused) {
    reply["refused"].push_back({{"object", object}, {"why", feed::sentence(why)}});
  }
  return reply;
}

}  // namespace

std::string refusal(const std::string& sentence) {
  return line_of({{"v", kVersion}, {"ok", false}, {"error", sentence}});
}

Answer answer(PeerNode& node, HostTime now, std::string_view line, Duration host_minus_wall) {
  const auto request = parse_request(line);
  if (!request) return {refusal(request.error())};
  if (const auto* key = std::get_if<KeyRequest>(&*request)) {
    return {line_of(key_reply(node.on_key(now, key->key), node.scene()))};
  }
  if (const auto* objects = std::get_if<ObjectsRequest>(&*request)) {
    ordered_json reply = good();
    add_objects(reply, node, now, *objects, /*own=*/false);
    return {line_of(reply)};
  }
  if (const auto* poses = std::get_if<PoseRequest>(&*request)) {
    const feed::Outcome outcome = node.on_poses(now, host_minus_wall, poses->poses);
    return {poses->reply ? line_of(pose_reply(outcome)) : ""};
  }
  if (std::holds_alternative<LeaveRequest>(*request)) return {line_of(good()), /*leave=*/true};
  return {line_of(status(node, now))};
}

void take_datagram(PeerNode& node, HostTime now, std::string_view datagram, Duration host_minus_wall) {
  const auto request = parse_request(datagram);
  if (!request) return node.refuse_poses(request.error());
  const auto* poses = std::get_if<PoseRequest>(&*request);
  if (poses == nullptr) return node.refuse_poses("by UDP \"do\" must be \"pose\"");
  (void)node.on_poses(now, host_minus_wall, poses->poses);
}

}  // namespace peerd::api
