#pragma once
#include <array>
#include <cassert>
#include <cstdint>
#include <expected>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "collision/query/wide_view.hpp"
#include "core/box.hpp"

namespace peerd::collision {

// The region that a viewer sees: all points with normal . p + offset_m >= 0 for each plane. It is closed, in the world
// frame.
class Frustum {
 public:
  static constexpr std::size_t kMaxPlanes = WidePlanes::kMaxPlanes;
  struct Plane {
    Vec3 normal;  // unit, inwards
    double offset_m = 0.0;
  };

  // Adds a plane; the normal need not be unit. False where its length is 0 or not finite, or there is no room: then
  // nothing is added.
  [[nodiscard]] bool add(const Vec3& normal, double offset);

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] const Plane& operator[](std::size_t i) const {
    assert(i < count_);
    return planes_[i];
  }
  [[nodiscard]] PlaneMask all() const { return static_cast<PlaneMask>((1u << count_) - 1); }

 private:
  std::array<Plane, kMaxPlanes> planes_;
  std::size_t count_ = 0;
};

// A camera as VRML97 defines it: at the pose's position, looking along its -z, with y up.
struct Camera {
  Pose T_world_camera;
  double field_of_view = 0.785398;  // the smaller of the angles of view, of width and height [rad], in (0, pi)
  double aspect = 1.0;              // width / height, > 0
  double near_m = 0.0;              // >= 0
  double far_m = std::numeric_limits<double>::infinity();  // > near_m; infinite as for a visibilityLimit of 0
};

// Six planes; five where far_m is infinite. ISO/IEC 14772-1, 6.53: fieldOfView is the angle of the smaller of width and
// height, and width / height = tan(horizontal / 2) / tan(vertical / 2). The larger angle stays below pi by that. The
// tangent is made of sin_cos(), so peers have the same planes. The error says which number is none to see by.
[[nodiscard]] std::expected<Frustum, std::string> make_frustum(const Camera& camera);

// Conservative: kOutside is certain, and so is kInside, of everything in a box or an object. What has a point in the
// frustum is never kOutside. kMaybe is all else: what crosses a plane, and what is outside but beyond no single plane,
// as near the frustum's edges.
enum class InView : std::uint8_t { kOutside, kMaybe, kInside };

// Tests a box against the planes of `active`, and removes from `active` those that the box is certainly wholly inside
// of (Assarsson and Moeller, "Optimized View Frustum Culling Algorithms for Bounding Boxes", JGT 5 (2000)): what is in
// the box needs no test by them. Empty boxes are outside.
[[nodiscard]] InView in_view(const Frustum& frustum, const WorldBox& box, PlaneMask& active);

struct ViewCounters {
  std::uint64_t bv_tests = 0;     // boxes, of nodes
  std::uint64_t plane_tests = 0;  // eight boxes or triangles against one plane
  std::uint64_t leaf_tests = 0;   // leaves, triangle by triangle
};

// The triangles of a soup, by its tree, which is built where the frustum's border goes.
//
// An object keeps its memory. Not thread-safe.
class ViewQuery {
 public:
  static constexpr int kAllLevels = std::numeric_limits<int>::max();

  // Whether any triangle may be in view; false is certain. Only the planes of `active` are tested: in_view() has
  // removed those that don't matter. At most `levels` of the tree are visited; what is left below them may be in view.
  [[nodiscard]] bool may_be_in_view(WideTree& tree, const Pose& T_world_soup, const Frustum& frustum, PlaneMask active,
                                    int levels = kAllLevels);
  // The faces that may be in view, in the order of the tree; valid until the next query.
  [[nodiscard]] std::span<const std::uint32_t> faces_in_view(WideTree& tree, const Pose& T_world_soup,
                                                             const Frustum& frustum);

  [[nodiscard]] const ViewCounters& counters() const { return counters_; }

 private:
  struct Visit {
    WideTree::ChildSlot place;
    WideTree::Ref ref;  // what was there, which may be pending
    PlaneMask active;
    int levels;
  };
  template <class Enter, class Found>
  void descend(WideTree& tree, const WidePlanes& planes, const Visit& root, Enter enter, Found found);
  void append(std::span<const std::uint32_t> row);
  void copy_row();

  std::vector<Visit> stack_;
  std::vector<std::uint32_t> faces_;  // room for those of all soups that were asked, of which seen_ are in view
  std::size_t seen_ = 0;
  std::span<const std::uint32_t> row_;  // a part of a tree's list that is in view, and is not copied yet
  ViewCounters counters_;
};

}  // namespace peerd::collision
