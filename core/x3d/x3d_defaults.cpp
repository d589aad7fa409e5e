#include "core/x3d/x3d_defaults.hpp"

#include <array>
#include <cstdint>
#include <string_view>

namespace peerd::vrml {
namespace {

// ISO/IEC 19775-1:2013, 17.4.3 and 23.4.4. X3D 4.0 has 3/16 of pi for the beamWidth.
constexpr float kBeamWidth = 0.7853982F, kCutOffAngle = 1.5707964F;
constexpr std::array<std::string_view, 2> kNavigation{"EXAMINE", "ANY"};

struct Default {
  std::string_view node, field;
  const void* data;
  std::uint32_t count;
};
constexpr Default kDefaults[] = {{"NavigationInfo", "type", kNavigation.data(), 2},
                                 {"SpotLight", "beamWidth", &kBeamWidth, 1},
                                 {"SpotLight", "cutOffAngle", &kCutOffAngle, 1}};

}  // namespace

std::vector<Field> x3d_defaults_of(const NodeType& type) {
  std::vector<Field> fields;
  for (const Default& one : kDefaults) {
    if (one.node == type.name) fields.push_back({find_field(type, one.field), one.data, one.count, 0});
  }
  return fields;
}

}  // namespace peerd::vrml
