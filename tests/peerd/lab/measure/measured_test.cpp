#include "peerd/lab/measure/measured.hpp"

#include <gtest/gtest.h>

namespace peerd::measure::measured_test {

TEST(Measured, FindsViewsAndSums) {
  Measured m;
  for (const std::uint32_t object : {3u, 5u}) {
    ViewMeasured& view = m.views.emplace_back(ViewMeasured{.observer = PeerId{2}, .object = ObjectId{object}});
    view.ghost_error_m.count = 10 * object;
    view.not_finite = 1;
  }
  m.updates = {{ObjectId{3}, {4, 100}}, {ObjectId{5}, {6, 100}}};
  ASSERT_NE(m.view(PeerId{2}, ObjectId{5}), nullptr);
  EXPECT_EQ(m.view(PeerId{2}, ObjectId{5})->ghost_error_m.count, 50u);
  EXPECT_EQ(m.view(PeerId{2}, ObjectId{4}), nullptr);
  EXPECT_EQ(m.view(PeerId{3}, ObjectId{3}), nullptr);
  EXPECT_EQ(m.samples(), 82u) << "those without a number count, too";
  EXPECT_EQ(m.updates_sent(), 10u);
}

}  // namespace peerd::measure::measured_test
