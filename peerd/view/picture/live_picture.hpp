#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "peerd/peer/node/peer_node.hpp"
#include "peerd/view/frames/look_frame.hpp"
#include "peerd/view/frames/movers.hpp"
#include "peerd/view/frames/picture_input.hpp"
#include "peerd/view/frames/pose_frame.hpp"
#include "peerd/view/picks/pick.hpp"
#include "peerd/view/picks/walk.hpp"

namespace peerd::view {

// A LivePicture is what viewers of one peer see; one is enough for all of them. It is sans-IO, and on the peer's own
// thread, but for the picture itself, which write_glb(picture_of(input())) makes of a copy on any thread.
class LivePicture {
 public:
  LivePicture(std::string world, ImageLoader load_image);
  ~LivePicture();
  LivePicture(const LivePicture&) = delete;
  LivePicture& operator=(const LivePicture&) = delete;

  // Begins another revision where the scene has been edited or more of it can move; true where it does, and at first.
  // Cheap where nothing has changed. All calls below come after it.
  bool follow(const PeerNode& node);
  [[nodiscard]] std::uint32_t revision() const { return revision_; }
  // All that the picture of this revision is made of, with everything where the peer has it now. It copies the scene.
  [[nodiscard]] PictureInput input(PeerNode& node, HostTime now);

  // Brings the rows of these kinds to now; PoseStream::next(poses()) makes each client's frame of them.
  void refresh(PeerNode& node, HostTime now, PoseKinds kinds) { poses_.refresh(node, now, kinds); }
  [[nodiscard]] const PoseTable& poses() const { return poses_; }
  // The rows are of these: node i is mover i.
  [[nodiscard]] const Movers& movers() const { return movers_; }
  // Brings the peer to now for a question about it; none: there is no session yet.
  [[nodiscard]] std::optional<SimTime> advance(PeerNode& node, HostTime now);
  // Brings what changes beside poses to the instant of the last refresh().
  void refresh_looks(HostTime now);
  [[nodiscard]] const view::LookTable& looks() const { return looks_; }

  // The replies to "pick" and "inspect" (docs/reference/gateway.md), without "seq".
  [[nodiscard]] nlohmann::ordered_json pick(PeerNode& node, HostTime now, const Vec3& origin, const Vec3& direction);
  // The reply to "walk". `except`: the path of an object that is not met, such as the avatar that walks; empty: none.
  [[nodiscard]] nlohmann::ordered_json walk(PeerNode& node, HostTime now, const view::AvatarSize& size,
                                            const view::Stride& stride, const std::string& except);
  [[nodiscard]] nlohmann::ordered_json inspect(const PeerNode& node, std::uint32_t index) const;

 private:
  ScenePicker& placed(std::unique_ptr<ScenePicker>& picker, Pickable what, PeerNode& node, HostTime now);

  std::string world_;
  ImageLoader load_image_;
  std::uint32_t revision_ = 0;
  std::shared_ptr<const Scene> scene_;
  Movers movers_;
  std::uint64_t scene_changes_ = 0, models_changed_ = 0, owners_revision_ = 0;  // of which movers_ are
  PoseTable poses_;
  view::LookTable looks_;
  bool has_looks_ = false;  // they are of this revision
  // Null until somebody picks, or walks, in this revision.
  std::unique_ptr<ScenePicker> picker_, obstacles_;
};

}  // namespace peerd::view
