#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "collision/contact/contact_time.hpp"
#include "tests/collision/shapes.hpp"

// Property tests against an oracle that knows nothing of faces, edges or axes: the Minkowski difference as a cloud of
// points, its hull by brute force over triples, and time by dense sampling and bisection.
namespace peerd::collision::oracle_test {

using namespace test;

struct Plane {
  Vec3 n;
  double offset;
};

std::vector<Plane> hull_planes(const std::vector<Vec3>& cloud) {
  std::vector<Plane> planes;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    for (std::size_t j = i + 1; j < cloud.size(); ++j) {
      for (std::size_t k = j + 1; k < cloud.size(); ++k) {
        Vec3 n = (cloud[j] - cloud[i]).cross(cloud[k] - cloud[i]);
        if (n.norm() < 1e-9) continue;
        n.normalize();
        double low = 1e9, high = -1e9;
        for (const Vec3& p : cloud) {
          low = std::min(low, n.dot(p - cloud[i]));
          high = std::max(high, n.dot(p - cloud[i]));
          if (low < -1e-9 && high > 1e-9) break;
        }
        if (high <= 1e-9) planes.push_back({n, n.dot(cloud[i])});
        if (low >= -1e-9) planes.push_back({-n, -n.dot(cloud[i])});
      }
    }
  }
  return planes;
}

// All b - a, without the positions: where the collider's origin, seen from the collidee's, makes them touch.
std::vector<Vec3> difference(const Body& a, const Quat& qa, const Body& b, const Quat& qb) {
  std::vector<Vec3> cloud;
  for (const Vec3& vb : b.vertices()) {
    for (const Vec3& va : a.vertices()) cloud.push_back(qb * vb - qa * va);
  }
  return cloud;
}

double gap_at(const std::vector<Plane>& planes, const Vec3& p) {
  double gap = -1e9;
  for (const Plane& plane : planes) gap = std::max(gap, plane.n.dot(p) - plane.offset);
  return gap;
}

// First sign change of gap(t) from above, to 1e-13 s.
template <class Gap>
std::optional<double> first_zero(const Gap& gap, double horizon, int samples) {
  double before = 0.0;
  for (int i = 1; i <= samples; ++i) {
    const double t = horizon * i / samples;
    if (gap(t) > 0.0) {
      before = t;
      continue;
    }
    double low = before, high = t;
    while (high - low > 1e-13) {
      const double middle = 0.5 * (low + high);
      if (middle == low || middle == high) break;
      (gap(middle) > 0.0 ? low : high) = middle;
    }
    return high;
  }
  return std::nullopt;
}

struct Encounter {
  Body a, b;
  KinematicState at_a, at_b;
};
Encounter random_encounter(std::mt19937_64& rng, std::size_t points, bool accelerated) {
  Encounter e{body_of(random_polyhedron(rng, points)), body_of(random_polyhedron(rng, points)), {}, {}};
  e.at_a.orientation = random_rotation(rng);
  e.at_b.orientation = random_rotation(rng);
  e.at_b.position = random_vector(rng, 3.0);
  e.at_a.position = e.at_b.position + random_vector(rng, 1.0).normalized() * 4.0;
  e.at_a.velocity = random_vector(rng, 1.0);
  e.at_b.velocity = e.at_a.velocity + 0.7 * (e.at_a.position - e.at_b.position) + random_vector(rng, 1.0);
  if (accelerated) e.at_a.acceleration = random_vector(rng, 3.0);
  return e;
}

TEST(Oracle, TranslationAgreesWithBruteForce) {
  std::size_t contacts = 0;
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    const Encounter e = random_encounter(rng, 4 + seed % 3, seed % 2 == 0);
    ASSERT_EQ(e.a.unsupported + e.b.unsupported, "");
    const auto planes = hull_planes(difference(e.a, e.at_a.orientation, e.b, e.at_b.orientation));
    const auto gap = [&](double t) {
      return gap_at(planes, advance(e.at_a, t).position - advance(e.at_b, t).position);
    };
    const Contact c = first_contact({e.a, e.at_a}, {e.b, e.at_b}, CollisionType::kWitness, 4.0);
    const auto truth = first_zero(gap, 4.0, 4000);
    if (c.state == ContactState::kContact) {
      ++contacts;
      EXPECT_NEAR(gap(c.time_s), 0.0, 1e-12);
      if (truth) {
        EXPECT_LE(c.time_s, *truth + 1e-9);
      }
      EXPECT_NEAR(c.normal_world.norm(), 1.0, 1e-14);
      const Vec3 v = advance(e.at_a, c.time_s).velocity - advance(e.at_b, c.time_s).velocity;
      EXPECT_LT(c.normal_world.dot(v), 0.0);
      if (truth) {
        EXPECT_NEAR(c.time_s, *truth, 1e-9);
      }
    } else {
      ASSERT_EQ(c.state, ContactState::kSeparated);
      EXPECT_FALSE(truth.has_value());
    }
  }
  EXPECT_GT(contacts, 150U);
}

