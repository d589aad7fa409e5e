#pragma once
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/ids.hpp"
#include "core/motion/flexible_shape.hpp"
#include "core/motion/predefined_motion.hpp"
#include "core/scene/scene.hpp"
#include "core/time.hpp"
#include "peerd/view/frames/driven_looks.hpp"
#include "peerd/view/frames/moving_forms.hpp"

namespace peerd::view {

enum class LookKind : std::uint32_t {
  kPoints = 0,  // x, y, z [m] of each point of a geometry, in the frame of its Shapes
  kPlace = 1,   // the first three rows of the map from a Shape's frame to that of the node that it moves with
  kValue = 2    // the value of a driven look: a colour has three numbers, all else one
};
inline constexpr std::uint32_t kLookMagic = 0x314B4C50;  // "PLK1"
inline constexpr std::size_t kLookHead_bytes = 8, kLookRecord_bytes = 16;

// A LookTable is what is seen to change beside poses, at one instant: all clients of a peer share it. It is computed
// only when a client asks, at most kRefresh times a second.
class LookTable {
 public:
  static constexpr Duration kRefresh = std::chrono::milliseconds(40);

  struct Record {
    LookKind kind = LookKind::kPoints;
    std::uint32_t number = 0;   // of the form or of the look
    std::uint64_t version = 0;  // counts its changes; 0: it has never been computed
    std::vector<float> values{};
  };

  // `movers`: the nodes of the picture that stand for moving objects, by which places are given; `scene` is not null.
  void reset(std::shared_ptr<const Scene> scene, std::span<const ObjectId> movers);
  // Brings all records to a world time; below 0, to the file's.
  void refresh(HostTime now, double world_s);
  [[nodiscard]] const std::vector<Record>& records() const { return records_; }
  [[nodiscard]] std::uint64_t resets() const { return resets_; }

 private:
  void fill(const Record& record, double world_s);

  std::shared_ptr<const Scene> scene_;
  std::optional<PredefinedMotion> motion_;  // none: no form moves
  MovingForms forms_;
  std::vector<FlexibleShape> shapes_;  // by forms_.shapes
  std::optional<DrivenLooks> looks_;
  std::vector<Record> records_;
  std::optional<HostTime> refreshed_at_;
  std::vector<float> next_;  // scratch
  std::uint64_t resets_ = 0;
};

// The records of one client: each frame has those that have changed since it was sent them, up to kFrame_bytes; what
// has no room comes first in the next frame.
class LookStream {
 public:
  static constexpr std::size_t kFrame_bytes = 262'144;

  void restart() { resets_ = 0; }
  // Appends a magic number, the number of records and the records to a frame.
  void append(const LookTable& table, std::vector<std::byte>& frame);

 private:
  std::uint64_t resets_ = 0;         // the table's, to which sent_ belongs
  std::vector<std::uint64_t> sent_;  // versions, by record
  std::size_t first_ = 0;            // the record that is looked at first
};

}  // namespace peerd::view
