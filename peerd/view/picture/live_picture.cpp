#include "peerd/view/picture/live_picture.hpp"

#include <algorithm>
#include <cassert>
#include <optional>
#include <utility>

#include <nlohmann/json.hpp>

#include "peerd/view/picks/inspect.hpp"

namespace peerd::view {
namespace {

using nlohmann::ordered_json;

// The place of an avatar that its own rays shall not meet.
const Vec3 kAway(0.0, 1e12, 0.0);

ordered_json vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

}  // namespace

LivePicture::LivePicture(std::string world, ImageLoader load_image)
    : world_(std::move(world)), load_image_(std::move(load_image)) {}
LivePicture::~LivePicture() = default;

bool LivePicture::follow(const PeerNode& node) {
  const replication::Peer& peer = node.peer();
  const replication::PeerCounters& counters = peer.counters();
  const bool is_edited = counters.scene_changes != scene_changes_;
  const bool may_move_more = counters.models_changed != models_changed_ || peer.owners().revision() != owners_revision_;
  if (revision_ > 0 && !is_edited && !may_move_more) return false;
  Movers movers = movers_of(peer, movers_);
  scene_changes_ = counters.scene_changes;
  models_changed_ = counters.models_changed;
  owners_revision_ = peer.owners().revision();
  if (revision_ > 0 && !is_edited && movers.ids == movers_.ids && movers.of_peer == movers_.of_peer) return false;
  ++revision_;
  movers_ = std::move(movers);
  if (scene_ == nullptr || is_edited) scene_ = std::make_shared<const Scene>(node.scene());
  poses_.reset(revision_, scene_, movers_);
  picker_.reset();
  obstacles_.reset();
  has_looks_ = false;
  return true;
}

PictureInput LivePicture::input(PeerNode& node, HostTime now) {
  assert(revision_ > 0);
  poses_.place(node, now);
  const double world_s = poses_.times().world_s;
  PictureInput input{world_, revision_, scene_at(*scene_, std::isfinite(world_s) ? world_s : -1.0), {}, load_image_};
  for (std::size_t i = 0; i < movers_.ids.size(); ++i) {
    const PeerId owner = movers_.of_peer[i] ? node.peer().owner(movers_.ids[i]) : kNobody;
    input.movers.push_back({movers_.ids[i], poses_.shown()[i], owner});
  }
  return input;
}

std::optional<SimTime> LivePicture::advance(PeerNode& node, HostTime now) {
  assert(revision_ > 0);
  poses_.place(node, now);
  return poses_.at();
}

void LivePicture::refresh_looks(HostTime now) {
  assert(revision_ > 0);
  if (!std::exchange(has_looks_, true)) looks_.reset(scene_, movers_.ids);
  const double world_s = poses_.times().world_s;
  looks_.refresh(now, std::isfinite(world_s) ? world_s : -1.0);
}

// Everything is where the peer has it now.
ScenePicker& LivePicture::placed(std::unique_ptr<ScenePicker>& picker, Pickable what, PeerNode& node, HostTime now) {
  assert(revision_ > 0);
  if (picker == nullptr) picker = std::make_unique<ScenePicker>(input(node, now), what);
  poses_.place(node, now);
  for (std::uint32_t i = 0; i < poses_.shown().size(); ++i) picker->place(i, poses_.shown()[i]);
  return *picker;
}

ordered_json LivePicture::pick(PeerNode& node, HostTime now, const Vec3& origin, const Vec3& direction) {
  const auto found = placed(picker_, Pickable::kDrawn, node, now).pick(origin, direction);
  if (!found) return {{"ok", false}, {"error", found.error()}};
  ordered_json reply = {{"ok", true}, {"hit", nullptr}};
  if (!*found) return reply;
  const PickHit& hit = **found;
  const Scene& scene = node.scene();
  const PeerId owner = node.peer().owner(hit.object);
  reply["hit"] = {
      {"node", hit.node},
      {"id", std::to_string(hit.object.packed())},
      {"path", scene.path_of(hit.object)},
      {"owner", owner == kNobody ? ordered_json(nullptr) : ordered_json(owner.value)},
      {"shape",
       {{"id", std::to_string(hit.shape.packed())}, {"path", scene.path_of(hit.shape)}, {"polygon", hit.polygon}}},
      {"distance_m", hit.distance_m},
      {"position_m", vector_json(hit.position)},
      {"normal", vector_json(hit.normal)}};
  return reply;
}

ordered_json LivePicture::walk(PeerNode& node, HostTime now, const view::AvatarSize& size, const view::Stride& stride,
                               const std::string& except) {
  ScenePicker& obstacles = placed(obstacles_, Pickable::kColliding, node, now);
  const auto excepted = except.empty() ? std::nullopt : node.scene().find(except);
  const auto mover = std::ranges::find(movers_.ids, excepted.value_or(ObjectId{}));
  if (excepted && mover != movers_.ids.end()) {
    obstacles.place(static_cast<std::uint32_t>(mover - movers_.ids.begin()), {kAway, Quat::Identity()});
  }
  const view::RayCaster cast = [&](const Vec3& origin, const Vec3& direction) -> view::CastResult {
    const auto found = obstacles.pick(origin, direction);
    if (!found) return std::unexpected(found.error());
    if (!*found) return std::nullopt;
    return view::RayHit{(*found)->distance_m, (*found)->normal};
  };
  const auto stand = view::walk(cast, size, stride);
  if (!stand) return {{"ok", false}, {"error", stand.error()}};
  return {
      {"ok", true}, {"eye_m", vector_json(stand->eye)}, {"on_ground", stand->on_ground}, {"fall_m_s", stand->fall_m_s}};
}

ordered_json LivePicture::inspect(const PeerNode& node, std::uint32_t index) const {
  if (index >= movers_.ids.size()) return {{"ok", false}, {"error", "no such node: it is one of those that stand"}};
  return view::inspect(node, movers_.ids[index]);
}

}  // namespace peerd::view
