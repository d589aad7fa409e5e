#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <boost/asio/io_context.hpp>

#include "peerd/daemon/loop/daemon.hpp"
#include "peerd/daemon/loop/scene_maker.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "peerd/view/gateway/gateway_source.hpp"
#include "peerd/view/picture/live_picture.hpp"

namespace peerd {

// The peer of a daemon as its gateway shows it. What is asked by the control protocol goes through the daemon, and so
// into its capture; what only looks does not.
class ViewedPeer : public gateway::GatewaySource {
 public:
  // All references outlive it. `world`: its name, for people.
  ViewedPeer(boost::asio::io_context& io, Daemon& daemon, PeerNode& node, std::string world,
             view::ImageLoader load_image);

  control::Answer ask(std::string_view request) override { return daemon_.on_control(request); }
  std::string metrics() override;
  std::uint32_t revision() override;
  void make_scene(std::function<void(const gateway::SceneFile&)> done) override;
  std::span<const std::byte> next_frame(view::PoseStream& client) override;
  std::string pick(const Vec3& origin, const Vec3& direction) override;
  std::string walk(const view::AvatarSize& size, const view::Stride& stride, const std::string& except) override;
  std::string inspect(std::uint32_t node) override;
  std::string inspect_at(const std::string& path) override;
  std::string surroundings() override;
  std::string hierarchy(const std::string& path, std::uint32_t level) override;

 private:
  // Rows that are not older serve another client, too.
  static constexpr Duration kRowsMaxAge = std::chrono::milliseconds(5);

  void on_scene(std::uint32_t revision, SceneMaker::Made made);

  Daemon& daemon_;
  PeerNode& node_;
  view::LivePicture picture_;
  gateway::SceneFile scene_;                                             // of the last revision that was asked for
  std::vector<std::function<void(const gateway::SceneFile&)>> waiting_;  // for the scene that is being made
  std::optional<HostTime> rows_at_;                                      // when the rows were brought to the present
  view::PoseKinds rows_of_ = 0;                                          // the kinds that were
  SceneMaker maker_;  // the last member: its thread ends before anything else here does
};

}  // namespace peerd