TEST(Oracle, SwappingTheBodiesKeepsTheTime) {
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    const Encounter e = random_encounter(rng, 4 + seed % 12, seed % 2 == 0);
    for (const CollisionType type : {CollisionType::kBox, CollisionType::kWitness}) {
      const Contact ab = first_contact({e.a, e.at_a}, {e.b, e.at_b}, type, 4.0);
      const Contact ba = first_contact({e.b, e.at_b}, {e.a, e.at_a}, type, 4.0);
      ASSERT_EQ(ab.state, ba.state);
      EXPECT_NEAR(ab.time_s, ba.time_s, 1e-11);
    }
  }
}

TEST(Oracle, RigidMotionOfTheWorldChangesNothing) {
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    const Encounter e = random_encounter(rng, 4 + seed % 12, seed % 2 == 0);
    const Quat q = random_rotation(rng);
    const Vec3 shift = random_vector(rng, 100.0);
    const auto moved = [&](KinematicState s) {
      s.position = q * s.position + shift;
      s.velocity = q * s.velocity;
      s.acceleration = q * s.acceleration;
      s.orientation = q * s.orientation;
      return s;
    };
    const Contact here = first_contact({e.a, e.at_a}, {e.b, e.at_b}, CollisionType::kWitness, 4.0);
    const Contact there = first_contact({e.a, moved(e.at_a)}, {e.b, moved(e.at_b)}, CollisionType::kWitness, 4.0);
    ASSERT_EQ(here.state, there.state);
    EXPECT_NEAR(here.time_s, there.time_s, 1e-10);
    if (here.state != ContactState::kContact) continue;
    EXPECT_EQ(here.collidee_polygon, there.collidee_polygon);
    EXPECT_NEAR((q * here.normal_world - there.normal_world).norm(), 0.0, 1e-12);
  }
}

TEST(Oracle, BoxesAgreeWithThreeIntervals) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    const Encounter e = random_encounter(rng, 8, true);
    const auto gap = [&](double t) {
      Vec3 gaps;
      const KinematicState a = advance(e.at_a, t), b = advance(e.at_b, t);
      for (int k = 0; k < 3; ++k) {
        double al = 1e9, ah = -1e9, bl = 1e9, bh = -1e9;
        for (const Vec3& v : e.a.vertices()) {
          al = std::min(al, (a.pose() * v)[k]);
          ah = std::max(ah, (a.pose() * v)[k]);
        }
        for (const Vec3& v : e.b.vertices()) {
          bl = std::min(bl, (b.pose() * v)[k]);
          bh = std::max(bh, (b.pose() * v)[k]);
        }
        gaps[k] = std::max(al - bh, bl - ah);
      }
      return gaps.maxCoeff();
    };
    const Contact c = first_contact({e.a, e.at_a}, {e.b, e.at_b}, CollisionType::kBox, 4.0);
    if (c.state == ContactState::kOverlapped) {
      EXPECT_LT(gap(0.0), 0.0);
      continue;
    }
    const auto truth = first_zero(gap, 4.0, 1000);
    ASSERT_EQ(c.state == ContactState::kContact, truth.has_value());
    if (truth) {
      EXPECT_NEAR(c.time_s, *truth, 1e-9);
    }
  }
}

TEST(Oracle, RotationIsNeverLateAndAtMostTheToleranceEarly) {
  std::size_t contacts = 0, most = 0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 rng(seed);
    Encounter e = random_encounter(rng, 4, seed % 2 == 0);
    e.at_a.angular_velocity_body = random_vector(rng, 5.0);
    if (seed % 3 != 0) e.at_b.angular_velocity_body = random_vector(rng, 5.0);
    const auto gap = [&](double t) {
      const KinematicState a = advance(e.at_a, t), b = advance(e.at_b, t);
      return gap_at(hull_planes(difference(e.a, a.orientation, e.b, b.orientation)), a.position - b.position);
    };
    const Contact c = first_contact({e.a, e.at_a}, {e.b, e.at_b}, CollisionType::kWitness, 4.0);
    ASSERT_NE(c.state, ContactState::kFailed);
    most = std::max<std::size_t>(most, c.iterations);
    const auto truth = first_zero(gap, c.state == ContactState::kContact ? c.time_s + 1e-3 : 4.0, 800);
    if (c.state == ContactState::kContact) {
      ++contacts;
      EXPECT_GT(gap(c.time_s), -1e-9);
      EXPECT_LE(gap(c.time_s), kAdvancementTolerance_m + 1e-9);
      if (truth) {
        EXPECT_LE(c.time_s, *truth + 1e-9);
      }
    } else {
      EXPECT_FALSE(truth.has_value());
    }
  }
  EXPECT_GT(contacts, 60U);
  EXPECT_LT(most, kAdvancementCap / 2);
}

}  // namespace peerd::collision::oracle_test
