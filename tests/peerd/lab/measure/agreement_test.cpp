#include "peerd/lab/measure/agreement.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "tests/peerd/report_samples.hpp"

namespace peerd::measure::agreement_test {

using enum Verdict;
using samples::kA, samples::kB, samples::kC, samples::kCar, samples::kCube, samples::kWall;

const Vec3 kLeft = -Vec3::UnitX();
const Vec3 kRight = Vec3::UnitX();

ContactRow row(double t_s, PeerId peer, const char* kind, const Vec3& normal = kRight, double late_s = 0.01) {
  return {t_s, peer, kind, kCar, kWall, normal, t_s + late_s};
}

struct Case {
  const char* name;
  std::vector<ContactRow> contacts;
  std::vector<Verdict> verdicts;  // verdicts of the contacts
  std::uint64_t missed;           // two other peers see each outcome of a
};

void PrintTo(const Case& c, std::ostream* os) { *os << c.name; }

class SideBySide : public testing::TestWithParam<Case> {};

TEST_P(SideBySide, VerdictsAndCounts) {
  RunRecord run = samples::quiet_run();
  run.contacts = GetParam().contacts;
  const Agreement a = agreement(run);
  EXPECT_EQ(a.verdicts, GetParam().verdicts);
  EXPECT_EQ(a.missed, GetParam().missed);
  const auto count = [&](Verdict v) { return static_cast<std::uint64_t>(std::ranges::count(a.verdicts, v)); };
  EXPECT_EQ(a.decided, count(kOutcome));
  EXPECT_EQ(a.agreed, count(kAgreed));
  EXPECT_EQ(a.disagreed, count(kDisagreed));
  EXPECT_EQ(a.spurious, count(kSpurious));
  EXPECT_EQ(a.revised, count(kRevised));
  EXPECT_EQ(a.latency_s.size(), a.agreed + a.disagreed);
}

TEST_P(SideBySide, OrderOfRowsDoesNotMatter) {
  RunRecord run = samples::quiet_run();
  run.contacts = GetParam().contacts;
  std::ranges::reverse(run.contacts);
  std::vector<Verdict> verdicts = agreement(run).verdicts;
  std::ranges::reverse(verdicts);
  if (std::ranges::count(verdicts, kRepeated) > 0) return;  // which row is the repetition is a matter of order
  EXPECT_EQ(verdicts, GetParam().verdicts);
}

INSTANTIATE_TEST_SUITE_P(
    Table, SideBySide,
    testing::Values(
        Case{"Nothing", {}, {}, 0}, Case{"NobodySawIt", {row(3, kA, "owner")}, {kOutcome}, 2},
        Case{"BothAgree",
             {row(3, kA, "owner"), row(3.1, kB, "predicted"), row(3, kC, "applied")},
             {kOutcome, kAgreed, kAgreed},
             0},
        Case{"OtherSide", {row(3, kA, "owner", kLeft), row(3, kB, "predicted")}, {kOutcome, kDisagreed}, 1},
        Case{"NearlyParallelIsTheSameSide",
             {row(3, kA, "owner"), row(3, kB, "predicted", Vec3(0.1, 0.99, 0))},
             {kOutcome, kAgreed},
             1},
        Case{"WithoutNormalsAgree",
             {row(3, kA, "owner", Vec3::Zero()), row(3, kB, "predicted", Vec3::Zero())},
             {kOutcome, kAgreed},
             1},
        Case{"NoSuchOutcome", {row(3, kB, "predicted")}, {kSpurious}, 0},
        // Gap 2 s, so windows of 1 s.
        Case{"OutsideEveryWindow",
             {row(3, kA, "owner"), row(5, kA, "owner"), row(6.5, kB, "predicted")},
             {kOutcome, kOutcome, kSpurious},
             4},
        Case{"NearestOfTwo",
             {row(3, kA, "owner"), row(5, kA, "owner"), row(4.1, kB, "predicted"), row(3.9, kC, "predicted")},
             {kOutcome, kOutcome, kAgreed, kAgreed},
             2},
        Case{"TieGoesToTheEarlier",
             {row(3, kA, "owner"), row(5, kA, "owner", kLeft), row(4, kB, "predicted")},
             {kOutcome, kOutcome, kAgreed},
             3},
        Case{"ShortestGapRules",
             {row(1, kA, "owner"), row(1.2, kA, "owner"), row(8, kA, "owner"), row(7.5, kB, "predicted")},
             {kOutcome, kOutcome, kOutcome, kSpurious},
             6},
        Case{"LastWordCounts",
             {row(3, kA, "owner"), row(3, kB, "predicted", kLeft, 0.01), row(3, kB, "applied", kRight, 0.2)},
             {kOutcome, kRevised, kAgreed},
             1},
        Case{"AppliedComesAfterPredictedAtOneTime",
             {row(3, kA, "owner"), row(3, kB, "applied", kRight, 0.2), row(3, kB, "predicted", kLeft, 0.2)},
             {kOutcome, kAgreed, kRevised},
             1},
        Case{"SaidTwice", {row(3, kA, "owner"), row(3, kA, "decided")}, {kOutcome, kRepeated}, 2},
        Case{"AuthorsPredictionIsItsOwn", {row(3, kA, "owner"), row(3.1, kA, "predicted")}, {kOutcome, kOwn}, 2},
        Case{"TwoClaimsOfOneContact",
             {row(3, kA, "decided"), row(3.1, kB, "decided"), row(3.02, kC, "predicted")},
             {kOutcome, kOutcome, kAgreed},
             3}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(Agreement, PairIsUnordered) {
  RunRecord run = samples::quiet_run();
  run.contacts = {{3, kA, "decided", kCar, kCube, kRight, 3}, {3, kB, "applied", kCube, kCar, kLeft, 3.1}};
  EXPECT_THAT(agreement(run).verdicts, testing::ElementsAre(kOutcome, kAgreed));
}

TEST(Agreement, SingleContactTakesItsCollidersGap) {  // CAR meets the wall at 3 and the cube at 4: windows of 0.5 s
  RunRecord run = samples::quiet_run();
  run.contacts = {{3, kA, "owner", kCar, kWall, kRight, 3},
                  {4, kA, "owner", kCar, kCube, kRight, 4},
                  {3.4, kB, "predicted", kCar, kWall, kRight, 3.4},
                  {3.6, kC, "predicted", kCar, kWall, kRight, 3.6}};
  EXPECT_THAT(agreement(run).verdicts, testing::ElementsAre(kOutcome, kOutcome, kAgreed, kSpurious));
}

// Decisions alone are judged by the decisions that were applied: contact times must be the same.
TEST(Agreement, SharedCountsAppliedDecisions) {
  RunRecord run = samples::quiet_run();
  run.contacts = {row(1, kA, "owner"),          row(1, kB, "predicted"), row(3, kA, "decided"), row(3, kB, "applied"),
                  row(3, kC, "applied", kLeft), row(5, kA, "decided"),   row(5, kB, "applied"), row(5, kC, "predicted"),
                  row(5.001, kC, "applied"),    row(7, kA, "decided"),   row(7, kB, "decided"), row(7, kC, "applied")};
  const Agreement::Shared s = agreement(run).shared;
  EXPECT_EQ(s.decided, 3u);
  EXPECT_EQ(s.agreed, 4u);     // b at 3 and 5, b and c at 7
  EXPECT_EQ(s.disagreed, 1u);  // c at 3
  EXPECT_EQ(s.missed, 1u);     // c at 5: a prediction is not that decision, nor is another one
  EXPECT_EQ(s.spurious, 1u);
}

TEST(Agreement, LatencyRunsToTheFirstStatementThatStays) {
  RunRecord run = samples::quiet_run();
  run.contacts = {row(3, kA, "owner"), row(3, kB, "predicted", kLeft, 0.1), row(3, kB, "predicted", kRight, 0.25),
                  row(3, kB, "applied", kRight, 0.5)};
  const Agreement a = agreement(run);
  ASSERT_EQ(a.latency_s.size(), 1u);
  EXPECT_DOUBLE_EQ(a.latency_s.front(), 0.25);
}

}  // namespace peerd::measure::agreement_test
