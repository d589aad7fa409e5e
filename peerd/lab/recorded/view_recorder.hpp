#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/ids.hpp"
#include "core/math.hpp"
#include "core/time.hpp"
#include "peerd/lab/recorded/recording.hpp"
#include "peerd/lab/recorded/stretch_writer.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "peerd/view/picture/drawn_scene.hpp"
#include "peerd/view/picture/live_picture.hpp"
#include "replication/settings/output/output.hpp"

namespace peerd::recorded {

// A Truth says where an object really is, and whose it is.
struct Truth {
  Pose pose;
  PeerId owner;
};
// The map is for look-ups alone.
using Truths = std::unordered_map<ObjectId, Truth>;

// Called with each scene of a view as it is drawn, and the instant from which on it is.
using SceneWatch = std::function<void(PeerId view, double t_s, const view::ScenePicture&)>;

// A ViewRecorder keeps what one peer has in view, instant by instant. At each of them look() precedes keep(), or
// leave_out() stands for both.
class ViewRecorder {
 public:
  // Over which objects the errors' mean and maximum are.
  enum class ErrorsOf : std::uint8_t { kOthers, kOwn };
  // `world`: its name, for people. `on_scene`, if not empty, gets each scene that is kept.
  ViewRecorder(PeerId peer, std::string name, std::string world, view::ImageLoader load_image, ErrorsOf errors_of,
               SceneWatch on_scene);

  // Brings its picture of the peer to `now` of the peer's own clock.
  void look(PeerNode& node, HostTime now);
  // Adds where the peer has its own objects, after look().
  void add_own(Truths& truths) const;
  // Keeps the picture of look() as that of t_s.
  void keep(double t_s, const Truths& truths);
  // The peer is not there at that instant.
  void leave_out();
  // Something of which clients of a running peer are told. `zero`: the session time of the recording's begin.
  void note(double t_s, const replication::Output& output, const PeerNode& node, SimTime zero);

  // The memory that it has taken so far [bytes], and the rows of poses.
  [[nodiscard]] std::size_t size_bytes() const { return scene_bytes_ + other_bytes_ + stretches_.size_bytes(); }
  [[nodiscard]] std::size_t rows() const { return stretches_.rows(); }
  [[nodiscard]] RecordedView finish();

 private:
  void keep_scene(double t_s);
  [[nodiscard]] std::uint32_t revision() const { return before_ + picture_->revision(); }
  void keep_errors(const Truths& truths);
  void add_unknown();  // an instant of which no error is known
  [[nodiscard]] view::PoseRow truth_row(std::uint32_t node, const Truth& truth) const;

  RecordedView view_;
  ErrorsOf errors_of_;
  std::string world_;
  view::ImageLoader load_image_;
  SceneWatch on_scene_;
  std::unique_ptr<view::LivePicture> picture_;  // null: the peer is not there
  std::uint32_t before_ = 0;                    // revisions of its pictures before it was away
  std::optional<view::PictureInput> scene_;     // of another revision, which is not kept yet
  StretchWriter stretches_;
  std::vector<view::PoseRow> rows_;  // of one instant
  std::size_t instants_ = 0;
  std::size_t scene_bytes_ = 0, other_bytes_ = 0;
};

}  // namespace peerd::recorded
