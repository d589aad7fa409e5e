#include "core/scene/scene.hpp"

#include <algorithm>
#include <cassert>
#include <charconv>

#include "core/vrml/path_text.hpp"

namespace peerd {
namespace {

// Returns the ancestors of `id` and itself below `above` (-1: all), from the top.
std::vector<std::uint32_t> path_below(const Scene& scene, std::int32_t above, ObjectId id) {
  std::vector<std::uint32_t> path;
  for (auto i = static_cast<std::int32_t>(scene.index_of(id)); i >= 0 && i != above; i = scene.instances[i].parent) {
    path.push_back(static_cast<std::uint32_t>(i));
  }
  std::ranges::reverse(path);
  return path;
}

Affine product(const Scene& scene, const std::vector<std::uint32_t>& path) {
  Affine out;
  for (const std::uint32_t i : path) {
    if (scene.instances[i].transform == Instance::kNone) continue;
    out = multiply(out, parent_from_local(scene.transforms[scene.instances[i].transform]));
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
  if (component.starts_with('"')) {
    const auto name = unquoted(component);
    if (name && !name->empty() && instance.def == *name) return true;
  }
  if (!instance.def.empty() && instance.def == component && !is_index(component)) return true;
  std::uint32_t index = 0;
  const auto [end, error] = std::from_chars(component.data(), component.data() + component.size(), index);
  return error == std::errc{} && end == component.data() + component.size() && index == instance.child_index;
}

}  // namespace

std::optional<ObjectId> Scene::parent_of(ObjectId id) const {
  const std::int32_t parent = at(id).parent;
  return parent < 0 ? std::nullopt : std::optional(id_of(static_cast<std::uint32_t>(parent)));
}

bool Scene::is_within(ObjectId inner, ObjectId outer) const {
  const std::uint32_t i = index_of(inner), first = index_of(outer);
  return i >= first && i < instances[first].subtree_end;
}

const TransformFields& Scene::transform(ObjectId id) const {
  static const TransformFields kIdentity;
  const Instance& instance = at(id);
  return instance.transform == Instance::kNone ? kIdentity : transforms[instance.transform];
}

const ObjectFields& Scene::object(ObjectId id) const {
  static const ObjectFields kDefaults;
  const Instance& instance = at(id);
  const bool none = instance.kind != NodeKind::kTransform || instance.extension == Instance::kNone;
  return none ? kDefaults : object_fields[instance.extension];
}

const ShapeFields& Scene::shape(ObjectId id) const {
  static const ShapeFields kDefaults;
  const Instance& instance = at(id);
  const bool none = instance.kind != NodeKind::kShape || instance.extension == Instance::kNone;
  return none ? kDefaults : shape_fields[instance.extension];
}

const Geometry* Scene::geometry(ObjectId id) const {
  const Instance& instance = at(id);
  return instance.geometry == Instance::kNone ? nullptr : &geometries[instance.geometry];
}

std::optional<ObjectId> Scene::find(std::string_view path) const {
  const auto by_name = [&](std::string_view name) -> std::optional<ObjectId> {
    if (name.empty()) return std::nullopt;
    auto it = std::ranges::find_if(instances, [&](const Instance& i) { return !i.inner_name && i.def == name; });
    if (it == instances.end()) it = std::ranges::find(instances, name, &Instance::def);
    if (it == instances.end()) return std::nullopt;
    return id_of(static_cast<std::uint32_t>(it - instances.begin()));
  };
  if (component_end(path) == path.size() && !is_index(path)) {
    const auto name = unquoted(path);
    if (const auto id = name ? by_name(*name) : by_name(path)) return id;
  }
  std::uint32_t begin = 0;
  auto end = static_cast<std::uint32_t>(instances.size());
  for (std::string_view rest = path;;) {
    const std::size_t slash = component_end(rest);
    const std::string_view component = rest.substr(0, slash);
    std::uint32_t i = begin;
    while (i < end && !names(instances[i], component)) i = instances[i].subtree_end;
    if (i >= end) break;
    if (slash == rest.size()) return id_of(i);
    rest.remove_prefix(slash + 1);
    begin = i + 1;
    end = instances[i].subtree_end;
  }
  return by_name(path);  // a DEF name may itself hold a '/'
}

std::string Scene::path_of(ObjectId id) const {
  std::string path;
  for (const std::uint32_t i : path_below(*this, -1, id)) {
    const Instance& instance = instances[i];
    const bool has_slash = instance.def.find('/') != std::string::npos && !needs_quotes(instance.def);
    const bool by_index = instance.def.empty() || instance.name_shadowed || has_slash;
    if (!path.empty()) path += '/';
    path += by_index ? std::to_string(instance.child_index) : in_path(instance.def);
  }
  return path;
}

Eigen::Affine3d Scene::world_from_local(ObjectId id) const {
  return to_eigen(product(*this, path_below(*this, -1, id)));
}

Pose Scene::rigid_pose(ObjectId id) const {
  std::vector<TransformFields> fields;
  for (const std::uint32_t i : path_below(*this, -1, id)) {
    if (instances[i].transform != Instance::kNone) fields.push_back(transforms[instances[i].transform]);
  }
  return peerd::rigid_pose(fields);
}

Vec3 Scene::to_world(ObjectId id, const Vec3& in_parent) const {
  std::vector<std::uint32_t> above = path_below(*this, -1, id);
  above.pop_back();
  return multiply(product(*this, above).linear, in_parent);
}

Eigen::Affine3d Scene::object_from_shape(ObjectId object, ObjectId shape) const {
  assert(is_within(shape, object));
  const auto above = path_below(*this, -1, object);
  const Affine below = product(*this, path_below(*this, static_cast<std::int32_t>(index_of(object)), shape));
  const bool scaled = std::ranges::any_of(above, [&](std::uint32_t i) { return is_scaled(transform(id_of(i))); });
  // A path without scale is its own rigid pose, and the product of that with its inverse is left out rather than
  // rounded.
  if (!scaled) return to_eigen(below);
  Affine baked;  // rigid_pose(object)^-1 * world_from_local(object); both have the same origin
  baked.linear =
      multiply(Mat3(rigid_pose(object).orientation.conjugate().toRotationMatrix()), product(*this, above).linear);
  return to_eigen(multiply(baked, below));
}

}  // namespace peerd
