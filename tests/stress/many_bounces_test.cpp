#include "tests/stress/many_bounces.hpp"

#include <cstdio>

namespace peerd::stress::many_bounces_test {

struct Case {
  const char* name;
  const char* geometry;
  double low_m;
  const char* response;
  std::uint64_t bounces;
};
class ManyTimes : public testing::TestWithParam<Case> {};
TEST_P(ManyTimes, ABallKeepsItsEnergy) {
  const Case& c = GetParam();
  const ManyBounces b = bounce(c.geometry, c.low_m, c.response, c.bounces);
  std::printf("%llu bounces in %.0f s: energy within %.3g, %.3g m below the floor\n",
              static_cast<unsigned long long>(b.bounces), b.simulated_s, b.energy_error, b.lowest_m);
  EXPECT_GE(b.bounces, c.bounces);
  EXPECT_EQ(b.came_to_rest + b.jammed + b.overlapped, 0u);
  EXPECT_LT(b.energy_error, kEnergyBound);
  EXPECT_LE(b.lowest_m, 0.0);
}
INSTANTIATE_TEST_SUITE_P(
    Table, ManyTimes,
    testing::Values(Case{"Box", "Box { size 0.2 0.2 0.2 }", 0.5 * static_cast<double>(0.2F), "responseType 0", 100'000},
                    Case{"Ball", "Sphere { radius 0.125 }", 0.125, "responseType 0", 2'000},
                    Case{"BallByImpulse", "Sphere { radius 0.125 }", 0.125, "responseType 2 restitution 1", 2'000}),
    [](const auto& c) { return std::string(c.param.name); });

}  // namespace peerd::stress::many_bounces_test
