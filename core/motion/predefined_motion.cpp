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

bool is_even(const Vec3& scale) { return scale.x() == scale.y() && scale.y() == scale.z(); }

Quat conjugate(const Quat& q) { return {q.w(), -q.x(), -q.y(), -q.z()}; }

// Makes the piece go through the poses at its ends and the position in its middle.
template <class PoseAt>
void go_through(PredefinedMotion::Piece& piece, const PoseAt& pose_at) {
  const double h = piece.end_s - piece.begin_s;
  const Pose begin = pose_at(piece.begin_s), middle = pose_at(piece.begin_s + 0.5 * h), end = pose_at(piece.end_s);
  piece.state = at_rest(begin);
  piece.state.velocity = (4.0 * middle.position - 3.0 * begin.position - end.position) / h;
  piece.state.acceleration = 4.0 * (begin.position - 2.0 * middle.position + end.position) / (h * h);
  piece.state.angular_velocity_body = quat_log(multiply(conjugate(begin.orientation), end.orientation)) / h;
}

// Makes the piece a circle: the origin goes about the centre of its Transform, which goes straight on. `own`: the
// Transform at the begin; `above`: the map from its parent's frame.
void go_about_center(PredefinedMotion::Piece& piece, const TransformFields& own, const Mat3& above) {
  const Vec3 arm = -multiply(above, multiply(parent_from_local(own).linear, own.center));
  piece.turning_rad_s = piece.state.orientation * piece.state.angular_velocity_body;
  piece.state.velocity += piece.turning_rad_s.cross(arm);
  piece.state.acceleration = piece.turning_rad_s.cross(piece.turning_rad_s.cross(arm));
}

}  // namespace

PredefinedMotion::PredefinedMotion(const Scene& scene) : scene_(scene) {
  read_routes();
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    if (const ObjectId id = scene.id_of(i); moves_in_parent(id)) driven_ids_.push_back(id);
  }
}

