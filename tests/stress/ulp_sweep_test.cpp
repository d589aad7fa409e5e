// Bodies pass through contact in steps of one unit in the last place: they come to touch once, and no answer flickers.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "collision/contact/contact_time.hpp"
#include "collision/exact/triangle_pair.hpp"
#include "core/scene/reader.hpp"
#include "tests/collision/shapes.hpp"
#include "tests/oracle/triangle_cases.hpp"
#include "tests/oracle/triangle_oracle.hpp"

namespace peerd::collision::ulp_sweep_test {

using namespace test;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kSteps = 200;  // on either side

double ulps(double x, int n) {
  for (; n > 0; --n) x = std::nextafter(x, kInfinity);
  for (; n < 0; ++n) x = std::nextafter(x, -kInfinity);
  return x;
}
// The least number for which `yes` is true, where it is monotone, false at `low` and true at `high`.
double border(double low, double high, const std::function<bool(double)>& yes) {
  EXPECT_FALSE(yes(low));
  EXPECT_TRUE(yes(high));
  for (;;) {
    const double middle = low + 0.5 * (high - low);
    if (middle == low || middle == high) return high;
    (yes(middle) ? high : low) = middle;
  }
}
// The answer stays true once it is true, number by number.
void expect_once(double at, const std::function<bool(double)>& yes) {
  bool before = false;
  for (int i = -kSteps; i <= kSteps; ++i) {
    const bool now = yes(ulps(at, i));
    ASSERT_EQ(now, i >= 0) << i << " from " << at;
    ASSERT_GE(now, before);
    before = now;
  }
}

// A corner comes down on a triangle of any size and place. The oracle is asked at each step.
TEST(UlpSweep, TrianglesTouchFromOneNumberOn) {
  oracle::Rng rng(3);
  for (const double size : {1e-6, 1.0, 1e6}) {
    for (const double offset : {0.0, 1.0, 1e3, 1e9}) {
      for (int i = 0; i < 8; ++i) {
        SCOPED_TRACE(testing::Message() << size << " m at " << offset << " m, " << i);
        const auto near = [&](double x) { return offset + size * x + size * rng.real(-0.2, 0.2); };
        const oracle::Triangle floor{
            {{near(-2), near(-2), near(0)}, {near(2), near(-2), near(0)}, {near(0), near(2), near(0)}}};
        const double x = near(0), y = near(0), up = std::max(8.0 * size, 1e-3 * offset);
        const auto falling = [&](double height) {
          return oracle::Triangle{{{x, y, height}, {near(-1), near(1), offset + up}, {near(1), near(1), offset + up}}};
        };
        const oracle::Triangle top = falling(0.0);
        const auto touches = [&](double minus_height) {
          oracle::Triangle t = top;
          t[0][2] = -minus_height;
          OrientationCounters counters;
          const auto ours = [](const oracle::Triangle& of) {
            Triangle out;
            for (std::size_t c = 0; c < 3; ++c) out[c] = Vec3(of[c][0], of[c][1], of[c][2]);
            return out;
          };
          const bool answer = touch(ours(floor), ours(t), counters);
          EXPECT_EQ(answer, oracle::touch(floor, t));
          return answer;
        };
        const double at = border(-(offset + up), -(offset - up), touches);
        expect_once(at, touches);
      }
    }
  }
}

struct Pair {
  const char* name;
  std::string a, b;   // geometries
  double gap_from_m;  // centres this far apart along x touch
  friend void PrintTo(const Pair& p, std::ostream* out) { *out << p.name; }
};
class Meeting : public testing::TestWithParam<Pair> {
 protected:
  Meeting() {
    const std::string text = "#VRML V2.0 utf8\nDEF A Transform { children Shape { geometry " + GetParam().a +
                             " } }\nDEF B Transform { children Shape { geometry " + GetParam().b + " } }\n";
    scene = read_world(text).scene.value();
    bodies = {make_body(scene, scene.find("A").value()), make_body(scene, scene.find("B").value())};
  }
  [[nodiscard]] Contact meet(const KinematicState& a, double horizon_s = 10.0) const {
    const KinematicState b = moving({0.5, 0.25, 0.125});
    return first_contact({bodies[0], a}, {bodies[1], b}, CollisionType::kWitness, horizon_s);
  }
  // A, where the two are that much more than touching apart, coming towards B with that velocity.
  [[nodiscard]] KinematicState at(double gap, const Vec3& velocity) const {
    return moving({0.5 + GetParam().gap_from_m + gap, 0.25, 0.125}, velocity);
  }
  Scene scene;
  std::vector<Body> bodies;
};
INSTANTIATE_TEST_SUITE_P(Bodies, Meeting,
                         testing::Values(Pair{"Boxes", "Box { size 1 1 1 }", "Box { size 2 2 2 }", 1.5},
                                         Pair{"Spheres", "Sphere { radius 0.5 }", "Sphere { radius 0.25 }", 0.75},
                                         Pair{"SphereAndBox", "Sphere { radius 0.5 }", "Box { size 2 2 2 }", 1.5}),
                         [](const auto& p) { return std::string(p.param.name); });

// When the spheres above touch that would at 0.3 s if they came straight: (x - |vx| t)^2 + (vy^2 + vz^2) t^2 = r^2.
double spheres_meet_s(const Vec3& v) {
  const double r = 0.75, speed = -v.x(), x = r + 0.3 * speed, sum = v.squaredNorm();
  const double half = x * speed;
  return (half - std::sqrt(half * half - sum * (x * x - r * r))) / sum;
}

// A search that ends one ulp before the contact finds none, and any longer one finds it at the same time.
TEST_P(Meeting, TheHorizonFindsItOnce) {
  for (const Vec3& velocity : {Vec3(-1, 0, 0), Vec3(-3, 0.01, 0.02), Vec3(-1e-3, 0, 0), Vec3(-700, 0, 0)}) {
    const KinematicState a = at(0.3 * -velocity.x(), velocity);
    const Contact found = meet(a);
    ASSERT_EQ(found.state, ContactState::kContact);
    const double first =
        border(0.25, 0.35, [&](double horizon) { return meet(a, horizon).state == ContactState::kContact; });
    // Surfaces meet as early as their tolerance lets them.
    const double early_s = kAdvancementTolerance_m / -velocity.x() + 1e-12;
    const double truth = GetParam().name == std::string("Spheres") ? spheres_meet_s(velocity) : 0.3;
    EXPECT_LE(first, truth + 1e-12);
    EXPECT_GE(first, truth - early_s);
    if (GetParam().name ==
        std::string("Spheres")) {  // halving a horizon, each rounds for itself: within 1e-12 s it may flicker
      for (int i = 1; i <= kSteps; ++i) {
        ASSERT_EQ(meet(a, first - 1e-12 * i).state, ContactState::kSeparated) << i;
        ASSERT_EQ(meet(a, first + 1e-12 * i).state, ContactState::kContact) << i;
      }
      continue;
    }
    for (int i = -kSteps; i <= kSteps; ++i) {
      const Contact c = meet(a, ulps(first, i));
      ASSERT_EQ(c.state, i < 0 ? ContactState::kSeparated : ContactState::kContact) << i;
      if (i < 0) continue;
      // Boxes have a closed form; spheres halve the horizon, 52 times; surfaces advance in steps.
      if (GetParam().name == std::string("Boxes")) {
        ASSERT_EQ(c.time_s, found.time_s) << i;
      } else {
        ASSERT_NEAR(c.time_s, found.time_s, early_s) << i;
      }
    }
  }
}

// Bodies that are moved together touch as they stand once: apart before, and nearer than contact times leave them
// after.
TEST_P(Meeting, StandingTheyTouchOnce) {
  const KinematicState b = moving({0.5, 0.25, 0.125});
  const auto near = [&](double minus_gap) {
    const KinematicState a = at(-minus_gap, Vec3::Zero());
    return touching({bodies[0], a}, {bodies[1], b}, CollisionType::kWitness);
  };
  expect_once(border(-1e-3, 1e-9, near), near);
}

// From a gap into an overlap, ulp by ulp of the place: a contact ahead, one at 0, an overlap, in this order; and a
// start that is nearer never meets later, but for the rounding of a time.
TEST_P(Meeting, TheStartGoesFromApartToOverlapped) {
  const auto rank = [](const Contact& c) {
    EXPECT_NE(c.state, ContactState::kUnsupported);
    EXPECT_NE(c.state, ContactState::kFailed);
    EXPECT_NE(c.state, ContactState::kSeparated);
    if (c.state == ContactState::kOverlapped) return 2;
    return c.time_s > 0.0 ? 0 : 1;
  };
  const Vec3 velocity(-2, 0, 0);
  const double middle = 0.5 + GetParam().gap_from_m;
  int before = 0;
  double time = kInfinity;
  for (int i = kSteps * 20; i >= -kSteps * 20; --i) {
    KinematicState a = at(0, velocity);
    a.position.x() = middle + i * 0x1p-52;
    const Contact c = meet(a);
    const int now = rank(c);
    ASSERT_GE(now, before) << i;
    before = now;
    if (c.state == ContactState::kContact) {
      ASSERT_LE(c.time_s, time + 1e-15) << i;
      time = c.time_s;
    }
  }
  EXPECT_GE(before, 1);
}

// Passing by, ever nearer: missed, then hit, once.
TEST_P(Meeting, GrazingTurnsIntoAHitOnce) {
  const auto hits = [&](double minus_aside) {
    KinematicState a = moving({-4.5, 0.25 - minus_aside, 0.125}, {2, 0, 0});
    return meet(a).state == ContactState::kContact;
  };
  const double aside = GetParam().gap_from_m;
  expect_once(border(-aside - 1e-3, -aside + 1e-3, hits), hits);
}

}  // namespace peerd::collision::ulp_sweep_test
