// The same scene elsewhere and in other sizes: 0 to 10^9 m from the origin, a millionth to a million times as large.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "collision/contact/contact_time.hpp"
#include "collision/exact/triangle_pair.hpp"
#include "replication/wire/record.hpp"
#include "tests/collision/shapes.hpp"
#include "tests/oracle/triangle_cases.hpp"
#include "tests/oracle/triangle_oracle.hpp"
#include "tests/replication/peer/lan.hpp"

namespace peerd::extents_test {

// Whole numbers of 2^20 m, up to just above 10^9: sums with what is on a grid of 2^-20 are exact.
constexpr double kOffsets_m[] = {0.0, 0x1p0, 0x1p10, 0x1p20, 0x1p30};
constexpr int kScales_log2[] = {-20, -10, 0, 10, 20};

collision::Triangle ours(const oracle::Triangle& t) {
  collision::Triangle out;
  for (std::size_t i = 0; i < 3; ++i) out[i] = Vec3(t[i][0], t[i][1], t[i][2]);
  return out;
}
bool touches(const oracle::Triangle& a, const oracle::Triangle& b) {
  collision::OrientationCounters counters;
  return collision::touch(ours(a), ours(b), counters);
}
oracle::Triangle changed(oracle::Triangle t, const auto& change) {
  for (auto& corner : t) {
    for (double& x : corner) x = change(x);
  }
  return t;
}

// The numbers are multiples of a grid that all places share, so they are the same ones, moved: so is the answer.
TEST(Extents, TrianglesMeetAlikeWhereverTheyAreAndHoweverLarge) {
  std::size_t touching = 0, asked = 0;
  for (const oracle::Generator& generator : oracle::general()) {
    oracle::Rng rng(31);
    for (int i = 0; i < 60; ++i) {
      const oracle::Pair raw = generator.make(rng);
      double largest = 0.0;
      for (const auto* t : {&raw.a, &raw.b}) {
        for (const auto& corner : *t) {
          for (const double x : corner) largest = std::max(largest, std::abs(x));
        }
      }
      if (!(largest > 1e-3 && largest < 1e6)) continue;
      const double grid = std::exp2(std::ceil(std::log2(largest)) - 20);
      const auto snap = [&](double x) { return std::round(x / grid) * grid; };
      const oracle::Triangle a = changed(raw.a, snap), b = changed(raw.b, snap);
      const bool expected = oracle::touch(a, b);
      touching += expected;
      for (const int scale : kScales_log2) {
        for (const double offset : kOffsets_m) {
          const auto there = [&](double x) { return std::ldexp(x / grid * 0x1p-20 + offset, scale); };
          ASSERT_EQ(touches(changed(a, there), changed(b, there)), expected)
              << generator.name << ' ' << i << " at " << offset << " m, times 2^" << scale;
          ++asked;
        }
      }
    }
  }
  EXPECT_GT(touching, 50u);
  EXPECT_GT(asked, 5000u);
}

// The answer for places that are rounded is that of the rounded triangles.
TEST(Extents, RoundedTrianglesMeetAsTheOracleSays) {
  std::size_t touching = 0;
  for (const double offset : {1.0, 1e3, 1e6, 1e9}) {
    for (const double scale : {1e-6, 1e-3, 1.0, 1e3, 1e6}) {
      for (const oracle::Generator& generator : oracle::general()) {
        oracle::Rng rng(32);
        for (int i = 0; i < 10; ++i) {
          const oracle::Pair raw = generator.make(rng);
          const auto there = [&](double x) { return x * scale + offset; };
          const oracle::Triangle a = changed(raw.a, there), b = changed(raw.b, there);
          const bool expected = oracle::touch(a, b);
          ASSERT_EQ(touches(a, b), expected) << generator.name << ' ' << i << " at " << offset << " m, times " << scale;
          touching += expected;
        }
      }
    }
  }
  EXPECT_GT(touching, 100u);
}

// A box flies at another. Where the distance is d from the origin, places are d 2^-53 off, and so is the gap; the time
// is off by no more than that, some roundings of it, at the speed of the approach.
TEST(Extents, ContactTimesErrByTheRoundingOfPlaces) {
  double worst = 0.0;  // of the bound
  for (const double scale : {1e-6, 1e-3, 1.0, 1e3, 1e6}) {
    const auto size = static_cast<float>(scale);
    const collision::Body cube = collision::test::box(size, size, size);
    for (const double offset : {0.0, 1e3, 1e6, 1e9}) {
      // An object no larger than the rounding of its place has no contact time worth the name.
      const double rounding_m = 0x1p-50 * (offset + 16.0 * scale);
      if (scale < 64.0 * rounding_m) continue;
      const double side = static_cast<double>(size), speed = 3.0 * scale;
      const Vec3 there(offset, -offset, 0.5 * offset);
      const KinematicState still = collision::test::moving(there);
      const KinematicState comes =
          collision::test::moving(there - Vec3(4.0 * side, 0.1 * side, 0.1 * side), {speed, 0.0, 0.0});
      const auto c = collision::first_contact({cube, comes}, {cube, still}, CollisionType::kWitness, 10.0);
      ASSERT_EQ(c.state, collision::ContactState::kContact) << offset << ' ' << scale;
      const double error_s = std::abs(c.time_s - 3.0 * side / speed), bound_s = rounding_m / speed;
      EXPECT_LE(error_s, bound_s) << offset << ' ' << scale;
      worst = std::max(worst, error_s / bound_s);
    }
  }
  std::printf("contact times: at most %.2f of the bound 2^-50 (distance + 16 sizes) / speed\n", worst);
}

}  // namespace peerd::extents_test

