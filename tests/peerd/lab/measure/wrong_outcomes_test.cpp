#include "peerd/lab/measure/wrong_outcomes.hpp"

#include <gtest/gtest.h>

#include "peerd/lab/report/table.hpp"
#include "tests/peerd/report_samples.hpp"

namespace peerd::measure::wrong_outcomes_test {

using samples::kA, samples::kB, samples::kCar, samples::kCube, samples::kWall;

const Vec3 kRight = Vec3::UnitX();

ContactRow decided(double t_s, const Vec3& normal = kRight) { return {t_s, kA, "decided", kCar, kCube, normal, t_s}; }
ContactRow turned(double t_s, const Vec3& normal) { return {t_s, kB, "decided", kCube, kCar, normal, t_s}; }

struct Case {
  const char* name;
  std::vector<ContactRow> run, truth;
  std::uint64_t missing, spurious;
};
class Wrong : public testing::TestWithParam<Case> {};
TEST_P(Wrong, OutcomesAreCounted) {
  RunRecord run = samples::quiet_run(), truth = samples::quiet_run();
  run.contacts = GetParam().run;
  truth.contacts = GetParam().truth;
  const WrongOutcomes wrong = wrong_outcomes(run, truth);
  EXPECT_EQ(wrong.truth, GetParam().truth.size());
  EXPECT_EQ(wrong.missing, GetParam().missing);
  EXPECT_EQ(wrong.spurious, GetParam().spurious);
}
INSTANTIATE_TEST_SUITE_P(Table, Wrong,
                         testing::Values(Case{"Right", {decided(3.2)}, {decided(3)}, 0, 0},
                                         Case{"Late", {decided(3.3)}, {decided(3)}, 1, 1},
                                         Case{"OtherSide", {decided(3, -kRight)}, {decided(3)}, 1, 1},
                                         Case{"Beside", {decided(3, Vec3::UnitZ())}, {decided(3)}, 1, 1},
                                         Case{"NamedTheOtherWayRound", {turned(3, -kRight)}, {decided(3)}, 0, 0},
                                         Case{"Missing", {}, {decided(3), decided(5)}, 2, 0},
                                         Case{"Spurious", {decided(3)}, {}, 0, 1},
                                         Case{"EachCountsOnce", {decided(3), decided(3.1)}, {decided(3)}, 0, 1},
                                         Case{"OneTooFew", {decided(3)}, {decided(2.9), decided(3.1)}, 1, 0}),
                         [](const auto& c) { return std::string(c.param.name); });

TEST(WrongOf, WhatIsNotBetweenPeersIsNot) {
  RunRecord run = samples::quiet_run();
  run.contacts = {{3, kA, "owner", kCar, kWall, kRight, 3}, {3, kB, "predicted", kCar, kCube, kRight, 3}};
  EXPECT_EQ(wrong_outcomes(run, samples::quiet_run()).spurious, 0u);
}

TEST(WrongOutcomesTable, HasARowForEachPolicyAndSumsTheRest) {
  const auto run = [](const char* policy, int latency, std::uint64_t missing, std::uint64_t spurious) {
    return nlohmann::ordered_json{
        {"params", {{"decisions.policy", policy}, {"network.latency_ms", latency}}},
        {"collisions", {{"wrong", {{"truth", 4}, {"missing", missing}, {"spurious", spurious}}}}}};
  };
  const nlohmann::ordered_json summary = {
      {"runs", {run("id", 0, 0, 0), run("id", 500, 3, 1), run("server", 0, 0, 0), run("server", 500, 0, 2)}}};
  EXPECT_EQ(report::wrong_outcomes_table(summary),
            "\n"
            "of up to 4 outcomes a run without latency:\n"
            "wrong outcomes  latency 0 ms  latency 500 ms\n"
            "id                         0               4\n"
            "server                     0               2\n");
}

TEST(WrongOutcomesTable, IsNotThereWhereNothingWasCompared) {
  const nlohmann::ordered_json summary = {{"runs", {{{"params", {{"a", 1}}}, {"collisions", {{"decided", 1}}}}}}};
  EXPECT_EQ(report::wrong_outcomes_table(summary), "");
}

}  // namespace peerd::measure::wrong_outcomes_test
