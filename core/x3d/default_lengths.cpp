#include "core/x3d/default_lengths.hpp"

#include <algorithm>
#include <iterator>
#include <span>
#include <string_view>
#include <vector>

#include "core/vrml/default_values.hpp"

namespace peerd::vrml {
namespace {

struct Length {
  std::string_view node, field;
};
// All lengths of VRML97 that are not 0 by default, and are no mark such as the -1 of a bboxSize; by node.
constexpr Length kLengths[] = {
    {"Box", "size"},
    {"Cone", "bottomRadius"},
    {"Cone", "height"},
    {"Cylinder", "height"},
    {"Cylinder", "radius"},
    {"ElevationGrid", "xSpacing"},
    {"ElevationGrid", "zSpacing"},
    {"Extrusion", "crossSection"},
    {"Extrusion", "spine"},
    {"FontStyle", "size"},
    {"NavigationInfo", "avatarSize"},
    {"NavigationInfo", "speed"},
    {"PointLight", "radius"},
    {"Sound", "maxBack"},
    {"Sound", "maxFront"},
    {"Sound", "minBack"},
    {"Sound", "minFront"},
    {"Sphere", "radius"},
    {"SpotLight", "radius"},
    {"Viewpoint", "position"},
};
static_assert(std::ranges::is_sorted(kLengths, {}, &Length::node));

}  // namespace

void give_default_lengths(Node& node, Arena& arena, double metres_per_unit) {
  const auto lengths = std::ranges::equal_range(kLengths, node.type->name, {}, &Length::node);
  if (lengths.empty() || find_node_type(node.type->name) != node.type) return;
  std::vector<Field> fields(node.given().begin(), node.given().end());
  for (const Length& length : lengths) {
    if (node.find(length.field) != nullptr) continue;
    Field field = value_of(node, length.field);
    const std::span<float> converted = arena.allocate<float>(field.count);
    std::ranges::transform(field.as<float>(), converted.begin(), [&](float metres) {
      return static_cast<float>(static_cast<double>(metres) / metres_per_unit);
    });
    field.spec = find_field(*node.type, length.field);
    field.data = converted.data();
    field.at = node.at;
    fields.push_back(field);
  }
  const auto kept = arena.copy(std::span<const Field>(fields));
  node.fields = kept.data();
  node.field_count = static_cast<std::uint32_t>(kept.size());
}

}  // namespace peerd::vrml
