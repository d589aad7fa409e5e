#include "replication/physics/laws/composed_motion.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::composed_motion_test {

using namespace test;

struct Rng {
  std::mt19937_64 engine;
  double operator()(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine); }
  Vec3 vec(double size) { return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)}; }
  Quat quat() { return quat_exp(vec(3.0)); }
};

// A law of any kind, with everything that its kind may have.
MotionModel any_law(Rng& rng, int kind) {
  MotionModel m;
  m.kind = kMotionKinds[static_cast<std::size_t>(kind)];
  m.state.position = rng.vec(4.0);
  m.state.velocity = rng.vec(3.0);
  m.state.orientation = rng.quat();
  m.state.angular_velocity_body = rng.vec(3.0);
  if (m.kind != MotionKind::kFirst) m.state.acceleration = rng.vec(5.0);
  if (m.kind == MotionKind::kThird || m.kind == MotionKind::kOscillating) m.jerk = rng.vec(10.0);
  if (m.kind == MotionKind::kTurning) m.rate_rad_s = rng.vec(3.0);
  if (m.kind == MotionKind::kOscillating) m.rate_rad_s = rng.vec(3.0).cwiseAbs();
  if (m.kind == MotionKind::kSliding) m = sliding_to_rest(m.state, 2.0);
  return m;
}

struct Carried {
  std::vector<Timeline> timelines;
  std::vector<const Timeline*> chain;

  void add(Timeline timeline) { timelines.push_back(std::move(timeline)); }
  Chain operator()() {
    chain.clear();
    for (const Timeline& t : timelines) chain.push_back(&t);
    return chain;
  }
};

Carried any_chain(Rng& rng, int depth) {
  Carried carried;
  for (int i = 0; i < depth; ++i) {
    Timeline timeline(sim(0s), any_law(rng, static_cast<int>(rng(0, 7))));
    for (const double at : {0.7, 1.9})
      timeline.replace_from(sim(seconds(at)), any_law(rng, static_cast<int>(rng(0, 7))), {});
    carried.add(std::move(timeline));
  }
  return carried;
}

TEST(Composed, IsTheProductOfThePosesAndItsDerivatives) {
  Rng rng{std::mt19937_64(1)};
  for (int i = 0; i < 200; ++i) {
    Carried chain;
    for (int depth = 0; depth < 3; ++depth) chain.add(Timeline(sim(0s), any_law(rng, 1)));
    const SimTime t = sim(seconds(rng(0.1, 2.0)));
    const KinematicState at = composed_at(chain(), t);
    Pose product;
    for (const Timeline& level : chain.timelines) {
      const Pose p = level.exact_at(t).pose();
      product = {product * p.position, product.orientation * p.orientation};
    }
    ASSERT_LT((at.position - product.position).norm(), 1e-12);
    ASSERT_LT(angle_between(at.orientation, product.orientation), 1e-7);
    constexpr double kStep_s = 1e-4;
    const auto position_at = [&](double s) { return composed_at(chain(), t + seconds(s)).position; };
    const Vec3 before = position_at(-kStep_s), after = position_at(kStep_s);
    ASSERT_LT((at.velocity - (after - before) / (2 * kStep_s)).norm(), 1e-4);
    ASSERT_LT((at.acceleration - (after - 2 * at.position + before) / (kStep_s * kStep_s)).norm(), 1e-3);
    const Quat turned = composed_at(chain(), t + seconds(kStep_s)).orientation;
    const Quat predicted = at.orientation * quat_exp(kStep_s * at.angular_velocity_body);
    ASSERT_LT(angle_between(turned, predicted), 1e-6);
  }
}

TEST(Composed, HasAnInverse) {
  Rng rng{std::mt19937_64(2)};
  for (int i = 0; i < 200; ++i) {
    const KinematicState carrier = any_law(rng, 1).state, state = any_law(rng, 1).state;
    const KinematicState back = composed(carrier, relative_to(carrier, state));
    ASSERT_LT((back.position - state.position).norm(), 1e-12);
    ASSERT_LT((back.velocity - state.velocity).norm(), 1e-11);
    ASSERT_LT((back.acceleration - state.acceleration).norm(), 1e-9);
    ASSERT_LT((back.angular_velocity_body - state.angular_velocity_body).norm(), 1e-12);
    ASSERT_LT(angle_between(back.orientation, state.orientation), 1e-7);
  }
}

struct Precision {
  const char* name;
  double error_max_m;
};
class ComposedPieces : public testing::TestWithParam<Precision> {};

