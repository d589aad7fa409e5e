#include "collision/query/view_query.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

#include "collision/exact/ordered_sums.hpp"
#include "core/sin_cos.hpp"

namespace peerd::collision {
namespace {

using Ref = WideTree::Ref;

// A plane's offset in a tree's numbers may be larger than binary32 holds: such a plane is beyond the tree, and so is
// one at this offset.
constexpr double kFar = 0x1p100;

// An answer says what to do with a slot that descend() comes to.
enum class ViewStep : std::uint8_t { kVisit, kSkip, kEnd };

std::uint32_t all_of(const WideTree::Leaf& leaf) { return (1u << leaf.count) - 1; }

// World points are rotation * p + position for p of the soup, so normal . world + offset is
// (rotation^T normal) . p + (normal . position + offset). With E the tree's extent, the roundings of binary32 sum up to
// less than 2^-24 of 40 E, as long as the offset is below 8 E; beyond that it alone decides.
WidePlanes planes_of(const WideTree& tree, const Pose& T_world_soup, const Frustum& frustum) {
  WidePlanes out;
  assert(frustum.count() <= WidePlanes::kMaxPlanes);
  const Mat3 rotation = T_world_soup.orientation.toRotationMatrix(), back = rotation.transpose();
  const Vec3 &position = T_world_soup.position, &origin = tree.origin();
  for (out.count = 0; out.count < frustum.count(); ++out.count) {
    const Frustum::Plane& plane = frustum[out.count];
    const Vec3 normal = multiply(back, plane.normal);
    const double offset = (dot(plane.normal, position) + plane.offset_m) + dot(normal, origin);
    const double binary64 = 0x1p-46 * (position.cwiseAbs().maxCoeff() + origin.cwiseAbs().maxCoeff() + tree.extent_m() +
                                       std::abs(plane.offset_m));
    WidePlanes::Plane& wide = out.planes[out.count];
    for (int k = 0; k < 3; ++k) wide.normal[static_cast<std::size_t>(k)] = static_cast<float>(normal[k]);
    wide.offset = static_cast<float>(std::clamp(offset * tree.scale(), -kFar, kFar));
    wide.slack = static_cast<float>(std::min((0x1p-18 * tree.extent_m() + binary64) * tree.scale() + 0x1p-120, kFar));
  }
  return out;
}

}  // namespace

bool Frustum::add(const Vec3& normal, double offset) {
  const double length = std::sqrt(dot(normal, normal));
  if (count_ == kMaxPlanes || !(length > 0.0) || !std::isfinite(length) || !std::isfinite(offset / length))
    return false;
  planes_[count_++] = {normal / length, offset / length};
  return true;
}

std::expected<Frustum, std::string> make_frustum(const Camera& camera) {
  constexpr double kPi = 3.14159265358979323846;
  // NaN fails all of these conditions.
  if (!(camera.field_of_view > 0.0 && camera.field_of_view < kPi)) {
    return std::unexpected("the field of view must be above 0 and below pi");
  }
  if (!(camera.aspect > 0.0 && std::isfinite(camera.aspect))) return std::unexpected("the aspect must be above 0");
  if (!(camera.near_m >= 0.0 && camera.far_m > camera.near_m)) {
    return std::unexpected("near must be 0 or more and below far");
  }
  const SinCos half = sin_cos(camera.field_of_view / 2);
  // A side's plane is (cos, 0, -sin) or so of its half angle: tan = sin / cos, times the aspect where it is the larger.
  const double wide = std::max(camera.aspect, 1.0), high = std::max(1.0 / camera.aspect, 1.0);
  const Mat3 rotation = camera.T_world_camera.orientation.toRotationMatrix();
  const Vec3& eye = camera.T_world_camera.position;
  Frustum out;
  const auto add = [&](const Vec3& normal_camera, double offset_m) {
    const Vec3 normal = multiply(rotation, normal_camera);
    return out.add(normal / normal.norm(), offset_m - dot(normal, eye) / normal.norm());
  };
  bool good = add({0, 0, -1}, -camera.near_m);
  good &= add({half.cos, 0, -half.sin * wide}, 0.0);
  good &= add({-half.cos, 0, -half.sin * wide}, 0.0);
  good &= add({0, half.cos, -half.sin * high}, 0.0);
  good &= add({0, -half.cos, -half.sin * high}, 0.0);
  if (std::isfinite(camera.far_m)) good &= add({0, 0, 1}, camera.far_m);
  if (!good) return std::unexpected("the camera has no finite place");
  assert(out.count() == 5 || out.count() == 6);
  return out;
}

InView in_view(const Frustum& frustum, const WorldBox& box, PlaneMask& active) {
  assert((active & ~frustum.all()) == 0);
  if (box.is_empty()) return InView::kOutside;
  for (std::uint32_t bits = active; bits != 0; bits &= bits - 1) {
    const auto i = static_cast<std::size_t>(std::countr_zero(bits));
    const Frustum::Plane& plane = frustum[i];
    double least = plane.offset_m, most = plane.offset_m, size = std::abs(plane.offset_m);
    for (int k = 0; k < 3; ++k) {
      const double n = plane.normal[k];
      if (n == 0.0) continue;  // times infinity it would be no number
      least += n * (n > 0.0 ? box.lo[k] : box.hi[k]);
      most += n * (n > 0.0 ? box.hi[k] : box.lo[k]);
      size += std::abs(n) * std::max(std::abs(box.lo[k]), std::abs(box.hi[k]));
    }
    const double slack = 0x1p-48 * size;  // rounding, of this and of the normal
    if (most < -slack) return InView::kOutside;
    if (least > slack) active = static_cast<PlaneMask>(active & ~(1u << i));
  }
  return active == 0 ? InView::kInside : InView::kMaybe;
}

// Descends depth first, in the tree's order. enter(visit) is asked before a slot is visited. found(leaf, bits), called
// for triangles that may be in view, bit i for the leaf's triangle i, returns true to end the search.
template <class Enter, class Found>
void ViewQuery::descend(WideTree& tree, const WidePlanes& planes, const Visit& root, Enter enter, Found found) {
  std::array<PlaneMask, WideTree::kWidth> crossed;
  stack_.clear();
  stack_.push_back(root);
  while (!stack_.empty()) {
    const Visit visit = stack_.back();
    stack_.pop_back();
    const ViewStep step = enter(visit);
    if (step == ViewStep::kEnd) return;
    if (step == ViewStep::kSkip) continue;
    const Ref ref = visit.ref.kind() == Ref::kPending ? tree.at(visit.place) : visit.ref;
    counters_.plane_tests += static_cast<std::uint64_t>(std::popcount(visit.active));
    if (ref.kind() == Ref::kLeaf) {
      const WideTree::Leaf& leaf = tree.leaf(ref.index());
      ++counters_.leaf_tests;
      const std::uint32_t bits = test_planes_leaf(leaf, planes, visit.active, crossed);
      if (bits != 0 && found(leaf, bits)) return;
      continue;
    }
    const WideTree::Node& node = tree.node(ref.index());
    counters_.bv_tests += WideTree::kWidth;
    std::uint32_t bits = test_planes_node(node, planes, visit.active, crossed);
    while (bits != 0) {
      const auto i = static_cast<std::size_t>(std::bit_width(bits) - 1);
      bits ^= 1u << i;
      if (node.children[i].kind() == Ref::kNone) continue;
      if (crossed[i] != 0) {
        fetch_ahead(tree, node.children[i]);
      } else if (node.children[i].kind() == Ref::kLeaf) {
        __builtin_prefetch(&tree.leaf(node.children[i].index()));
      }
      stack_.push_back({WideTree::child_slot(ref, i), node.children[i], crossed[i], visit.levels - 1});
    }
  }
}

// Rows of the tree's list that follow each other are copied at once.
void ViewQuery::append(std::span<const std::uint32_t> row) {
  if (row.data() != row_.data() + row_.size()) {
    copy_row();
    row_ = row.first(0);
  }
  row_ = {row_.data(), row_.size() + row.size()};
}
void ViewQuery::copy_row() {
  assert(seen_ + row_.size() <= faces_.size());
  std::ranges::copy(row_, faces_.begin() + static_cast<std::ptrdiff_t>(seen_));
  seen_ += row_.size();
}

bool ViewQuery::may_be_in_view(WideTree& tree, const Pose& T_world_soup, const Frustum& frustum, PlaneMask active,
                               int levels) {
  assert(levels >= 0 && (active & ~frustum.all()) == 0);
  bool may_be = false;
  descend(
      tree, planes_of(tree, T_world_soup, frustum), {WideTree::kRoot, tree.peek(WideTree::kRoot), active, levels},
      [&](const Visit& visit) {
        may_be = visit.active == 0 || visit.levels == 0;
        return may_be ? ViewStep::kEnd : ViewStep::kVisit;
      },
      [&](const WideTree::Leaf&, std::uint32_t) { return may_be = true; });
  return may_be;
}

std::span<const std::uint32_t> ViewQuery::faces_in_view(WideTree& tree, const Pose& T_world_soup,
                                                        const Frustum& frustum) {
  seen_ = 0;
  row_ = {};
  faces_.resize(std::max(faces_.size(), tree.soup().faces.size()));
  descend(
      tree, planes_of(tree, T_world_soup, frustum),
      {WideTree::kRoot, tree.peek(WideTree::kRoot), frustum.all(), kAllLevels},
      [&](const Visit& visit) {
        if (visit.active != 0) return ViewStep::kVisit;
        append(tree.faces_below(visit.place));
        return ViewStep::kSkip;
      },
      [&](const WideTree::Leaf& leaf, std::uint32_t bits) {
        if (bits == all_of(leaf)) {
          append(tree.faces(leaf));
          return false;
        }
        copy_row();
        row_ = {};
        std::size_t end = seen_;
        for (; bits != 0; bits &= bits - 1)
          faces_[end++] = tree.face(leaf, static_cast<std::size_t>(std::countr_zero(bits)));
        seen_ = end;
        return false;
      });
  copy_row();
  return std::span(faces_).first(seen_);
}

}  // namespace peerd::collision