namespace peerd::replication::extents_test {

using namespace test;

// A record's steps do not grow with the place: half a step an axis, as at the origin, up to 10^9 m.
TEST(Extents, RecordsRoundByHalfAStepEverywhere) {
  std::mt19937_64 rng(5);
  std::uniform_real_distribution<double> u(-1.0, 1.0);
  for (const double offset : {0.0, 1.0, 1e3, 1e6, 1e9}) {
    for (const double tolerance : {1e-5, 1e-3, 0.05, 10.0}) {
      double worst_m = 0.0;
      int stepped = 0;
      for (int i = 0; i < 2000; ++i) {
        UpdateRecord r;
        r.sequence = 1;
        r.model = moving({offset + u(rng), -offset + u(rng), u(rng)}, {u(rng), u(rng), u(rng)});
        const UpdateRecord rounded = quantised(r, {tolerance, 1.0});
        const Vec3 off = (rounded.model.state.position - r.model.state.position).cwiseAbs();
        worst_m = std::max(worst_m, off.maxCoeff());
        if (!rounded.position_step_log2) {  // more steps away than there are: published exactly
          ASSERT_EQ(off, Vec3(Vec3::Zero()));
          continue;
        }
        ++stepped;
        ASSERT_LE(off.maxCoeff(), std::exp2(*rounded.position_step_log2 - 1)) << offset << ' ' << tolerance;
      }
      EXPECT_EQ(stepped, offset == 1e9 && tolerance == 1e-5 ? 0 : 2000) << offset << ' ' << tolerance;
      EXPECT_LE(worst_m, tolerance / 32.0);
    }
  }
}

struct Flight {
  double mean_m = 0.0, worst_m = 0.0;
  std::uint64_t updates = 0;
};
// An observer's prediction of an object that goes to and fro for 20 s, with everything moved by `offset` and `scale`
// times as large.
Flight fly(double offset, double scale) {
  const World world(box("CAR", "1 1 1", "0 0 0"));
  Lan lan(world, {50ms, 0ms, 0, 0});
  const auto motion = [=](SimTime t) {
    const double s = to_seconds(t - SimTime{kEpoch});
    KinematicState k = moving(Vec3::Constant(offset));
    k.position += scale * Vec3(5.0 * std::sin(s), 0.3 * s, 2.0 * std::cos(0.7 * s));
    k.velocity = scale * Vec3(5.0 * std::cos(s), 0.3, -1.4 * std::sin(0.7 * s));
    k.acceleration = scale * Vec3(-5.0 * std::sin(s), 0.0, -0.98 * std::cos(0.7 * s));
    return k;
  };
  PeerConfig owner = config(1, {{world["CAR"], true}});
  owner.policy.error_threshold_m = 0.05 * scale;
  lan.add(owner, 0s, {{world["CAR"], motion}});
  lan.add(config(2));
  lan.run_until(3s);
  Flight flight;
  int samples = 0;
  for (Duration t = 3s; t < 23s; t += 50ms, ++samples) {
    lan.run_until(t);
    const SimTime now = lan.session_now(1);
    const double error_m = (lan.peer(1).ghost(world["CAR"], now).position - motion(now).position).norm() / scale;
    flight.mean_m += error_m;
    flight.worst_m = std::max(flight.worst_m, error_m);
  }
  flight.mean_m /= samples;
  flight.updates = lan.peer(0).counters().updates_out;
  return flight;
}

// Moved, the ghost's error is that of the origin but for the rounding of binary64's places, 1.2e-7 m at 10^9 m.
TEST(Extents, GhostsErrAsMuchFarFromTheOrigin) {
  const Flight here = fly(0.0, 1.0);
  EXPECT_GT(here.mean_m, 1e-3);
  for (const double offset : {1.0, 1e3, 1e6, 1e9}) {
    const Flight there = fly(offset, 1.0);
    std::printf("%8.0e m from the origin: mean %.9f m, worst %.9f m, %llu updates\n", offset, there.mean_m,
                there.worst_m, static_cast<unsigned long long>(there.updates));
    EXPECT_EQ(there.updates, here.updates);
    EXPECT_NEAR(there.mean_m, here.mean_m, 1e-5 + 1e-15 * offset);
    EXPECT_NEAR(there.worst_m, here.worst_m, 1e-4 + 1e-15 * offset);
  }
}

// Scaled with its threshold, it is that of size 1 in the scene's own measure.
TEST(Extents, GhostsErrInProportionToTheScene) {
  const Flight here = fly(0.0, 1.0);
  for (const double scale : {1e-6, 1e-3, 1e3, 1e6}) {
    const Flight there = fly(0.0, scale);
    std::printf("%8.0e times as large: mean %.9f, worst %.9f of it, %llu updates\n", scale, there.mean_m, there.worst_m,
                static_cast<unsigned long long>(there.updates));
    EXPECT_NEAR(there.mean_m, here.mean_m, 0.05 * here.mean_m);
    EXPECT_NEAR(static_cast<double>(there.updates), static_cast<double>(here.updates), 2.0);
  }
}

}  // namespace peerd::replication::extents_test
