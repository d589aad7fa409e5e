#pragma once
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

#include "core/ids.hpp"
#include "peerd/lab/recorded/mcap_writer.hpp"
#include "peerd/lab/recorded/recording.hpp"
#include "peerd/view/picture/drawn_scene.hpp"

namespace peerd {

// A scene of a view, and the instant from which on it is drawn.
struct DrawnAt {
  double t_s;
  view::ScenePicture scene;
};
using Scenes = std::map<PeerId, std::vector<DrawnAt>>;

// Writes a recording as MCAP for Foxglove and Rerun (docs/reference/cli.md, export). Frames are `world`, which is below
// `root` and turned so that VRML's +Y is up; VIEW/PATH, where a view has an object, VIEW/ghost/PATH, its ghost there,
// and truth/PATH, where it really is.
//
//   /tf, /VIEW/tf, /VIEW/scene, /VIEW/contacts/marks   Foxglove's own schemas
//   /VIEW/errors    peerd.GhostErrors: mean_m, largest_m, objects {PATH: error [m]}
//   /VIEW/contacts, /VIEW/events                       peerd.Event: lines of the control protocol
class RecordingExport {
 public:
  explicit RecordingExport(std::ostream& out);

  // Writes all of it; the file is whole then.
  void add(const recorded::Recording& recording, const Scenes& scenes);

  [[nodiscard]] std::uint64_t messages() const { return mcap_.messages(); }
  [[nodiscard]] std::uint64_t size_bytes() const { return mcap_.size_bytes(); }

 private:
  void add_scenes(const recorded::RecordedView& view, const std::vector<DrawnAt>& scenes);
  void add_poses(const recorded::RecordedView& view);
  void add_errors(const recorded::Recording& recording, const recorded::RecordedView& view);
  void add_events(const recorded::RecordedView& view);

  McapWriter mcap_;
  std::uint16_t transforms_schema_ = 0, scene_schema_ = 0, errors_schema_ = 0, event_schema_ = 0;
  std::uint16_t truth_ = 0;  // channel
};

}  // namespace peerd
