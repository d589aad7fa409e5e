#include "replication/physics/laws/swept_bound.hpp"

#include <gtest/gtest.h>

#include <random>

#include "collision/contact/contact_time.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::swept_bound_test {

using namespace test;

constexpr Duration kAhead = 250ms;

class Draw {
 public:
  explicit Draw(std::uint64_t seed) : rng_(seed) {}
  double real(double most) { return most * (2.0 * std::ldexp(static_cast<double>(rng_() >> 11), -53) - 1.0); }
  Vec3 vec(double most) { return {real(most), real(most), real(most)}; }
  Duration within(Duration d) {
    return Duration{static_cast<std::int64_t>(rng_() % static_cast<std::uint64_t>(d.count()))};
  }
  bool one_in(std::uint64_t n) { return rng_() % n == 0; }

  // A model of any kind, with speeds of a few metres a second.
  MotionModel model() {
    MotionModel m;
    m.kind = kMotionKinds[rng_() % std::size(kMotionKinds)];
    m.state.position = vec(6.0);
    m.state.velocity = one_in(4) ? Vec3(Vec3::Zero()) : vec(8.0);
    if (m.kind != MotionKind::kFirst) m.state.acceleration = one_in(3) ? Vec3(Vec3::Zero()) : vec(20.0);
    if (m.kind == MotionKind::kThird || m.kind == MotionKind::kOscillating)
      m.jerk = vec(one_in(2) ? 200.0 : 1e6);  // the latter's pieces leave its own derivatives by metres
    if (m.kind == MotionKind::kTurning) m.rate_rad_s = vec(5.0);
    if (m.kind == MotionKind::kOscillating) m.rate_rad_s = vec(9.0).cwiseAbs();
    m.state.orientation = quat_exp(vec(3.0));
    if (one_in(2)) m.state.angular_velocity_body = vec(5.0);
    if (one_in(3)) m.angular_acceleration_body = vec(10.0);
    return m;
  }
  // The object is updated a few times within the second from 0 on.
  Timeline timeline() {
    Timeline line(sim(0s), model());
    for (Duration t = within(400ms); t < 1s; t += 1ms + within(400ms)) line.replace_from(sim(t), model(), std::nullopt);
    return line;
  }

 private:
  std::mt19937_64 rng_;
};

World bodies() {
  return World(
      box("BRICK", "1 0.5 2", "0 0 0") +
      "DEF OFF Transform { children Transform { translation 2 0 0 children Shape { geometry Box { } } } }\n"
      "DEF BALL Transform { children Shape { geometry Sphere { radius 0.7 } } }\n"
      "DEF EGG Transform { children Transform { translation 0 1 0 children Shape { geometry Sphere { } } } }\n" +
      interest("BRICK", "\"OFF\" \"BALL\" \"EGG\""));
}

TEST(SweptBound, HoldsTheWholeWay) {
  const World w = bodies();
  Draw draw(1);
  for (int round = 0; round < 3000; ++round) {
    const Timeline line = draw.timeline();
    const collision::Body& body = w.model->bodies[static_cast<std::size_t>(round) % w.model->bodies.size()];
    const SimTime s = sim(draw.within(1200ms) - 50ms);
    const SimTime begin = s - draw.within(kAhead), end = begin + kAhead;
    const SweptBound bound = swept_bound(line, body, s, begin, std::max(end, s + 1ns));
    ASSERT_TRUE(bound.answers_for(s));
    EXPECT_EQ(bound.last_change, line.last_change_until(s));
    EXPECT_EQ(bound.next_change, line.next_change_after(s));
    const SimTime first = std::max(begin, bound.last_change.value_or(begin));
    const SimTime last = std::min(std::max(end, s + 1ns), bound.next_change.value_or(SimTime::max()));
    const auto turning = [&](SimTime t) { return !line.at(t).angular_velocity_body.isZero(0.0); };
    const bool turns = turning(first) || turning(first + 1ns);
    for (int i = 0; i < 20; ++i) {
      const SimTime t = first + draw.within(last - first);
      const KinematicState state = line.at(t);
      const Vec3 center = turns ? state.position : state.pose() * body.center;
      ASSERT_TRUE((center.array() >= bound.low.array()).all() && (center.array() <= bound.high.array()).all())
          << "round " << round;
      for (const Vec3& v : body.vertices()) {
        ASSERT_LE((state.pose() * v - center).norm(), bound.radius_m * (1.0 + 1e-6)) << "round " << round;
        // The closed form of the law, which the piece comes near, is held, too.
        ASSERT_LE((line.exact_at(t).pose() * v - center).norm(), bound.radius_m * (1.0 + 1e-6)) << "round " << round;
      }
    }
  }
}

