#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/ids.hpp"
#include "core/math.hpp"
#include "core/motion/predefined_motion.hpp"
#include "core/scene/scene.hpp"
#include "core/time.hpp"
#include "core/transform.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "peerd/view/frames/look_frame.hpp"
#include "peerd/view/frames/movers.hpp"

namespace peerd::view {

enum class PoseKind : std::uint16_t { kShown = 0, kTruth = 1, kGhost = 2 };
inline constexpr std::size_t kPoseKinds = 3;
// A set of kinds: bit k for kind k.
using PoseKinds = std::uint8_t;
[[nodiscard]] constexpr PoseKinds set_of(PoseKind kind) {
  return static_cast<PoseKinds>(1U << static_cast<unsigned>(kind));
}

// kDiffers: another peer has lately shown it elsewhere (Peer::ghost_difference_m()).
enum PoseFlag : std::uint16_t { kOwn = 1, kDriven = 2, kNotReceived = 4, kOrphaned = 8, kDiffers = 16 };

// One row of a frame, as it is in memory of a little-endian machine.
struct PoseRow {
  std::uint32_t node = 0;
  std::uint32_t owner = 0;
  std::uint16_t kind = 0;
  std::uint16_t flags = 0;
  float threshold_m = std::numeric_limits<float>::quiet_NaN();
  double position[3] = {0, 0, 0};
  float orientation_xyzw[4] = {0, 0, 0, 1};

  friend bool operator==(const PoseRow& a, const PoseRow& b);
};
inline constexpr std::size_t kPoseRow_bytes = 56;
inline constexpr std::size_t kPoseFrameHeader_bytes = 40;
inline constexpr std::uint32_t kPoseFrameMagic = 0x31464450;  // "PDF1"
static_assert(sizeof(PoseRow) == kPoseRow_bytes);
[[nodiscard]] Pose pose_of(const PoseRow& row);
void set_pose(PoseRow& row, const Pose& pose);

// The rows of all movers at one instant, which all clients of one peer share.
class PoseTable {
 public:
  // `movers`: of the picture of that revision, and of the scene; node i is mover i.
  void reset(std::uint32_t revision, std::shared_ptr<const Scene> scene, Movers movers);
  // Brings the rows of these kinds to where the peer, whose scene that still is, has them now. No allocation once
  // everything has been as large as it gets. Nothing that other peers could notice depends on it.
  void refresh(PeerNode& node, HostTime now, PoseKinds kinds);

  // The poses alone: shown() has them then.
  void place(PeerNode& node, HostTime now);
  // The poses in which a viewer draws the movers; before a session, those of the file.
  [[nodiscard]] std::span<const Pose> shown() const { return shown_; }

  // The instant of the poses; none: before a session.
  [[nodiscard]] std::optional<SimTime> at() const { return at_; }

  [[nodiscard]] std::uint32_t revision() const { return revision_; }
  [[nodiscard]] std::size_t node_count() const { return movers_.ids.size(); }
  // The rows of one kind, ascending by node: shown, of all movers; truth, of own objects; ghost, of all that somebody
  // owns. None before a session, nor of kinds that refresh() was not asked for.
  [[nodiscard]] std::span<const PoseRow> rows(PoseKind kind) const { return rows_[static_cast<std::size_t>(kind)]; }

  // Times [s], NaN where there is none yet.
  struct Times {
    double session_s = std::numeric_limits<double>::quiet_NaN();
    double world_s = std::numeric_limits<double>::quiet_NaN();
    double since_start_s = std::numeric_limits<double>::quiet_NaN();
  };
  [[nodiscard]] const Times& times() const { return times_; }

 private:
  void follow_owners(const replication::Peer& peer);
  void add_row(PoseKind kind, const PoseRow& like, const Pose& pose);

  // The way from the mover above to one that no peer knows: the Transforms, and which of them the file drives.
  struct FileWay {
    std::uint32_t mover = 0;
    Mat3 stretch = Mat3::Identity();  // of the mover above (StretchedPose)
    std::vector<TransformFields> fields;
    std::vector<std::pair<std::uint32_t, ObjectId>> driven;  // into `fields`
  };
  void add_file_way(std::uint32_t mover);
  [[nodiscard]] Pose relative_pose(FileWay& way, double world_s);

  std::uint32_t revision_ = 0;
  std::shared_ptr<const Scene> scene_;
  std::optional<PredefinedMotion> motion_;  // of what no peer knows; none: there is nothing
  std::vector<FileWay> file_ways_;          // by mover
  Movers movers_;
  std::optional<SimTime> at_;         // the instant; none: before a session
  std::vector<Pose> ghosts_, shown_;  // by mover; the ghosts only of those that carry others
  std::vector<bool> carries_;
  std::vector<PeerId> owners_;  // by mover, at that revision of the peer's
  std::optional<std::uint64_t> owners_revision_;
  std::vector<PoseRow> rows_[kPoseKinds];
  Times times_;
};

// The frames of one client: each has the rows that are others than in the frames before.
class PoseStream {
 public:
  struct Near {
    Vec3 center_m = Vec3::Zero();
    double radius_m = 0;
  };
  struct Watch {
    PoseKinds kinds = set_of(PoseKind::kShown);
    std::optional<Near> near;  // rows within that sphere alone
    bool looks = false;        // behind the rows: what is seen to change beside poses
  };
  // From now on the frames are of these rows; the next one has all of them.
  void watch(const Watch& watch);
  [[nodiscard]] const Watch& watched() const { return watch_; }

  // The next frame, valid until the next call; with no rows where nothing has changed. No allocation once it has been
  // as large as it gets. `looks`: of the same revision; they come where they are watched.
  [[nodiscard]] std::span<const std::byte> next(const PoseTable& table, const view::LookTable* looks = nullptr);

 private:
  Watch watch_;
  std::uint32_t revision_ = 0;
  std::vector<PoseRow> sent_[kPoseKinds];
  view::LookStream looks_;
  std::vector<std::byte> frame_;
};

}  // namespace peerd::view