void PredefinedMotion::read_routes() {
  const Scene& scene = scene_;
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

const PredefinedMotion::Driven* PredefinedMotion::driven_part(ObjectId id, Part part) const {
  const auto parts = driven(scene_.at(id).transform);
  const auto it = std::ranges::find(parts, part, &Driven::part);
  return it == parts.end() ? nullptr : &*it;
}

Vec3 PredefinedMotion::velocity_of(ObjectId id) const {
  const Vec3& velocity = scene_.object(id).velocity;
  return velocity.isZero(0.0) || driven_part(id, kTranslation) != nullptr ? Vec3(Vec3::Zero()) : velocity;
}

bool PredefinedMotion::moves_in_parent(ObjectId id) const {
  return !driven(scene_.at(id).transform).empty() || !velocity_of(id).isZero(0.0);
}

bool PredefinedMotion::turns_in_parent(ObjectId id) const { return driven_part(id, kRotation) != nullptr; }

bool PredefinedMotion::scales(ObjectId id) const {
  return driven_part(id, kScale) != nullptr || driven_part(id, kScaleOrientation) != nullptr;
}

bool PredefinedMotion::moves(ObjectId id) const {
  if (driven_ids_.empty()) return false;
  return std::ranges::any_of(way_to(id, std::nullopt).instances,
                             [&](std::uint32_t i) { return moves_in_parent(scene_.id_of(i)); });
}

bool PredefinedMotion::stays_rigid(ObjectId id) const {
  if (driven_ids_.empty()) return true;
  const auto index = [&](ObjectId driven) { return scene_.index_of(driven); };
  const auto behind = std::ranges::upper_bound(driven_ids_, scene_.index_of(id), {}, index);
  if (behind != driven_ids_.end() && scene_.is_within(*behind, id)) return false;
  bool uneven = false;  // somewhere above
  for (const std::uint32_t i : way_to(id, std::nullopt).instances) {
    const ObjectId on_way = scene_.id_of(i);
    if (scales(on_way) || (uneven && turns_in_parent(on_way))) return false;
    uneven = uneven || !is_even(scene_.transform(on_way).scale);
  }
  return true;
}

// Whether a turn in the frame of the instance's parent is a turn in the world, about the turned axis.
bool PredefinedMotion::is_evenly_scaled_above(ObjectId id) const {
  for (std::int32_t i = scene_.at(id).parent; i >= 0; i = scene_.instances[static_cast<std::size_t>(i)].parent) {
    const ObjectId instance = scene_.id_of(static_cast<std::uint32_t>(i));
    if (scales(instance) || !is_even(scene_.transform(instance).scale)) return false;
  }
  return true;
}

PredefinedMotion::Way PredefinedMotion::way_to(ObjectId id, std::optional<ObjectId> above) const {
  Way way;
  std::vector<TransformFields> beyond;
  for (auto i = static_cast<std::int32_t>(scene_.index_of(id)); i >= 0;
       i = scene_.instances[static_cast<std::size_t>(i)].parent) {
    const auto instance = static_cast<std::uint32_t>(i);
    if (!beyond.empty() || (above && *above == scene_.id_of(instance))) {
      beyond.push_back(scene_.transform(scene_.id_of(instance)));
    } else {
      way.instances.push_back(instance);
    }
  }
  std::ranges::reverse(way.instances);
  std::ranges::reverse(beyond);
  if (!beyond.empty()) way.stretch = stretched_pose(beyond).stretch;
  return way;
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
  if (t_s > 0.0) fields.translation += t_s * velocity_of(id);
  return fields;
}

Pose PredefinedMotion::pose_on(const Way& way, double t_s) {
  std::vector<TransformFields> fields;
  for (const std::uint32_t i : way.instances) fields.push_back(transform(scene_.id_of(i), t_s));
  return peerd::rigid_pose(way.stretch, fields);
}

Pose PredefinedMotion::rigid_pose(ObjectId id, double t_s) { return pose_on(way_to(id, std::nullopt), t_s); }

Vec3 PredefinedMotion::to_world(ObjectId id, const Vec3& in_parent, double t_s) {
  Affine world_from_parent;
  for (const std::uint32_t i : way_to(id, std::nullopt).instances) {
    if (scene_.id_of(i) == id || scene_.instances[i].transform == Instance::kNone) continue;
    world_from_parent = multiply(world_from_parent, parent_from_local(transform(scene_.id_of(i), t_s)));
  }
  return multiply(world_from_parent.linear, in_parent);
}

PredefinedMotion::FieldRates PredefinedMotion::field_rates(ObjectId id, double t_s) {
  FieldRates rates{.fields = transform(id, t_s), .end_s = kForever};
  const Vec3 drift = velocity_of(id);
  if (!drift.isZero(0.0)) {
    if (t_s >= 0.0)
      rates.translation_m_s = drift.norm();
    else
      rates.end_s = 0.0;
  }
  for (const Driven& d : driven(scene_.at(id).transform)) {
    const auto segment = animation_->segment(d.field, t_s);
    assert(segment && "a Transform's fields are vectors and rotations");
    rates.end_s = std::min(rates.end_s, segment->end_s);
    if (segment->initial || segment->is_constant) continue;
    const double speed = segment->velocity.norm(), spin = segment->angular_velocity_body.norm();
    switch (d.part) {
      case kTranslation:
        rates.translation_m_s = speed;
        break;
      case kRotation:
        rates.rotation_rad_s = spin;
        break;
      case kScale:
        rates.scale_1_s = speed;
        break;
      case kScaleOrientation:
        rates.scale_orientation_rad_s = spin;
        break;
      case kCenter:
        rates.center_m_s = speed;
        break;
    }
  }
  return rates;
}

PredefinedMotion::VertexSpan PredefinedMotion::vertex_span(std::uint32_t geometry, double t_s) {
  const auto it = std::ranges::find(flexible_, geometry, [](const auto& f) { return f.first; });
  if (it == flexible_.end()) return {false, kForever};
  const auto segment = animation_->segment(it->second, t_s);
  if (!segment) return {true, t_s};  // nothing is known of how they move
  return {!segment->initial && !segment->is_constant, segment->end_s};
}

PredefinedMotion::Piece PredefinedMotion::piece(ObjectId id, double t_s, std::optional<ObjectId> above) {
  const Way way = way_to(id, above);
  struct Moving {
    std::size_t depth = 0;  // in `way`
    Part part = kTranslation;
    animation::Segment segment;
  };
  std::vector<Moving> moving;
  std::vector<TransformFields> file;
  std::vector<Vec3> drifts;  // velocityVectors
  Piece piece{-kForever, kForever, {}};
  bool still = true, exact = true, circles = false;
  Vec3 velocity = Vec3::Zero(), angular_velocity_body = Vec3::Zero();
  Affine frame{way.stretch, Vec3::Zero()};  // of the parent of the Transform in hand; only used where it stands still
  for (std::size_t depth = 0; depth < way.instances.size(); ++depth) {
    const ObjectId instance = scene_.id_of(way.instances[depth]);
    const bool own = depth + 1 == way.instances.size();
    file.push_back(scene_.transform(instance));
    const TransformFields now = transform(instance, t_s);
    for (const Driven& d : driven(scene_.at(instance).transform)) {
      const auto segment = animation_->segment(d.field, t_s);
      assert(segment && "a Transform's fields are vectors and rotations");
      piece.begin_s = std::max(piece.begin_s, segment->begin_s);
      piece.end_s = std::min(piece.end_s, segment->end_s);
      if (segment->initial) continue;
      moving.push_back({depth, d.part, *segment});
      if (segment->is_constant) continue;
      still = false;
      if (d.part == kTranslation) velocity += multiply(frame.linear, segment->velocity);
      if (own && d.part == kRotation) {
        angular_velocity_body = segment->angular_velocity_body;
        circles = !now.center.isZero(0.0);
        exact = exact && (!circles || is_evenly_scaled_above(id));
      } else {
        exact = exact && d.part == kTranslation;
      }
    }
    const Vec3& drift = drifts.emplace_back(velocity_of(instance));
    if (!drift.isZero(0.0) && t_s < 0.0) piece.end_s = std::min(piece.end_s, 0.0);
    if (!drift.isZero(0.0) && t_s >= 0.0) {
      piece.begin_s = std::max(piece.begin_s, 0.0);
      still = false;
      velocity += multiply(frame.linear, drift);
    }
    if (!own) frame = multiply(frame, parent_from_local(now));
  }
  const auto fields_at = [&](double s) {
    std::vector<TransformFields> fields = file;
    for (const Moving& m : moving) {
      set_part(fields[m.depth], m.part, m.segment.position_at(s), m.segment.orientation_at(s));
    }
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (s > 0.0) fields[i].translation += s * drifts[i];
    }
    return fields;
  };
  const auto pose_at = [&](double s) { return peerd::rigid_pose(way.stretch, fields_at(s)); };
  if (still) {
    piece.begin_s = std::max(piece.begin_s, t_s);
    piece.state = at_rest(pose_at(t_s));
    return piece;
  }
  const auto cut = [&](double step_s) {
    const double cell = std::floor(t_s / step_s);
    piece.begin_s = std::max(piece.begin_s, cell * step_s);
    piece.end_s = std::min(piece.end_s, (cell + 1.0) * step_s);
  };
  const bool dense = piece.end_s - piece.begin_s < kPiece_s;
  if (exact && !dense) {
    if (circles) cut(kCircle_s);
    piece.state = at_rest(pose_at(piece.begin_s));
    piece.state.velocity = velocity;
    piece.state.angular_velocity_body = angular_velocity_body;
    if (circles) go_about_center(piece, fields_at(piece.begin_s).back(), frame.linear);
    return piece;
  }
  if (dense) piece.begin_s = -kForever, piece.end_s = kForever;
  cut(kPiece_s);
  go_through(piece, [&](double s) { return dense ? pose_on(way, s) : pose_at(s); });
  return piece;
}

}  // namespace peerd