// A search that MotionWorld skips would have found no contact, wherever within the piece it had begun.
TEST(SweptBound, WhatIsApartNeverMeets) {
  const World w = bodies();
  Draw draw(2);
  int spared = 0, met = 0;
  for (int round = 0; round < 20'000; ++round) {
    const Timeline line_a = draw.timeline(), line_b = draw.timeline();
    const collision::Body &a = w.model->bodies[static_cast<std::size_t>(round) % 4],
                          &b = w.model->bodies[static_cast<std::size_t>(round / 4) % 4];
    const CollisionType type = draw.one_in(3) ? CollisionType::kBox : CollisionType::kWitness;
    const SimTime s = sim(draw.within(1100ms));
    const SimTime cell{Duration{s.time_since_epoch() / kAhead * kAhead}};
    const SweptBound bound_a = swept_bound(line_a, a, s, cell, cell + kAhead),
                     bound_b = swept_bound(line_b, b, s, cell, cell + kAhead);
    const SimTime end = std::min(
        {cell + kAhead, bound_a.next_change.value_or(SimTime::max()), bound_b.next_change.value_or(SimTime::max())});
    const SimTime begin = std::max({cell, bound_a.last_change.value_or(cell), bound_b.last_change.value_or(cell)});
    const KinematicState state_a = line_a.at(begin), state_b = line_b.at(begin);
    const collision::Contact contact =
        collision::first_contact({a, state_a}, {b, state_b}, type, to_seconds(end - begin));
    const bool is_apart = apart(bound_a, bound_b, type);
    EXPECT_EQ(is_apart, apart(bound_b, bound_a, type));
    spared += is_apart;
    met += contact.state != collision::ContactState::kSeparated;
    ASSERT_TRUE(!is_apart || contact.state == collision::ContactState::kSeparated) << "round " << round;
  }
  EXPECT_GT(spared, 5000);
  EXPECT_GT(met, 200);
}

// The margin grows with the body, not only with its way.
TEST(SweptBound, ALargeBodyAtRestHasAMarginOfItsSize) {
  const World w("DEF MOON Transform { children Shape { geometry Sphere { radius 1e6 } } }\n" +
                box("ROCK", "1 1 1", "0 0 0") + interest("ROCK", "\"MOON\""));
  const collision::Body& moon = w.model->bodies[w.model->index_of(w["MOON"])];
  ASSERT_TRUE(moon.sphere);
  const Timeline line(sim(0s), moving({0, 0, 0}));
  const SweptBound bound = swept_bound(line, moon, sim(1s), sim(1s), sim(2s));
  EXPECT_LT(bound.low.maxCoeff(), -0.9e6 * 0x1p-30);
  EXPECT_GT(bound.high.minCoeff(), 0.9e6 * 0x1p-30);
}

TEST(SweptBound, OfTwoTogetherHoldsBothAndAnswersWhileBothDo) {
  SweptBound a, b;
  a.low = {-1, -9, 0}, a.high = {1, 0, 1};
  b.low = {-2, -3, 0}, b.high = {0, 4, 2};
  a.from = sim(1s), a.until = sim(3s);
  b.from = sim(2s), b.until = sim(4s);
  a.still = true;
  a.last_change = sim(1s), b.last_change = sim(500ms);
  b.next_change = sim(9s);
  for (const SweptBound& both : {merged(a, b), merged(b, a)}) {
    EXPECT_EQ(both.low, Vec3(-2, -9, 0));
    EXPECT_EQ(both.high, Vec3(1, 4, 2));
    EXPECT_EQ(both.from, sim(2s));
    EXPECT_EQ(both.until, sim(3s));
    EXPECT_FALSE(both.still);
    EXPECT_EQ(both.last_change, sim(1s));
    EXPECT_EQ(both.next_change, sim(9s));
  }
}

TEST(SweptBound, NaNIsNotApart) {
  const World w = bodies();
  const Timeline here(sim(0s), moving({0, 0, 0})), there(sim(0s), moving({100, 0, 0}));
  const SweptBound a = swept_bound(here, w.model->bodies[0], sim(1s), sim(1s), sim(2s));
  SweptBound b = swept_bound(there, w.model->bodies[1], sim(1s), sim(1s), sim(2s));
  EXPECT_TRUE(apart(a, b, CollisionType::kWitness));
  b.low.setConstant(std::nan(""));
  b.high.setConstant(std::nan(""));
  EXPECT_FALSE(apart(a, b, CollisionType::kWitness));
}

TEST(SweptBound, IsOfOneInstantWhereALawBegins) {
  const World w = bodies();
  Timeline line(sim(0s), moving({0, 0, 0}));
  MotionModel swings;  // stands for an instant
  swings.kind = MotionKind::kThird;
  swings.jerk = {1, 0, 0};
  line.replace_from(sim(1s), swings, std::nullopt);
  const auto bound = [&](Duration t) { return swept_bound(line, w.model->bodies[0], sim(t), sim(1s), sim(1250ms)); };
  EXPECT_TRUE(bound(1s).still);
  EXPECT_FALSE(bound(1s).answers_for(sim(1s + 1ns)));
  EXPECT_FALSE(bound(1s + 1ns).still);
  EXPECT_TRUE(bound(1s + 2ns).answers_for(sim(1s + 1ns)));
  EXPECT_FALSE(bound(1s + 1ns).answers_for(sim(1s)));
}

}  // namespace peerd::replication::swept_bound_test