// Pieces follow each other without a gap, and no point within reach is farther off than they say.
TEST_P(ComposedPieces, AreAsNearAsTheySay) {
  constexpr double kReach_m = 1.5;
  Rng rng{std::mt19937_64(3)};
  double worst = 0.0;
  for (int i = 0; i < 150; ++i) {
    Carried carried = any_chain(rng, 1 + i % 5);
    const Chain chain = carried();
    SimTime t = sim(seconds(rng(0.0, 2.5)));
    for (int n = 0; n < 20; ++n) {
      const ComposedPiece piece = composed_piece(chain, t, kReach_m, GetParam().error_max_m);
      ASSERT_LE(piece.begin, t);
      if (!piece.end) break;
      ASSERT_GT(*piece.end, t);
      const ComposedPiece again = composed_piece(chain, *piece.end - Duration{1}, kReach_m, GetParam().error_max_m);
      ASSERT_EQ(again.begin, piece.begin) << "a function of the laws, whenever it is asked";
      ASSERT_TRUE(same_bits(again.state, piece.state));
      for (const double part : {0.0, 0.13, 0.3, 0.5, 0.7, 0.9, 0.999}) {
        const Duration since{static_cast<std::int64_t>(part * static_cast<double>((*piece.end - piece.begin).count()))};
        const Pose said = advance(piece.state, to_seconds(since)).pose();
        const Pose is = composed_at(chain, piece.begin + since).pose();
        for (const Vec3& p : {Vec3(Vec3::Zero()), Vec3(kReach_m, 0, 0), Vec3(0, -kReach_m, 0), Vec3(0, 0, kReach_m)}) {
          const double off = (said * p - is * p).norm();
          ASSERT_LE(off, piece.error_m + 1e-11) << "chain " << i << ", piece of " << (*piece.end - piece.begin).count();
          if (piece.error_m > 0.0) worst = std::max(worst, off / piece.error_m);
        }
      }
      t = *piece.end;
    }
  }
  EXPECT_GT(worst, 0.02) << "a bound that is never nearly reached costs pieces for nothing";
}
INSTANTIATE_TEST_SUITE_P(Table, ComposedPieces, testing::Values(Precision{"Coarse", 1e-3}, Precision{"Fine", 5e-7}),
                         [](const auto& test) { return std::string(test.param.name); });

TEST(ComposedPiece, IsExactWhereNoCarrierTurns) {
  Carried chain;
  chain.add(Timeline(sim(0s), moving({1, 0, 0}, {2, 0, 0}, {0, -9.81, 0})));
  KinematicState spins = moving({0, 1, 0}, {0, 0, 3});
  spins.angular_velocity_body = {0, 5, 0};
  chain.add(Timeline(sim(0s), spins));
  const ComposedPiece piece = composed_piece(chain(), sim(7s), 1.0, 1e-3);
  EXPECT_EQ(piece.begin, sim(0s));
  EXPECT_FALSE(piece.end);
  EXPECT_EQ(piece.error_m, 0.0);
  EXPECT_EQ(piece.state.position, Vec3(1, 1, 0));
  EXPECT_EQ(piece.state.velocity, Vec3(2, 0, 3));
  EXPECT_EQ(piece.state.acceleration, Vec3(0, -9.81, 0));
}

TEST(ComposedPiece, MayBeOneNanosecondLong) {
  Rng rng{std::mt19937_64(3)};
  const SimTime boundary = sim(Duration{std::int64_t{1} << 27});  // where a piece ends, however long
  Carried chain;
  for (int depth = 0; depth < 2; ++depth) chain.add(Timeline(boundary - Duration{1}, any_law(rng, 1)));
  const ComposedPiece piece = composed_piece(chain(), boundary - Duration{1}, 1.0, 1e-3);
  ASSERT_EQ(piece.end, boundary);
  EXPECT_EQ(piece.begin, boundary - Duration{1});
  const Vec3 end = advance(piece.state, 1e-9).position;
  EXPECT_LT((end - composed_at(chain(), boundary).position).norm(), 1e-12);
}

TEST(ComposedPiece, StandsWhereNothingMoves) {
  Carried chain;
  Timeline bus(sim(0s), moving({1, 0, 0}));
  bus.replace_from(sim(5s), moving({1, 0, 0}, {1, 0, 0}), {});
  chain.add(bus);
  chain.add(Timeline(sim(0s), moving({0, 1, 0})));
  const ComposedPiece piece = composed_piece(chain(), sim(2s), 1.0, 1e-3);
  EXPECT_TRUE(piece.still);
  EXPECT_EQ(piece.end, sim(5s));
  EXPECT_EQ(piece.state.position, Vec3(1, 1, 0));
  EXPECT_FALSE(composed_piece(chain(), sim(5s), 1.0, 1e-3).still);
}

}  // namespace peerd::replication::composed_motion_test
