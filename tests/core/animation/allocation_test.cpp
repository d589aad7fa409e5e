#include <gtest/gtest.h>

#include "core/animation/animation.hpp"
#include "tests/allocation_counter.hpp"

#if PEERD_COUNTS_ALLOCATIONS
namespace peerd::animation::allocation_test {

TEST(Allocation, QuestionsMakeNoneOnceBuffersHaveGrown) {
  constexpr auto kFloat = FieldType::kFloat;
  const std::vector<float> key{0, 0.5, 1};
  Network n{{TimeSensorFields{4, true, true, 0, 0}, TimeSensorFields{3, true, true, 0, 0},
             Interpolator{InterpolatorType::kPosition, key, std::vector<float>(9, 1.0f)},
             Interpolator{InterpolatorType::kOrientation, key, std::vector<float>(12, 1.0f)},
             Interpolator{InterpolatorType::kCoordinate, key, std::vector<float>(900, 1.0f)}, PlainNode{}},
            {{0, "fraction_changed", 2, "set_fraction", kFloat},
             {0, "fraction_changed", 3, "set_fraction", kFloat},
             {1, "fraction_changed", 3, "set_fraction", kFloat},
             {1, "fraction_changed", 4, "set_fraction", kFloat},
             {2, "value_changed", 5, "translation", FieldType::kVec3},
             {3, "value_changed", 5, "rotation", FieldType::kRotation},
             {4, "value_changed", 5, "point", FieldType::kVec3s}}};
  Animation a(n);
  const FieldId fields[] = {*a.field(5, "translation"), *a.field(5, "rotation"), *a.field(5, "point")};
  Value v;
  std::vector<FieldId> moving;
  double sum = 0.0;
  long first = 0;
  for (int i = 0; i < 1000; ++i) {
    if (i == 10) first = allocations();
    const double t = 0.01 * i;
    a.changing(t, t + 0.01, moving);
    for (const FieldId f : fields) {
      ASSERT_TRUE(a.value(f, t, v));
      sum += v.number[0];
      if (const auto s = a.segment(f, t)) sum += s->velocity.x();
    }
  }
  EXPECT_EQ(allocations(), first);
  EXPECT_NE(sum, 0.0);
}

}  // namespace peerd::animation::allocation_test
#endif
