#include "collision/engines/space_time.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "tests/collision/soups.hpp"

namespace peerd::collision::engines::space_time_test {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

WorldBox cube_at(const Vec3& center, double half) {
  return {center - Vec3::Constant(half), center + Vec3::Constant(half)};
}

TEST(SpaceTime, BoxesMeetWhenTheirSidesDo) {
  const WorldBox a = cube_at({0, 0, 0}, 1.0), b = cube_at({12, 0, 0}, 1.0);
  SpaceTimeBound rests{.end_s = kInfinity}, comes{.velocity_m_s = {-2, 0, 0}, .end_s = kInfinity};
  EXPECT_EQ(earliest_overlap_s(a, rests, b, rests, 3.0), kInfinity);
  EXPECT_NEAR(earliest_overlap_s(a, rests, b, comes, 3.0), 8.0, 1e-9);
  EXPECT_NEAR(earliest_overlap_s(b, comes, a, rests, 3.0), 8.0, 1e-9);
  EXPECT_LE(earliest_overlap_s(a, rests, b, comes, 3.0), 8.0);
  SpaceTimeBound leaves{.velocity_m_s = {2, 0, 0}, .end_s = kInfinity};
  EXPECT_EQ(earliest_overlap_s(a, rests, b, leaves, 3.0), kInfinity);
  leaves.end_s = 3.5;
  EXPECT_NEAR(earliest_overlap_s(a, rests, b, leaves, 3.0), 3.5, 1e-9) << "then it may jump";
  SpaceTimeBound brakes{.velocity_m_s = {2, 0, 0}, .acceleration_m_s2 = 4.0, .end_s = kInfinity};
  EXPECT_NEAR(earliest_overlap_s(a, rests, b, brakes, 0.0), (1.0 + std::sqrt(21.0)) / 2.0, 1e-9) << "-2 t + 2 t^2 = 10";
  EXPECT_EQ(earliest_overlap_s(a, SpaceTimeBound{}, b, rests, 3.0), 3.0) << "nothing is known";
}

// Objects on parabolas that change at times of their own; some jump then. Nothing is known of the last one.
class Flights : public SpaceTime {
 public:
  Flights(std::size_t objects, std::uint64_t seed) : numbers_(seed), flights_(objects) {
    for (std::size_t i = 0; i < objects; ++i) begin(i, 0.0, Vec3(numbers_.point(7.0)));
  }
  void set_time(double now_s) {
    now_s_ = now_s;
    for (std::size_t i = 0; i < flights_.size(); ++i) {
      while (flights_[i].end_s <= now_s) {
        const Vec3 last = place(i, flights_[i].end_s);
        const bool jumps = numbers_.unit() < 0.2 || last.cwiseAbs().maxCoeff() > 9.0;
        begin(i, flights_[i].end_s, jumps ? Vec3(numbers_.point(7.0)) : last);
      }
    }
  }
  [[nodiscard]] WorldBox box(std::size_t i) const {
    return cube_at(place(i, now_s_), 0.5 + 0.1 * static_cast<double>(i % 5));
  }

  [[nodiscard]] double now_s() const override { return now_s_; }
  [[nodiscard]] SpaceTimeBound bound(BroadIndex i) override {
    const Flight& f = flights_[i];
    const double h = now_s_ - f.begin_s;
    SpaceTimeBound out{
        .velocity_m_s = f.velocity + h * f.acceleration, .acceleration_m_s2 = f.acceleration.norm(), .end_s = f.end_s};
    if (i + 1 == flights_.size()) out = {};
    // A velocity that is only bounded is as good.
    if (i % 3 == 1) out.spread_m_s = out.velocity_m_s.norm(), out.velocity_m_s.setZero();
    return out;
  }

 private:
  struct Flight {
    double begin_s = 0.0, end_s = 0.0;
    Vec3 from = Vec3::Zero(), velocity = Vec3::Zero(), acceleration = Vec3::Zero();
  };
  void begin(std::size_t i, double at_s, const Vec3& from) {
    const bool rests = i % 4 == 3;
    flights_[i] = {at_s, at_s + numbers_.between(0.2, 5.0), from, rests ? Vec3(Vec3::Zero()) : numbers_.point(3.0),
                   rests ? Vec3(Vec3::Zero()) : numbers_.point(0.5)};
  }
  [[nodiscard]] Vec3 place(std::size_t i, double t_s) const {
    const Flight& f = flights_[i];
    const double h = t_s - f.begin_s;
    return f.from + h * f.velocity + 0.5 * h * h * f.acceleration;
  }
  Numbers numbers_;
  std::vector<Flight> flights_;
  double now_s_ = 0.0;
};

// The pairs of each tick are those of every box against every other one, while interests and groups change.
TEST(SpaceTimeBroadPhase, IsNeverLate) {
  constexpr std::size_t kObjects = 40;
  constexpr int kTicks = 1200;
  Flights flights(kObjects, 5);
  SpaceTimeBroadPhase broad(flights);
  const auto brute = make_broad_phase(BroadPhaseMethod::kBruteForce);
  for (BroadIndex i = 0; i < kObjects; ++i) {
    broad.add(i, flights.box(i));
    brute->add(i, flights.box(i));
  }
  Numbers numbers(6);
  const auto any = [&] { return static_cast<BroadIndex>(numbers.unit() * kObjects); };
  for (BroadIndex i = 0; i < kObjects; ++i) {
    for (BroadIndex j = 0; j < i; ++j) {
      if (numbers.unit() < 0.5) {
        EXPECT_EQ(broad.register_interest(i, j), brute->register_interest(i, j));
      }
    }
  }
  std::size_t found = 0;
  for (int tick = 0; tick < kTicks; ++tick) {
    flights.set_time(tick / 60.0);
    const BroadIndex a = any(), b = any();
    if (a != b && tick % 3 == 0) {
      EXPECT_EQ(broad.register_interest(a, b), brute->register_interest(a, b));
    }
    if (a != b && tick % 3 == 1) {
      EXPECT_EQ(broad.unregister_interest(a, b), brute->unregister_interest(a, b));
    }
    if (tick % 7 == 2) {
      EXPECT_EQ(broad.join(1, a), brute->join(1, a));
    }
    if (tick % 7 == 5) {
      EXPECT_EQ(broad.leave(1, b), brute->leave(1, b));
    }
    if (tick % 100 == 99) {
      broad.remove(a);
      brute->remove(a);
      broad.add(a, flights.box(a));
      brute->add(a, flights.box(a));
    }
    for (BroadIndex i = 0; i < kObjects; ++i) {
      broad.move(i, flights.box(i));
      brute->move(i, flights.box(i));
    }
    const auto said = broad.tick(), right = brute->tick();
    ASSERT_TRUE(std::ranges::equal(said, right)) << "tick " << tick;
    found += said.size();
  }
  EXPECT_GT(found, 1000u);
  EXPECT_LT(broad.counters().box_tests * 4, brute->counters().box_tests);
  EXPECT_GT(broad.counters().pairs_postponed, brute->counters().box_tests / 2);
}

}  // namespace peerd::collision::engines::space_time_test
