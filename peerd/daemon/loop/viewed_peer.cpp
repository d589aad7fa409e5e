#include "peerd/daemon/loop/viewed_peer.hpp"

#include <algorithm>
#include <memory>
#include <utility>

#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"
#include "peerd/peer/control/answer.hpp"
#include "peerd/peer/feed/json_members.hpp"
#include "peerd/view/gateway/metrics.hpp"
#include "peerd/view/picks/hierarchy_level.hpp"
#include "peerd/view/picks/inspect.hpp"
#include "peerd/view/picks/surroundings.hpp"

namespace peerd {
namespace {

std::string reply_line(const nlohmann::ordered_json& members) {
  nlohmann::ordered_json reply = {{"v", feed::kMessageVersion}, {"ok", true}};
  reply.update(members);
  return json_line(reply);
}

}  // namespace

ViewedPeer::ViewedPeer(boost::asio::io_context& io, Daemon& daemon, PeerNode& node, std::string world,
                       view::ImageLoader load_image)
    : daemon_(daemon), node_(node), picture_(std::move(world), std::move(load_image)), maker_(io) {}

std::string ViewedPeer::metrics() {
  const HostTime now = daemon_.now();
  const auto reply_to = [&](const char* request) {
    const control::Answer answer =
        control::answer(node_, now, request, Duration{0}, [this] { return daemon_.more_status(); });
    return parse_json(answer.line);
  };
  return gateway::metrics_text(reply_to(R"({"do":"status"})"), reply_to(R"({"do":"peers"})"));
}

std::uint32_t ViewedPeer::revision() {
  if (picture_.follow(node_)) rows_of_ = 0;
  return picture_.revision();
}

void ViewedPeer::make_scene(std::function<void(const gateway::SceneFile&)> done) {
  const std::uint32_t wanted = revision();
  if (scene_.revision == wanted) return done(scene_);
  waiting_.push_back(std::move(done));
  if (maker_.is_busy()) return;
  maker_.make(picture_.input(node_, daemon_.now()),
              [this, wanted](SceneMaker::Made made) { on_scene(wanted, std::move(made)); });
}

// A client that has asked meanwhile gets this one, too, though the scene may have been edited since: an event says so,
// and it asks again.
void ViewedPeer::on_scene(std::uint32_t revision, SceneMaker::Made made) {
  scene_ = {revision, nullptr, {}};
  if (made) {
    scene_.glb = std::make_shared<const std::string>(*std::move(made));
  } else {
    scene_.why_not = made.error();
  }
  for (const auto& done : std::exchange(waiting_, {})) done(scene_);
}

std::span<const std::byte> ViewedPeer::next_frame(view::PoseStream& client) {
  (void)revision();
  const HostTime now = daemon_.now();
  const view::PoseKinds kinds = client.watched().kinds;
  const bool is_old = !rows_at_ || now - *rows_at_ > kRowsMaxAge;
  if (is_old || (kinds & ~rows_of_) != 0) {
    rows_of_ = is_old ? kinds : static_cast<view::PoseKinds>(rows_of_ | kinds);
    rows_at_ = now;
    picture_.refresh(node_, now, rows_of_);
  }
  if (!client.watched().looks) return client.next(picture_.poses());
  picture_.refresh_looks(now);
  return client.next(picture_.poses(), &picture_.looks());
}

std::string ViewedPeer::pick(const Vec3& origin, const Vec3& direction) {
  (void)revision();
  return reply_line(picture_.pick(node_, daemon_.now(), origin, direction));
}

std::string ViewedPeer::walk(const view::AvatarSize& size, const view::Stride& stride, const std::string& except) {
  (void)revision();
  return reply_line(picture_.walk(node_, daemon_.now(), size, stride, except));
}

std::string ViewedPeer::surroundings() {
  (void)revision();
  const auto at = picture_.advance(node_, daemon_.now());
  if (!at) return reply_line({{"ok", false}, {"error", "there is no session yet"}});
  return reply_line(view::surroundings(node_, *at, picture_.movers().ids));
}

std::string ViewedPeer::hierarchy(const std::string& path, std::uint32_t level) {
  (void)revision();
  const auto id = node_.scene().find(path);
  if (!id) return reply_line({{"ok", false}, {"error", "there is no node " + path}});
  const auto found = view::hierarchy_level(node_.scene(), *id, level);
  if (!found) return reply_line({{"ok", false}, {"error", path + ": " + found.error()}});
  const auto& movers = picture_.movers().ids;
  const auto mover = std::ranges::find(movers, *id);
  nlohmann::ordered_json reply = view::to_json(*found);
  reply["path"] = path;
  reply["level"] = level;
  const bool moves = mover != movers.end();
  reply["node"] = moves ? nlohmann::ordered_json(mover - movers.begin()) : nlohmann::ordered_json(nullptr);
  const Pose pose = node_.scene().rigid_pose(*id);
  const auto& q = pose.orientation;
  reply["position_m"] = {pose.position.x(), pose.position.y(), pose.position.z()};
  reply["orientation_xyzw"] = {q.x(), q.y(), q.z(), q.w()};
  return reply_line(reply);
}

std::string ViewedPeer::inspect(std::uint32_t node) {
  (void)revision();
  return reply_line(picture_.inspect(node_, node));
}

std::string ViewedPeer::inspect_at(const std::string& path) { return reply_line(view::inspect(node_, path)); }

}  // namespace peerd
