#include "peerd/peer/control/answer.hpp"

#include <map>
#include <utility>

#include <nlohmann/json.hpp>

#include "core/writer/writer.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/peer/control/conflict_rows.hpp"
#include "peerd/peer/control/request.hpp"
#include "peerd/peer/feed/json_members.hpp"
#include "peerd/peer/node/edit_operation.hpp"
#include "replication/objects/contacts/decision.hpp"
#include "replication/physics/laws/motion_model.hpp"

namespace peerd::control {
namespace {

using nlohmann::ordered_json;

// The longest world of a reply [bytes].
constexpr std::size_t kWorldMax_bytes = std::size_t{4} << 20;

ordered_json numbers(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

ordered_json in_ms(std::optional<Duration> d) { return d ? ordered_json(to_seconds(*d) * 1e3) : ordered_json(nullptr); }

// A reply may repeat text of the request, which may not be UTF-8: such bytes are replaced.
std::string line_of(const ordered_json& reply) { return json_line(reply); }

ordered_json good() { return {{"v", feed::kMessageVersion}, {"ok", true}}; }

ordered_json object_row(const PeerNode& node, HostTime now, ObjectId object, PeerId owner) {
  const replication::Peer& peer = node.peer();
  const SimTime t = peer.clock().to_session(now);
  const bool own = owner == peer.id();
  const KinematicState s = own ? peer.truth(object, t) : peer.ghost(object, t);
  ordered_json row = {
      {"id", object.packed()},
      {"path", node.scene().path_of(object)},
      {"owner", owner.value},
      {"own", own},
      {"driven", own && node.drives(object)},
      {"outside", own && node.feeds(object)},
      {"position_m", numbers(s.position)},
      {"orientation_xyzw", {s.orientation.x(), s.orientation.y(), s.orientation.z(), s.orientation.w()}},
      {"velocity_m_s", numbers(s.velocity)},
      {"angular_velocity_rad_s", numbers(s.angular_velocity_body)}};
  const auto differs_m = peer.ghost_difference_m(object, now);
  // A receiver that has shown it elsewhere knows better than this peer's own copy of the ghosts.
  if (own) {
    row["ghost_error_m"] = std::max((s.position - peer.ghost(object, t).position).norm(), differs_m.value_or(0.0));
  }
  if (differs_m) row["differs_m"] = *differs_m;
  if (const auto lock = peer.lock_around(object)) row["locked_by"] = lock->by;
  if (!peer.receives(object)) row["heard"] = false;
  return row;
}

// Adds the objects that have an owner, from a number on. "next" is the number to continue from; null after the last
// one.
void add_objects(ordered_json& reply, const PeerNode& node, HostTime now, const ObjectsRequest& request, bool own) {
  reply["objects"] = ordered_json::array();
  reply["next"] = nullptr;
  if (!node.peer().clock().synchronised()) return;  // without session time nothing has a position yet
  for (const auto& [object, owner] : node.peer().owners().from(ObjectId::unpacked(request.from))) {
    if (own && owner != node.peer().id()) continue;
    if (reply["objects"].size() == request.count) {
      reply["next"] = object.packed();
      return;
    }
    reply["objects"].push_back(object_row(node, now, object, owner));
  }
}

ordered_json status(PeerNode& node, HostTime now, const AskMore& more) {
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
      {"clock_offset_ms", clock.synchronised() ? in_ms(clock.session_minus_host(now)) : ordered_json(nullptr)},
      {"clock_error_ms", in_ms(clock.error_bound(now))},
      {"sealed", !node.options().sealed_by.empty()},
      {"sealed_by", node.options().sealed_by.empty() ? ordered_json(nullptr) : ordered_json(node.options().sealed_by)}};
  // Without the mode the reply is as it has always been.
  std::optional<Duration> bound;
  if (clock.synchronised()) bound = node.bound(clock.to_session(now));
  if (bound) {
    const auto& counters = peer.counters();
    reply["shown"] = {{"delay_ms", in_ms(bound)},
                      {"updates_late", counters.updates_late},
                      {"updates_missing", counters.updates_missing},
                      {"decisions_late", counters.decisions_late},
                      {"latest_by_ms", in_ms(counters.latest_by)}};
  }
  reply["world_time_s"] = since(peer.world_zero());
  reply["since_start_s"] = since(node.start());
  reply["waits_for"] = ordered_json::array();
  for (const AwaitedPeer& missing : node.missing()) {
    reply["waits_for"].push_back({{"id", missing.id.value}, {"name", missing.name}});
  }
  const More known = more ? more() : More{};
  reply["troubles"] = known.troubles;
  reply["members"] = ordered_json::array();
  for (const auto& [id, member] : peer.members().all()) {
    reply["members"].push_back({{"id", id.value}, {"name", member.name}, {"joined", member.synchronised}});
  }
  for (const auto& [id, far] : peer.members().far()) {  // of a large session
    reply["members"].push_back({{"id", id.value}, {"name", far.name}, {"joined", far.synchronised}});
  }
  reply["locks"] = ordered_json::array();
  for (const replication::Lock& lock : peer.locks()) {
    reply["locks"].push_back({{"path", path_or_id(node.scene(), lock.object)}, {"by", lock.by}});
  }
  add_objects(reply, node, now, {}, /*own=*/true);
  reply["counters"] = node.log().counters;
  reply["counters"].update(ordered_json(known.counters));
  return reply;
}

// Reports counts for each peer and each region; a client that wants rates asks twice.
ordered_json peers_reply(const PeerNode& node, HostTime now, const PeersRequest& request) {
  const replication::Peer& peer = node.peer();
  const replication::SessionClock& clock = peer.clock();
  ordered_json reply = good();
  const auto part = [](std::optional<double> lost) { return lost ? ordered_json(*lost) : ordered_json(nullptr); };
  const auto id_of = [](std::optional<PeerId> id) { return id ? ordered_json(id->value) : ordered_json(nullptr); };
  const auto& os = peer.os_clock();
  reply["clock"] = {{"follows", id_of(peer.follows())},
                    {"offset_ms", clock.synchronised() ? in_ms(clock.session_minus_host(now)) : ordered_json(nullptr)},
                    {"error_ms", in_ms(clock.error_bound(now))},
                    {"to_slew_ms", in_ms(clock.debt(now))},
                    {"reach_ms", clock.synchronised() ? in_ms(peer.clock_reach(now).most) : ordered_json(nullptr)},
                    {"os_clock_error_ms", in_ms(os ? std::optional(os->error) : std::nullopt)}};
  ordered_json peers = ordered_json::array(), next = nullptr, regions = ordered_json::array();
  const auto& members = peer.members().all();
  for (auto at = members.lower_bound(PeerId{request.from}); at != members.end(); ++at) {
    const auto& [id, member] = *at;
    if (peers.size() == kPeersMax) {
      next = id.value;
      break;
    }
    const auto bounds = member.clock.at(now, replication::kDrift_ppm + replication::kSlew_ppm);
    const replication::LossMeter received = member.received_in_all();
    const bool compared = bounds && clock.synchronised();
    const Duration own = clock.session_minus_host(now);
    peers.push_back(
        {{"id", id.value},
         {"name", member.name},
         {"joined", member.synchronised},
         {"leads", member.leads},
         {"heard_ms_ago", in_ms(now - member.last_received)},
         {"round_trip_ms", in_ms(member.clock.round_trip())},
         {"delay_ms", in_ms(member.delays.mean())},
         {"clock_ahead_ms", compared ? in_ms(member.clock.likely(now).offset - own) : ordered_json(nullptr)},
         {"clock_ahead_least_ms", compared ? in_ms(bounds->least - own) : ordered_json(nullptr)},
         {"clock_ahead_most_ms", compared ? in_ms(bounds->most - own) : ordered_json(nullptr)},
         {"clock_error_ms", member.synchronised ? in_ms(member.clock_error) : ordered_json(nullptr)},
         {"datagrams_in", member.datagrams_in},
         {"bytes_in", member.bytes_in},
         {"loss_in", part(received.measured_loss())},
         {"loss_out", part(member.echo.reported_loss())},
         {"duplicates", received.duplicates()},
         {"overtaken", received.overtaken()},
         {"ghosts_differ", member.ghosts_differ},
         {"ghosts_differ_explained", member.ghosts_differ_explained},
         {"drops", member.drops}});
  }
  std::map<RegionId, replication::LossMeter> received;  // from all members
  for (const auto& [id, member] : members) {
    for (const auto& [region, meter] : member.received) received[region] += meter;
  }
  for (const auto& [region, traffic] : peer.counters().regions) {
    if (regions.size() == kRegionsMax) break;
    const replication::LossMeter& in = received[region];
    regions.push_back({{"region", region.value},
                       {"datagrams_in", traffic.datagrams_in},
                       {"bytes_in", traffic.bytes_in},
                       {"datagrams_out", traffic.datagrams_out},
                       {"bytes_out", traffic.bytes_out},
                       {"loss_in", part(in.measured_loss())},
                       {"duplicates", in.duplicates()},
                       {"overtaken", in.overtaken()},
                       {"drops", traffic.drops}});
  }
  const std::size_t left_out = peer.counters().regions.size() - regions.size();
  reply["peers"] = std::move(peers);
  reply["next"] = std::move(next);
  reply["regions"] = std::move(regions);
  reply["regions_left_out"] = left_out;
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

ordered_json outcome_reply(const std::expected<void, std::string>& done) {
  ordered_json reply = good();
  reply["done"] = done.has_value();
  if (!done) reply["refused"] = done.error();
  return reply;
}

// The reply says whether the object stays in the air: it is at rest, and nothing pulls it down.
ordered_json let_go_reply(PeerNode& node, HostTime now, const std::string& path) {
  const auto done = node.let_go(now, path);
  ordered_json reply = outcome_reply(done);
  if (!done) return reply;
  const KinematicState state = node.peer().truth(*node.scene().find(path), node.peer().clock().to_session(now));
  reply["stays"] = replication::is_motionless(state);
  return reply;
}

ordered_json edit_reply(const EditReport& report) {
  ordered_json reply = good();
  reply["edit"] = name_of(report.edit);
  reply["done"] = report.operation.has_value();
  if (report.operation) {
    reply["operation"] = {{"author", report.operation->author.value}, {"number", report.operation->number}};
  } else {
    reply["refused"] = report.refused;
  }
  return reply;
}

// "alone": nobody else is here who could hold it.
ordered_json operation_reply(const PeerNode& node, replication::OperationId id) {
  const auto known = node.operation(id);
  const OperationState state =
      known ? *known : OperationState{.edit = {}, .refused = "this peer has made no such operation"};
  ordered_json reply = good();
  reply["operation"] = {{"author", id.author.value}, {"number", id.number}};
  reply["applied"] = state.applied;
  reply["held"] = state.held;
  reply["stored"] = state.stored;
  reply["stores"] = node.options().stores;
  reply["alone"] = node.peer().members().count() == 0;
  reply["done"] = state.refused.empty();
  if (!state.refused.empty()) reply["refused"] = state.refused;
  return reply;
}

// The value under a key, or all keys of the node, of which there are NodeData::kKeysOfNodeMax at most.
ordered_json data_reply(const PeerNode& node, const DataRequest& request) {
  ordered_json reply = good();
  reply["path"] = request.path;
  const auto at = find_node(node.scene(), request.path);
  const replication::NodeData& data = node.peer().data();
  std::string refused = at ? "" : at.error();
  if (request.key) {
    const std::string* const value = at ? data.find(*at, *request.key) : nullptr;
    reply["key"] = *request.key;
    reply["value"] = value != nullptr ? ordered_json(*value) : ordered_json(nullptr);
    if (at && value == nullptr) refused = "it has no such key";
  } else {
    reply["keys"] = at ? data.keys(*at) : std::vector<std::string>();
  }
  reply["done"] = refused.empty();
  if (!refused.empty()) reply["refused"] = refused;
  return reply;
}

ordered_json conflicts_reply(const PeerNode& node, HostTime now, const ConflictsRequest& request) {
  ordered_json reply = good();
  reply.update(conflict_rows(node, now, request.from));
  return reply;
}

ordered_json subscribe_reply(EventKinds kinds) {
  ordered_json reply = good();
  reply["subscribed"] = ordered_json::array();
  for (const std::string_view name : kEventKindNames) {
    if (kinds.contains(*find_event_kind(name))) reply["subscribed"].push_back(name);
  }
  return reply;
}

ordered_json world_reply(const PeerNode& node) {
  ordered_json reply = good();
  const auto written = write_world(node.scene());
  const bool fits = written && written->text.size() <= kWorldMax_bytes;
  reply["world"] = fits ? ordered_json(written->text) : ordered_json(nullptr);
  reply["done"] = fits;
  if (!fits) reply["refused"] = written ? "the world is too long for a reply" : written.error();
  return reply;
}

}  // namespace

std::string done_reply() { return line_of(good()); }

std::string viewer_reply(const std::string& url) {
  ordered_json reply = good();
  reply["viewer"] = url.empty() ? ordered_json(nullptr) : ordered_json(url);
  return line_of(reply);
}

std::string refusal(const std::string& sentence) {
  return line_of({{"v", feed::kMessageVersion}, {"ok", false}, {"error", sentence}});
}

Answer answer(PeerNode& node, HostTime now, std::string_view line, Duration host_minus_wall, const AskMore& more) {
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
  if (const auto* peers = std::get_if<PeersRequest>(&*request)) return {line_of(peers_reply(node, now, *peers))};
  if (const auto* poses = std::get_if<PoseRequest>(&*request)) {
    const feed::Outcome outcome = node.on_poses(now, host_minus_wall, poses->poses);
    return {poses->reply ? line_of(pose_reply(outcome)) : ""};
  }
  if (const auto* hand = std::get_if<LetGoRequest>(&*request)) {
    return {line_of(let_go_reply(node, now, hand->path))};
  }
  if (const auto* look = std::get_if<ViewpointRequest>(&*request)) {
    return {line_of(outcome_reply(node.look_from(look->path, look->viewpoint)))};
  }
  if (const auto* edit = std::get_if<EditRequest>(&*request)) return {line_of(edit_reply(node.edit(now, edit->edit)))};
  if (const auto* operation = std::get_if<OperationRequest>(&*request)) {
    return {line_of(operation_reply(node, operation->operation))};
  }
  if (const auto* data = std::get_if<DataRequest>(&*request)) return {line_of(data_reply(node, *data))};
  if (const auto* conflicts = std::get_if<ConflictsRequest>(&*request)) {
    return {line_of(conflicts_reply(node, now, *conflicts))};
  }
  if (const auto* subscribe = std::get_if<SubscribeRequest>(&*request)) {
    return {line_of(subscribe_reply(subscribe->kinds)), /*leave=*/false, subscribe->kinds};
  }
  if (std::holds_alternative<WorldRequest>(*request)) return {line_of(world_reply(node))};
  if (std::holds_alternative<ViewerRequest>(*request)) {
    return {viewer_reply(""), /*leave=*/false, /*subscribe=*/{}, /*viewer=*/true};
  }
  if (std::holds_alternative<LeaveRequest>(*request)) return {line_of(good()), /*leave=*/true};
  return {line_of(status(node, now, more))};
}

}  // namespace peerd::control
