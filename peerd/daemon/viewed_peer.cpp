#include "peerd/daemon/viewed_peer.hpp"

#include <memory>
#include <utility>

#include <nlohmann/json.hpp>

#include "peerd/control/answer.hpp"
#include "peerd/feed/json_members.hpp"
#include "peerd/gateway/metrics.hpp"

namespace peerd {
namespace {

std::string reply_line(const nlohmann::ordered_json& members) {
  nlohmann::ordered_json reply = {{"v", feed::kMessageVersion}, {"ok", true}};
  reply.update(members);
  return reply.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace

ViewedPeer::ViewedPeer(boost::asio::io_context& io, Daemon& daemon, PeerNode& node, std::string world,
                       picture::ImageLoader load_image)
    : daemon_(daemon), node_(node), picture_(std::move(world), std::move(load_image)), maker_(io) {}

std::string ViewedPeer::metrics() {
  const HostTime now = daemon_.now();
  const auto reply_to = [&](const char* request) {
    const api::Answer answer =
        api::answer(node_, now, request, Duration{0}, [this] { return daemon_.counters_of_status(); });
    return nlohmann::json::parse(answer.line);
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

// Who has asked meanwhile gets this one, too, though the scene may have been edited since: an event says so, and it
// asks again.
void ViewedPeer::on_scene(std::uint32_t revision, SceneMaker::Made made) {
  scene_ = {revision, nullptr, {}};
  if (made) {
    scene_.glb = std::make_shared<const std::string>(*std::move(made));
  } else {
    scene_.why_not = made.error();
  }
  for (const auto& done : std::exchange(waiting_, {})) done(scene_);
}

std::span<const std::byte> ViewedPeer::next_frame(picture::PoseStream& client) {
  (void)revision();
  const HostTime now = daemon_.now();
  const picture::PoseKinds kinds = client.watched().kinds;
  const bool is_old = !rows_at_ || now - *rows_at_ > kRowsMaxAge;
  if (is_old || (kinds & ~rows_of_) != 0) {
    rows_of_ = is_old ? kinds : static_cast<picture::PoseKinds>(rows_of_ | kinds);
    rows_at_ = now;
    picture_.refresh(node_, now, rows_of_);
  }
  return client.next(picture_.poses());
}

std::string ViewedPeer::pick(const Vec3& origin, const Vec3& direction) {
  (void)revision();
  return reply_line(picture_.pick(node_, daemon_.now(), origin, direction));
}

std::string ViewedPeer::walk(const picture::AvatarSize& size, const picture::Stride& stride, const std::string& but) {
  (void)revision();
  return reply_line(picture_.walk(node_, daemon_.now(), size, stride, but));
}

std::string ViewedPeer::inspect(std::uint32_t node) {
  (void)revision();
  return reply_line(picture_.inspect(node_, node));
}

}  // namespace peerd
