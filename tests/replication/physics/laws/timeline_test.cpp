#include "replication/physics/laws/timeline.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::timeline_test {

using namespace test;

struct Case {
  const char* name;
  Duration at;
  double x;  // expected
};
class TimelineAt : public testing::TestWithParam<Case> {};
TEST_P(TimelineAt, TakesThePieceInForce) {
  Timeline line(sim(1s), moving({0, 0, 0}, {1, 0, 0}));
  line.replace_from(sim(3s), moving({10, 0, 0}, {0, 0, 0}, {2, 0, 0}), ObjectId{7});
  line.replace_from(sim(5s), moving({20, 0, 0}), std::nullopt);
  EXPECT_EQ(line.at(sim(GetParam().at)).position.x(), GetParam().x);
}
INSTANTIATE_TEST_SUITE_P(Table, TimelineAt,
                         testing::Values(Case{"BeforeTheFirstItHasNotMoved", 0s, 0}, Case{"AtTheFirst", 1s, 0},
                                         Case{"Within", 2s, 1}, Case{"APieceBeginsAtItsInstant", 3s, 10},
                                         Case{"JustBeforeIsStillTheOld", 3s - 1ns, 1.999999999},
                                         Case{"SecondOrder", 4s, 11}, Case{"TheLastGoesOn", 1000s, 20}),
                         [](const auto& c) { return std::string(c.param.name); });

TEST(Timeline, NextChangeIsStrictlyAfter) {
  Timeline line(sim(1s), moving({0, 0, 0}));
  line.replace_from(sim(3s), moving({1, 0, 0}), std::nullopt);
  EXPECT_EQ(line.next_change_after(sim(0s)), sim(1s));
  EXPECT_EQ(line.next_change_after(sim(1s)), sim(3s));
  EXPECT_EQ(line.next_change_after(sim(3s) - 1ns), sim(3s));
  EXPECT_EQ(line.next_change_after(sim(3s)), std::nullopt);
}

TEST(Timeline, KeepsTheCauseOfEachPiece) {
  Timeline line(sim(1s), moving({0, 0, 0}));
  line.replace_from(sim(2s), moving({1, 0, 0}), ObjectId{9});
  EXPECT_EQ(line.segment_at(sim(1s)).cause, std::nullopt);
  EXPECT_EQ(line.segment_at(sim(2s)).cause, ObjectId{9});
}

// Any sequence of edits gives the same as a map from instants to pieces, which is the plain meaning of each edit.
TEST(Timeline, AgreesWithAMapOfPieces) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    const auto draw = [&](int below) { return static_cast<int>(rng() % static_cast<std::uint64_t>(below)); };
    std::map<SimTime, double> oracle{{sim(50ns), 0.0}};
    Timeline line(sim(50ns), moving({0, 0, 0}));
    for (int step = 1; step <= 60; ++step) {
      const SimTime t = sim(Duration{draw(100)});
      switch (draw(4)) {
        case 0:
        case 1:
          oracle.erase(oracle.lower_bound(t), oracle.end());
          oracle[t] = step;
          line.replace_from(t, moving({static_cast<double>(step), 0, 0}), std::nullopt);
          break;
        case 2: {
          auto from = oracle.lower_bound(t);
          if (from == oracle.begin()) ++from;
          oracle.erase(from, oracle.end());
          line.truncate_from(t);
          break;
        }
        case 3: {
          auto in_force = oracle.upper_bound(t);
          if (in_force != oracle.begin()) oracle.erase(oracle.begin(), --in_force);
          line.forget_before(t);
          break;
        }
      }
      ASSERT_EQ(line.segment_count(), oracle.size());
      ASSERT_EQ(line.begin(), oracle.begin()->first);
      for (int ns = 0; ns <= 100; ++ns) {
        auto next = oracle.upper_bound(sim(Duration{ns}));
        const double expected = next == oracle.begin() ? next->second : std::prev(next)->second;
        ASSERT_EQ(line.at(sim(Duration{ns})).position.x(), expected) << "step " << step << " at " << ns;
        const auto later = std::distance(oracle.begin(), oracle.lower_bound(sim(Duration{ns})));
        ASSERT_EQ(line.first_not_before(sim(Duration{ns})), static_cast<std::size_t>(later));
      }
    }
  }
}

// The timeline keeps the piece of the last query. Neither the order of queries nor edits between them change any bit.
TEST(Timeline, AnswersDoNotDependOnWhatWasAskedBefore) {
  std::mt19937_64 rng(3);
  const auto draw = [&](double most) { return most * (2.0 * std::ldexp(static_cast<double>(rng() >> 11), -53) - 1.0); };
  const auto time = [&] { return sim(Duration{rng() % 2'000'000'000}); };
  for (int round = 0; round < 40; ++round) {
    const auto model = [&] {
      MotionModel m = moving({draw(9), draw(9), draw(9)}, {draw(9), draw(9), draw(9)}, {draw(9), draw(9), draw(9)});
      m.kind = kMotionKinds[rng() % std::size(kMotionKinds)];
      if (m.kind == MotionKind::kThird || m.kind == MotionKind::kOscillating) m.jerk = {draw(50), draw(50), draw(50)};
      if (m.kind == MotionKind::kOscillating) m.rate_rad_s = {3.0, 0.0, 0.1};
      if (m.kind == MotionKind::kTurning) m.rate_rad_s = {draw(3), draw(3), draw(3)};
      m.state.angular_velocity_body = {draw(3), 0, 0};
      if (rng() % 2 == 0) m.angular_acceleration_body = {0, draw(3), 0};
      return m;
    };
    Timeline asked(sim(0s), model());
    for (int step = 0; step < 200; ++step) {
      const SimTime t = time();
      switch (rng() % 6) {
        case 0:
          asked.replace_from(t, model(), std::nullopt);
          break;
        case 1:
          asked.truncate_from(t);
          break;
        case 2:
          if (rng() % 4 == 0) asked.forget_before(t);
          break;
        default:
          break;
      }
      Timeline fresh(asked.begin(), asked.segment(0).model);
      for (std::size_t i = 1; i < asked.segment_count(); ++i) {
        const Timeline::Segment& s = asked.segment(i);
        fresh.replace_from(s.from, s.model, s.cause);
      }
      const SimTime begins = asked.segment(rng() % asked.segment_count()).from;
      std::vector<SimTime> times = {t, t + 1ns, t + 10ms, begins - 1ns, begins, begins + 1ns, time()};
      std::ranges::shuffle(times, rng);
      for (const SimTime at : times) {
        ASSERT_EQ(asked.last_change_until(at), Timeline(fresh).last_change_until(at));
        ASSERT_EQ(asked.next_change_after(at), Timeline(fresh).next_change_after(at));
        ASSERT_TRUE(same_bits(asked.at(at), Timeline(fresh).at(at)));
        ASSERT_EQ(asked.last_change_until(at), Timeline(fresh).last_change_until(at));
      }
    }
  }
}

}  // namespace peerd::replication::timeline_test
