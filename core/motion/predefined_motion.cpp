#include "core/motion/predefined_motion.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/animation/network_reader.hpp"
#include "core/atan2.hpp"
#include "core/vrml/document.hpp"

namespace peerd {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

// Returns the rotation vector whose exponential is q [rad], the shorter way.
Vec3 quat_log(const Quat& q) {
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const Vec3 v(sign * q.x(), sign * q.y(), sign * q.z());
  const double sine = std::sqrt((v.x() * v.x() + v.y() * v.y()) + v.z() * v.z());
  if (sine == 0.0) return Vec3::Zero();
  return v * (2.0 * atan2(sine, sign * q.w()) / sine);
}

// Returns the Coordinates of IndexedFaceSets, as pairs of the node of the document and the geometry.
std::vector<std::pair<std::uint32_t, std::uint32_t>> coordinates_of(const Scene& scene) {
  const std::vector<vrml::Node>& nodes = scene.document->nodes;
  const auto below = [&](std::uint32_t node, std::string_view field) {
    const vrml::Field* const f = nodes[node].find(field);
    return f == nullptr || f->count == 0 ? vrml::NodeRef::kNull : f->as<vrml::NodeRef>()[0].index;
  };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> out;
  for (const Instance& i : scene.instances) {
    if (i.geometry == Instance::kNone || !std::holds_alternative<FaceSetGeometry>(scene.geometries[i.geometry]))
      continue;
    const std::uint32_t geometry = below(i.node, "geometry");
    if (geometry == vrml::NodeRef::kNull) continue;
    const std::uint32_t coordinate = below(geometry, "coord");
    if (coordinate != vrml::NodeRef::kNull) out.emplace_back(coordinate, i.geometry);
  }
  std::ranges::sort(out);
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

Quat conjugate(const Quat& q) { return {q.w(), -q.x(), -q.y(), -q.z()}; }

}  // namespace

PredefinedMotion::PredefinedMotion(const Scene& scene) : scene_(scene) {
  if (scene.document == nullptr || scene.document->routes.empty()) return;
  vrml::NetworkReadResult reading = vrml::read_network(scene.document);
  if (!reading.has_sensors) return;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> transform_of;  // document's node, transform
  for (const Instance& i : scene.instances) {
    if (i.transform != Instance::kNone) transform_of.emplace_back(i.node, i.transform);
  }
  std::ranges::sort(transform_of);
  const auto coordinate_of = coordinates_of(scene);
  const std::vector<std::uint32_t> nodes = std::move(reading.document_node);
  // Chains of sensors that start each other are stepped through; a peer that joins late has 50 ns a step for it.
  animation_.emplace(reading.network, animation::AnimationOptions{.max_transitions = std::size_t{1} << 20});
  for (const animation::Field& field : animation_->driven()) {
    const std::uint32_t node = nodes[field.node];
    if (field.name == "point" && field.type == animation::FieldType::kVec3s) {
      const auto range = std::ranges::equal_range(coordinate_of, node, {}, [](const auto& c) { return c.first; });
      for (const auto& [coordinate, geometry] : range) flexible_.emplace_back(geometry, field.id);
    }
    const auto it = std::ranges::lower_bound(transform_of, std::pair(node, 0u));
    if (it == transform_of.end() || it->first != node) continue;
    constexpr std::string_view kParts[] = {"translation", "rotation", "scale", "scaleOrientation", "center"};
    const auto part = std::ranges::find(kParts, field.name);
    if (part == std::end(kParts)) continue;
    driven_.push_back({it->second, static_cast<Part>(part - kParts), field.id});
  }
  std::ranges::sort(flexible_);
  std::ranges::sort(driven_, {}, [](const Driven& d) { return std::pair(d.transform, d.part); });
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    if (!driven(scene.instances[i].transform).empty()) driven_ids_.push_back({i});
  }
}

