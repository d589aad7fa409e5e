#include "core/motion/sensor_events.hpp"

#include <algorithm>
#include <array>

namespace peerd {
namespace {

struct SensorEvents {
  std::string_view type;
  std::span<const std::string_view> events;
};

constexpr std::array<std::string_view, 2> kTouchEvents{"isActive", "touchTime"};
constexpr std::array<std::string_view, 4> kPlaneEvents{"isActive", "offset", "trackPoint_changed",
                                                       "translation_changed"};
constexpr std::array<std::string_view, 4> kTurnEvents{"isActive", "offset", "rotation_changed", "trackPoint_changed"};
constexpr std::array<std::string_view, 3> kProximityEvents{"enterTime", "exitTime", "isActive"};
constexpr std::array<SensorEvents, 5> kSensorEvents{{{"TouchSensor", kTouchEvents},
                                                     {"PlaneSensor", kPlaneEvents},
                                                     {"CylinderSensor", kTurnEvents},
                                                     {"SphereSensor", kTurnEvents},
                                                     {"ProximitySensor", kProximityEvents}}};

}  // namespace

std::span<const std::string_view> events_by_people(std::string_view node_type) {
  const auto known = std::ranges::find(kSensorEvents, node_type, &SensorEvents::type);
  return known == kSensorEvents.end() ? std::span<const std::string_view>() : known->events;
}

}  // namespace peerd
