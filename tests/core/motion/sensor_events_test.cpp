#include "core/motion/sensor_events.hpp"

#include <gmock/gmock.h>

namespace peerd::sensor_events_test {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(SensorEvents, AreThoseThatComeSeldom) {
  EXPECT_THAT(events_by_people("TouchSensor"), ElementsAre("isActive", "touchTime"));
  EXPECT_THAT(events_by_people("ProximitySensor"), ElementsAre("enterTime", "exitTime", "isActive"));
  EXPECT_THAT(events_by_people("VisibilitySensor"), IsEmpty());
  EXPECT_THAT(events_by_people("TimeSensor"), IsEmpty());
}

}  // namespace peerd::sensor_events_test