std::vector<std::uint32_t> PredefinedMotion::flexible_geometries() const {
  std::vector<std::uint32_t> out;
  for (const auto& [geometry, points] : flexible_) out.push_back(geometry);
  return out;
}

Geometry PredefinedMotion::geometry(std::uint32_t index, double t_s) {
  Geometry out = scene_.geometries[index];
  const auto it = std::ranges::find(flexible_, index, [](const auto& f) { return f.first; });
  if (it == flexible_.end() || !animation_->value(it->second, t_s, value_)) return out;
  auto& faces = std::get<FaceSetGeometry>(out);
  std::vector<Eigen::Vector3f> points(faces.points.begin(), faces.points.end());
  const std::size_t count = std::min(points.size(), value_.numbers.size() / 3);
  for (std::size_t i = 0; i < count; ++i) {
    points[i] = {value_.numbers[3 * i], value_.numbers[3 * i + 1], value_.numbers[3 * i + 2]};
  }
  faces.points = std::move(points);
  return out;
}

std::span<const PredefinedMotion::Driven> PredefinedMotion::driven(std::uint32_t transform) const {
  const auto range = std::ranges::equal_range(driven_, transform, {}, &Driven::transform);
  return {range.begin(), range.end()};
}

std::vector<animation::FieldId> PredefinedMotion::fields_of(ObjectId id) const {
  std::vector<animation::FieldId> fields;
  for (const Driven& d : driven(scene_.at(id).transform)) fields.push_back(d.field);
  return fields;
}

bool PredefinedMotion::moves(ObjectId id) const {
  if (driven_.empty()) return false;
  return std::ranges::any_of(path(id), [&](std::uint32_t i) { return !driven(scene_.instances[i].transform).empty(); });
}

bool PredefinedMotion::stays_rigid(ObjectId id) const {
  if (driven_.empty()) return true;
  const auto within = std::ranges::upper_bound(driven_ids_, id);
  if (within != driven_ids_.end() && within->value < scene_.at(id).subtree_end) return false;
  bool uneven = false;  // somewhere above
  for (const std::uint32_t i : path(id)) {
    for (const Driven& d : driven(scene_.instances[i].transform)) {
      if (d.part == kScale || d.part == kScaleOrientation || (d.part == kRotation && uneven)) return false;
    }
    const Vec3& scale = scene_.transform({i}).scale;
    uneven = uneven || scale.x() != scale.y() || scale.y() != scale.z();
  }
  return true;
}

std::vector<std::uint32_t> PredefinedMotion::path(ObjectId id) const {
  std::vector<std::uint32_t> path;
  for (auto i = static_cast<std::int32_t>(id.value); i >= 0; i = scene_.instances[static_cast<std::size_t>(i)].parent) {
    path.push_back(static_cast<std::uint32_t>(i));
  }
  std::ranges::reverse(path);
  return path;
}

void PredefinedMotion::set_part(TransformFields& fields, Part part, const Vec3& vector, const Quat& rotation) {
  switch (part) {
    case kTranslation:
      fields.translation = vector;
      break;
    case kRotation:
      fields.rotation = rotation;
      break;
    case kScale:
      fields.scale = vector;
      break;
    case kScaleOrientation:
      fields.scale_orientation = rotation;
      break;
    case kCenter:
      fields.center = vector;
      break;
  }
}

TransformFields PredefinedMotion::transform(ObjectId id, double t_s) {
  TransformFields fields = scene_.transform(id);
  for (const Driven& d : driven(scene_.at(id).transform)) {
    if (animation_->value(d.field, t_s, value_)) set_part(fields, d.part, value_.vec3(), value_.quat());
  }
  return fields;
}

Pose PredefinedMotion::rigid_pose(ObjectId id, double t_s) {
  std::vector<TransformFields> fields;
  for (const std::uint32_t i : path(id)) fields.push_back(transform({i}, t_s));
  return peerd::rigid_pose(fields);
}

