#include "core/motion/flexible_shape.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/geometry/tessellate.hpp"

namespace peerd {
namespace {

double largest_part(const Vec3& scale) { return scale.cwiseAbs().maxCoeff(); }

}  // namespace

FlexibleShape::FlexibleShape(const Scene& scene, const PredefinedMotion& motion, ObjectId shape,
                             std::optional<ObjectId> carrier)
    : scene_(scene), shape_(shape) {
  assert(scene.geometry(shape) != nullptr);
  std::vector<TransformFields> beyond;
  for (auto i = static_cast<std::int32_t>(scene.index_of(shape)); i >= 0;) {
    const Instance& instance = scene.instances[static_cast<std::size_t>(i)];
    const ObjectId id = scene.id_of(static_cast<std::uint32_t>(i));
    if (!beyond.empty() || (carrier && id == *carrier)) {
      beyond.push_back(scene.transform(id));
    } else if (instance.transform != Instance::kNone) {
      transforms_.push_back(id);
    }
    i = instance.parent;
  }
  std::ranges::reverse(transforms_);
  std::ranges::reverse(beyond);
  if (!beyond.empty()) stretch_ = stretched_pose(beyond).stretch;
  bends_ = std::ranges::binary_search(motion.flexible_geometries(), scene.at(shape).geometry);
  rigid_mesh_ = build_mesh(*scene.geometry(shape), scene.tessellation);
}

Mesh FlexibleShape::mesh(PredefinedMotion& motion, double t_s) const {
  return bends_ ? build_mesh(motion.geometry(scene_.at(shape_).geometry, t_s), scene_.tessellation) : rigid_mesh_;
}

Affine FlexibleShape::carrier_from_shape(PredefinedMotion& motion, double t_s) const {
  Affine product{stretch_, Vec3::Zero()};
  for (const ObjectId id : transforms_) product = multiply(product, parent_from_local(motion.transform(id, t_s)));
  return product;
}

// With p' = A p + b at each Transform, |p'| and its derivatives are bounded by those of A, b and p (product rule), from
// the Shape up.
FlexibleShape::Course FlexibleShape::course(PredefinedMotion& motion, double t_s, double h_s) const {
  assert(h_s > 0.0);
  Course c{.end_s = std::numeric_limits<double>::infinity()};
  const auto farthest = [](const Mesh& mesh) {
    double most = 0.0;
    for (const Eigen::Vector3f& v : mesh.vertices) most = std::max(most, v.cast<double>().norm());
    return most;
  };
  if (bends_) {
    const auto span = motion.vertex_span(scene_.at(shape_).geometry, t_s);
    c.end_s = span.end_s;
    const Mesh now = mesh(motion, t_s);
    c.distance_m = farthest(now);
    const double until_s = std::min(t_s + h_s, span.end_s);
    if (span.moves && until_s > t_s) {
      const Mesh then = mesh(motion, 0.5 * (t_s + until_s));  // at its end the vertices may jump
      for (std::size_t i = 0; i < std::min(now.vertices.size(), then.vertices.size()); ++i) {
        const double way = (then.vertices[i] - now.vertices[i]).cast<double>().norm();
        c.speed_m_s = std::max(c.speed_m_s, way / (0.5 * (until_s - t_s)));
      }
      c.speed_m_s *= 1.0 + 0x1p-10;  // the vertices are binary32
      c.distance_m += h_s * c.speed_m_s;
    }
  } else {
    c.distance_m = farthest(rigid_mesh_);
  }
  for (std::size_t i = transforms_.size(); i-- > 0;) {
    const PredefinedMotion::FieldRates r = motion.field_rates(transforms_[i], t_s);
    c.end_s = std::min(c.end_s, r.end_s);
    const double w = r.rotation_rad_s, u = r.scale_orientation_rad_s, s1 = r.scale_1_s;
    const double scale = largest_part(r.fields.scale) + h_s * s1;
    // SR S SR^-1 and its derivatives, then with the rotation before it.
    const double x1 = 2.0 * u * scale + s1, x2 = 4.0 * u * (u * scale + s1);
    const double a0 = scale, a1 = w * scale + x1, a2 = w * w * scale + 2.0 * w * x1 + x2;
    const double center = r.fields.center.norm() + h_s * r.center_m_s;
    const double b0 = r.fields.translation.norm() + h_s * r.translation_m_s + (1.0 + a0) * center;
    const double b1 = r.translation_m_s + (1.0 + a0) * r.center_m_s + a1 * center;
    const double b2 = a2 * center + 2.0 * a1 * r.center_m_s;
    c.acceleration_m_s2 = a2 * c.distance_m + 2.0 * a1 * c.speed_m_s + a0 * c.acceleration_m_s2 + b2;
    c.speed_m_s = a1 * c.distance_m + a0 * c.speed_m_s + b1;
    c.distance_m = a0 * c.distance_m + b0;
  }
  const double stretch = stretch_.norm();
  c.distance_m *= stretch;
  c.speed_m_s *= stretch;
  c.acceleration_m_s2 *= stretch;
  return c;
}

}  // namespace peerd
