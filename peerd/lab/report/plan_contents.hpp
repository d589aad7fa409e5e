#pragma once
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "peerd/lab/measure/run_record.hpp"
#include "peerd/lab/report/svg.hpp"

namespace peerd::report {

// The contents of the plan of one run, in world coordinates [m]. A place of a path that is no number interrupts it.
struct PlanContents {
  // An object other than the principal one.
  struct Other {
    PeerId owner;
    std::vector<Vec3> truth;  // not empty; one place of what stands still
    bool moves = false;
  };
  std::vector<Vec3> truth;                // of the principal object
  std::vector<std::vector<Vec3>> ghosts;  // of the principal object, one path for each observer
  std::vector<Other> others;              // those that move, by the extent of their paths, then those that stand still
  std::size_t moving = 0;                 // how many others move
  std::size_t unseen = 0;                 // objects without a sample: no peer observes them
  // Shapes where they stand at first: of owned objects, with the owner, and of nobody's.
  std::vector<std::pair<PeerId, const measure::SceneOutline*>> owned_outlines;
  std::vector<const measure::SceneOutline*> scene_outlines;
  std::vector<Vec3> without_outline;  // the places of others that stand still and have no outline
  double lowest_m = 0.0;              // along world y, of all places
};

// The run outlives the contents. `observers` are those of the principal object.
[[nodiscard]] PlanContents plan_contents(const measure::RunRecord& run, const measure::ObjectInfo& principal,
                                         std::span<const measure::PeerInfo> observers);

// Maps world axes to the page. The view is from +y.
struct PlanAxes {
  int across = 0;
  int up = 2;
  double across_sign = 1.0;
  double up_sign = -1.0;  // x right, -z up: as on a map
  [[nodiscard]] Point of(const Vec3& p) const { return {across_sign * p[across], up_sign * p[up]}; }
  [[nodiscard]] bool turned() const { return across == 2; }
};

// The part of the world that the plan shows, and how it lies on the page.
struct PlanFrame {
  PlanAxes axes;
  Range across, up;  // [m], along the axes of the page
  double width_px = 0.0, height_px = 0.0;
};

// A frame of at most these pixels, at one scale for both axes, around all paths and the outlines near them. A few
// objects that go far off do not count, nor does what an outline has far from the paths. Where the frame is more than
// twice as long along z as along x, it is turned clockwise: a road along z becomes one along the page.
[[nodiscard]] PlanFrame plan_frame(const PlanContents& contents, double width_max_px, double height_max_px);

}  // namespace peerd::report