Vec3 PredefinedMotion::to_world(ObjectId id, const Vec3& in_parent, double t_s) {
  Affine world_from_parent;
  for (const std::uint32_t i : path(id)) {
    if (i == id.value || scene_.instances[i].transform == Instance::kNone) continue;
    world_from_parent = multiply(world_from_parent, parent_from_local(transform({i}, t_s)));
  }
  return multiply(world_from_parent.linear, in_parent);
}

PredefinedMotion::Piece PredefinedMotion::piece(ObjectId id, double t_s) {
  const std::vector<std::uint32_t> way = path(id);
  struct Moving {
    std::size_t depth = 0;  // in `way`
    Part part = kTranslation;
    animation::Segment segment;
  };
  std::vector<Moving> moving;
  std::vector<TransformFields> file;
  Piece piece{-kForever, kForever, {}};
  bool still = true, exact = true;
  Vec3 velocity = Vec3::Zero(), angular_velocity_body = Vec3::Zero();
  Affine above;  // the path above the Transform in hand; only used where it stands still
  for (std::size_t depth = 0; depth < way.size(); ++depth) {
    file.push_back(scene_.transform({way[depth]}));
    const TransformFields now = transform({way[depth]}, t_s);
    for (const Driven& d : driven(scene_.instances[way[depth]].transform)) {
      const auto segment = animation_->segment(d.field, t_s);
      assert(segment && "a Transform's fields are vectors and rotations");
      piece.begin_s = std::max(piece.begin_s, segment->begin_s);
      piece.end_s = std::min(piece.end_s, segment->end_s);
      if (segment->initial) continue;
      moving.push_back({depth, d.part, *segment});
      if (segment->is_constant) continue;
      still = false;
      const bool own_turn = d.part == kRotation && depth + 1 == way.size() && now.center.isZero(0.0);
      if (d.part == kTranslation) velocity += multiply(above.linear, segment->velocity);
      if (own_turn) angular_velocity_body = segment->angular_velocity_body;
      exact = exact && (d.part == kTranslation || own_turn);
    }
    above = multiply(above, parent_from_local(now));
  }
  const auto pose_at = [&](double s) {
    std::vector<TransformFields> fields = file;
    for (const Moving& m : moving) {
      set_part(fields[m.depth], m.part, m.segment.position_at(s), m.segment.orientation_at(s));
    }
    return peerd::rigid_pose(fields);
  };
  if (still) {
    piece.begin_s = t_s;
    piece.state = at_rest(pose_at(t_s));
    return piece;
  }
  const bool dense = piece.end_s - piece.begin_s < kPiece_s;
  if (exact && !dense) {
    piece.state = at_rest(pose_at(piece.begin_s));
    piece.state.velocity = velocity;
    piece.state.angular_velocity_body = angular_velocity_body;
    return piece;
  }
  const double cell = std::floor(t_s / kPiece_s);
  piece.begin_s = dense ? cell * kPiece_s : std::max(piece.begin_s, cell * kPiece_s);
  piece.end_s = dense ? (cell + 1.0) * kPiece_s : std::min(piece.end_s, (cell + 1.0) * kPiece_s);
  const double h = piece.end_s - piece.begin_s;
  const auto sample = [&](double s) { return dense ? rigid_pose(id, s) : pose_at(s); };
  const Pose begin = sample(piece.begin_s), middle = sample(piece.begin_s + 0.5 * h), end = sample(piece.end_s);
  piece.state = at_rest(begin);
  piece.state.velocity = (4.0 * middle.position - 3.0 * begin.position - end.position) / h;
  piece.state.acceleration = 4.0 * (begin.position - 2.0 * middle.position + end.position) / (h * h);
  piece.state.angular_velocity_body = quat_log(multiply(conjugate(begin.orientation), end.orientation)) / h;
  return piece;
}

}  // namespace peerd
