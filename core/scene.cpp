#include "core/scene.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>

namespace peerd {
namespace {

// Peers must get the same bits, so products are written out, summed from left to right: Eigen chooses the order of its
// sums, and whether to fuse them, by instruction set.

Vec3 multiply(const Mat3& m, const Vec3& v) {
  Vec3 out;
  for (int i = 0; i < 3; ++i) out[i] = (m(i, 0) * v[0] + m(i, 1) * v[1]) + m(i, 2) * v[2];
  return out;
}

Mat3 multiply(const Mat3& a, const Mat3& b) {
  Mat3 out;
  for (int j = 0; j < 3; ++j) out.col(j) = multiply(a, Vec3(b.col(j)));
  return out;
}

Quat multiply(const Quat& a, const Quat& b) {
  return {((a.w() * b.w() - a.x() * b.x()) - a.y() * b.y()) - a.z() * b.z(),
          ((a.w() * b.x() + a.x() * b.w()) + a.y() * b.z()) - a.z() * b.y(),
          ((a.w() * b.y() + a.y() * b.w()) + a.z() * b.x()) - a.x() * b.z(),
          ((a.w() * b.z() + a.z() * b.w()) + a.x() * b.y()) - a.y() * b.x()};
}

Quat normalized(const Quat& q) {
  const double length = std::sqrt(((q.w() * q.w() + q.x() * q.x()) + q.y() * q.y()) + q.z() * q.z());
  return {q.w() / length, q.x() / length, q.y() / length, q.z() / length};
}

struct Affine {
  Mat3 linear = Mat3::Identity();
  Vec3 offset = Vec3::Zero();
};

Affine multiply(const Affine& a, const Affine& b) {
  return {multiply(a.linear, b.linear), multiply(a.linear, b.offset) + a.offset};
}

bool is_scaled(const TransformFields& t) { return t.scale != Vec3::Ones(); }

// T * C * R * SR * S * SR^-1 * C^-1. Without scale SR and its inverse cancel and are left out, so that R stays a
// rotation to the last bit.
Affine parent_from_local(const TransformFields& t) {
  Affine out;
  out.linear = t.rotation.toRotationMatrix();
  if (is_scaled(t)) {
    const Mat3 sr = t.scale_orientation.toRotationMatrix();
    Mat3 scaled = sr;
    for (int j = 0; j < 3; ++j) scaled.col(j) *= t.scale[j];
    out.linear = multiply(out.linear, multiply(scaled, Mat3(sr.transpose())));
  }
  out.offset = t.translation + (t.center - multiply(out.linear, t.center));
  return out;
}

// The ancestors of `id` and itself below `above` (-1: all), from the top.
std::vector<std::uint32_t> path_below(const Scene& scene, std::int32_t above, ObjectId id) {
  std::vector<std::uint32_t> path;
  for (auto i = static_cast<std::int32_t>(id.value); i >= 0 && i != above; i = scene.instances[i].parent) {
    path.push_back(static_cast<std::uint32_t>(i));
  }
  std::ranges::reverse(path);
  return path;
}

Affine product(const Scene& scene, const std::vector<std::uint32_t>& path) {
  Affine out;
  for (const std::uint32_t i : path) {
    if (scene.instances[i].kind != NodeKind::kTransform) continue;
    out = multiply(out, parent_from_local(scene.instances[i].transform));
  }
  return out;
}

Eigen::Affine3d to_eigen(const Affine& a) {
  Eigen::Affine3d out = Eigen::Affine3d::Identity();
  out.linear() = a.linear;
  out.translation() = a.offset;
  return out;
}

bool names(const Instance& instance, std::string_view component) {
  if (!instance.def.empty() && instance.def == component) return true;
  std::uint32_t index = 0;
  const auto [end, error] = std::from_chars(component.data(), component.data() + component.size(), index);
  return error == std::errc{} && end == component.data() + component.size() && index == instance.child_index;
}

}  // namespace

std::optional<ObjectId> Scene::find(std::string_view path) const {
  const auto by_name = [&]() -> std::optional<ObjectId> {
    const auto it = std::ranges::find(instances, path, &Instance::def);
    if (path.empty() || it == instances.end()) return std::nullopt;
    return ObjectId{static_cast<std::uint32_t>(it - instances.begin())};
  };
  if (path.find('/') == std::string_view::npos) {
    if (const auto id = by_name()) return id;
  }
  std::uint32_t begin = 0;
  auto end = static_cast<std::uint32_t>(instances.size());
  for (std::string_view rest = path;;) {
    const std::size_t slash = std::min(rest.find('/'), rest.size());
    const std::string_view component = rest.substr(0, slash);
    std::uint32_t i = begin;
    while (i < end && !names(instances[i], component)) i = instances[i].subtree_end;
    if (i >= end) break;
    if (slash == rest.size()) return ObjectId{i};
    rest.remove_prefix(slash + 1);
    begin = i + 1;
    end = instances[i].subtree_end;
  }
  return by_name();  // a DEF name may itself hold a '/'
}

std::string Scene::path_of(ObjectId id) const {
  assert(id.value < instances.size());
  std::string path;
  for (const std::uint32_t i : path_below(*this, -1, id)) {
    const Instance& instance = instances[i];
    const bool by_index = instance.def.empty() || instance.name_shadowed || instance.def.find('/') != std::string::npos;
    if (!path.empty()) path += '/';
    path += by_index ? std::to_string(instance.child_index) : instance.def;
  }
  return path;
}

Eigen::Affine3d Scene::world_from_local(ObjectId id) const {
  assert(id.value < instances.size());
  return to_eigen(product(*this, path_below(*this, -1, id)));
}

Pose Scene::rigid_pose(ObjectId id) const {
  assert(id.value < instances.size());
  const auto path = path_below(*this, -1, id);
  Quat rotation = Quat::Identity();
  for (const std::uint32_t i : path) rotation = multiply(rotation, instances[i].transform.rotation);
  return {product(*this, path).offset, normalized(rotation)};
}

Eigen::Affine3d Scene::object_from_shape(ObjectId object, ObjectId shape) const {
  assert(object <= shape && shape.value < at(object).subtree_end);
  const auto above = path_below(*this, -1, object);
  const Affine below = product(*this, path_below(*this, static_cast<std::int32_t>(object.value), shape));
  const bool scaled = std::ranges::any_of(above, [&](std::uint32_t i) { return is_scaled(instances[i].transform); });
  // Without scale the pose is the whole path, and its product with its own inverse is left out rather than rounded.
  if (!scaled) return to_eigen(below);
  Affine baked;  // rigid_pose(object)^-1 * world_from_local(object); both have the same origin
  baked.linear =
      multiply(Mat3(rigid_pose(object).orientation.conjugate().toRotationMatrix()), product(*this, above).linear);
  return to_eigen(multiply(baked, below));
}

}  // namespace peerd
