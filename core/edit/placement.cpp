#include "core/edit/placement.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>

#include <Eigen/Geometry>

#include "core/transform.hpp"

namespace peerd {
namespace {

// The shortest text that is read as the binary32 number again.
std::string text_of(std::initializer_list<double> numbers) {
  std::string text;
  for (const double number : numbers) {
    std::array<char, 32> digits{};
    const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), static_cast<float>(number));
    text += (text.empty() ? "" : " ") + std::string(digits.data(), end);
  }
  return text;
}

std::string text_of_rotation(const Quat& q) {
  const Vec3 axis = q.vec();
  const double sine = axis.norm();
  if (sine == 0) return "0 0 1 0";
  const double angle = 2 * std::atan2(sine, q.w());
  return text_of({axis.x() / sine, axis.y() / sine, axis.z() / sine, angle});
}

}  // namespace

std::optional<Placement> placement_of(const Scene& scene, ObjectId instance, const Pose& world) {
  const Instance& placed = scene.at(instance);
  if (placed.transform == Instance::kNone) return std::nullopt;
  if (std::ranges::count(scene.instances, placed.node, &Instance::node) > 1) return std::nullopt;
  TransformFields fields = scene.transform(instance);
  Vec3 origin = world.position;  // in the frame of the parent
  fields.rotation = world.orientation;
  if (const auto parent = scene.parent_of(instance)) {
    const Eigen::Affine3d above = scene.world_from_local(*parent);
    if (above.linear().determinant() == 0) return std::nullopt;
    origin = above.inverse() * origin;
    fields.rotation = scene.rigid_pose(*parent).orientation.conjugate() * fields.rotation;
  }
  fields.translation = Vec3::Zero();
  const Vec3 translation = origin - parent_from_local(fields).offset;
  if (!translation.cast<float>().allFinite()) return std::nullopt;
  return Placement{text_of({translation.x(), translation.y(), translation.z()}), text_of_rotation(fields.rotation)};
}

}  // namespace peerd
