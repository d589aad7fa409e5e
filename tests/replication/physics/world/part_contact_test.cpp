#include "replication/physics/world/part_contact.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <sstream>

#include "tests/must.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::part_contact_test {

using namespace test;
using collision::Contact;
using collision::ContactState;

struct Rng {
  std::mt19937_64 engine;
  double operator()(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine); }
  Vec3 vec(double size) {
    const double x = (*this)(-size, size), y = (*this)(-size, size);
    return {x, y, (*this)(-size, size)};
  }
};

// ---- parts, and where they are by nothing but school mathematics ----

// A box on carriers: each level moves at constant acceleration and spin from 0 on.
class CarriedBox {
 public:
  CarriedBox(const Vec3& size, std::vector<KinematicState> levels) : half_(0.5 * size), levels_(std::move(levels)) {
    std::ostringstream text;
    text.precision(9);
    text << "#VRML V2.0 utf8\nDEF A Transform { children Shape { geometry Box { size " << size.transpose()
         << " } } }\n";
    scene_ = std::make_unique<Scene>(read_world(text.str()).scene.value());
    body_ = collision::make_body(*scene_, scene_->find("A").value());
    for (const KinematicState& level : levels_) timelines_.emplace_back(sim(0s), level);
  }
  // `part()` points into this.
  [[nodiscard]] MovingPart part() const {
    chain_.clear();
    for (const Timeline& t : timelines_) chain_.push_back(&t);
    return {.chain = chain_, .body = &body_};
  }
  [[nodiscard]] const collision::Body& body() const { return body_; }
  [[nodiscard]] Eigen::Isometry3d place(double t) const {
    Eigen::Isometry3d place = Eigen::Isometry3d::Identity();
    for (const KinematicState& level : levels_) {
      place.translate(level.position + t * level.velocity + 0.5 * t * t * level.acceleration);
      place.rotate(level.orientation);
      const double spin = level.angular_velocity_body.norm();
      if (spin > 0.0) place.rotate(Eigen::AngleAxisd(spin * t, level.angular_velocity_body / spin));
    }
    return place;
  }
  [[nodiscard]] std::array<Vec3, 8> corners(double t) const {
    std::array<Vec3, 8> corners;
    const Eigen::Isometry3d at = place(t);
    for (int i = 0; i < 8; ++i) {
      const Vec3 sign(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
      corners[static_cast<std::size_t>(i)] = at * half_.cwiseProduct(sign);
    }
    return corners;
  }
  [[nodiscard]] Mat3 axes(double t) const { return place(t).linear(); }

 private:
  Vec3 half_;
  std::vector<KinematicState> levels_;
  std::unique_ptr<Scene> scene_;
  collision::Body body_;
  std::vector<Timeline> timelines_;
  mutable std::vector<const Timeline*> chain_;
};

// How far the two are apart along the axis [m]; negative: by how much they overlap.
double gap_along(const Vec3& n, std::span<const Vec3> a, std::span<const Vec3> b) {
  double low_a = 1e300, high_a = -1e300, low_b = 1e300, high_b = -1e300;
  for (const Vec3& p : a) low_a = std::min(low_a, n.dot(p)), high_a = std::max(high_a, n.dot(p));
  for (const Vec3& p : b) low_b = std::min(low_b, n.dot(p)), high_b = std::max(high_b, n.dot(p));
  return std::max(low_a - high_b, low_b - high_a);
}

// The greatest gap along the separating axes of two boxes: negative exactly where they overlap.
double gap_of(const CarriedBox& a, const CarriedBox& b, double t) {
  const auto of_a = a.corners(t), of_b = b.corners(t);
  const Mat3 axes_a = a.axes(t), axes_b = b.axes(t);
  double greatest = -1e300;
  for (int i = 0; i < 3; ++i) {
    greatest = std::max(greatest, gap_along(axes_a.col(i), of_a, of_b));
    greatest = std::max(greatest, gap_along(axes_b.col(i), of_a, of_b));
    for (int k = 0; k < 3; ++k) {
      const Vec3 across = axes_a.col(i).cross(axes_b.col(k));
      if (across.norm() > 1e-6) greatest = std::max(greatest, gap_along(across.normalized(), of_a, of_b));
    }
  }
  return greatest;
}

using Boxes = std::vector<CarriedBox>;

// The same for the boxes in the frame's own directions around all of one end.
double world_gap_of(const Boxes& a, const Boxes& b, double t) {
  std::vector<Vec3> of_a, of_b;
  for (const CarriedBox& one : a) std::ranges::copy(one.corners(t), std::back_inserter(of_a));
  for (const CarriedBox& one : b) std::ranges::copy(one.corners(t), std::back_inserter(of_b));
  double greatest = -1e300;
  for (int i = 0; i < 3; ++i) greatest = std::max(greatest, gap_along(Vec3::Unit(i), of_a, of_b));
  return greatest;
}

struct Sides {
  std::vector<MovingPart> a, b;
  CollisionType type = CollisionType::kWitness;
  Sides(const Boxes& of_a, const Boxes& of_b, CollisionType asked) : type(asked) {
    for (const CarriedBox& one : of_a) a.push_back(one.part());
    for (const CarriedBox& one : of_b) b.push_back(one.part());
  }
  [[nodiscard]] PartQuery query() const { return {.a = a, .b = b, .type = type}; }
};

// The first contact in [0, until), searched as a world does: from one change of the coarse pieces to the next.
std::optional<PartContact> first_until(const Sides& sides, SimTime until) {
  std::uint64_t searches = 0;
  for (SimTime s = sim(0s); s < until;) {
    SimTime begin = sim(0s), end = until;
    for (const auto& side : {sides.a, sides.b}) {
      for (const MovingPart& part : side) {
        if (part.chain.empty()) continue;
        const ComposedPiece piece =
            composed_piece(part.chain, s, part.body->center.norm() + part.body->radius_m, kCoarseError_m);
        begin = std::max(begin, piece.begin);
        if (piece.end) end = std::min(end, *piece.end);
      }
    }
    const PartContact found = first_part_contact(sides.query(), begin, s, end, searches);
    EXPECT_NE(found.contact.state, ContactState::kFailed);
    // What begins apart overlaps only where a search is late.
    const bool contact =
        found.contact.state == ContactState::kContact || found.contact.state == ContactState::kOverlapped;
    if (contact && found.at < end) return found;
    s = end;
  }
  return std::nullopt;
}

KinematicState level(const Vec3& p, const Vec3& v = Vec3::Zero(), const Vec3& spin_rad_s = Vec3::Zero()) {
  KinematicState s = moving(p, v);
  s.angular_velocity_body = spin_rad_s;
  return s;
}

KinematicState any_level(Rng& rng, double away_m) {
  KinematicState s = moving(rng.vec(away_m), rng.vec(1.5), rng.vec(1.0));
  s.orientation = Quat(Eigen::AngleAxisd(rng(0, 3), rng.vec(1.0).normalized()));
  if (rng(0, 1) < 0.8) s.angular_velocity_body = rng.vec(2.0);
  return s;
}

CarriedBox any_box(Rng& rng, const Vec3& around) {
  std::vector<KinematicState> levels{any_level(rng, 0.5)};
  levels[0].position += around;
  levels[0].velocity -= 0.5 * around;
  for (int depth = static_cast<int>(rng(0, 3)); depth > 0; --depth) levels.push_back(any_level(rng, 1.0));
  const auto side = [&] { return std::round(rng(19, 96)) / 64; };  // binary32 has it exactly
  const double x = side(), y = side();
  return {Vec3(x, y, side()), std::move(levels)};
}

// No sample before the contact lies in an overlap, and at the contact the two are as near as is said.
struct Gaps {
  double least_before_m = 1e300, at_m = 0.0;
};
template <class Gap>
Gaps gaps_until(double until_s, Gap gap) {
  constexpr double kStep_s = 1e-5, kFastest_m_s = 200.0;
  Gaps gaps;
  for (double t = 0.0; t < until_s;) {
    const double now = gap(t);
    gaps.least_before_m = std::min(gaps.least_before_m, now);
    t += std::max(kStep_s, now / kFastest_m_s);
  }
  gaps.at_m = gap(until_s);
  return gaps;
}

// The contact of the two ends until 1.5 s, if they meet, is neither late nor early by more than 1e-6 m, twice the
// errors of both fine pieces, and what the two go within the nanosecond by which time is rounded. Returns whether they
// meet.
template <class Gap>
bool meet_in_time(const Boxes& a, const Boxes& b, CollisionType type, Gap gap) {
  constexpr double kUntil_s = 1.5;
  const auto found = first_until({a, b, type}, sim(seconds(kUntil_s)));
  const Gaps gaps = gaps_until(found ? to_seconds(found->at.time_since_epoch()) : kUntil_s, gap);
  EXPECT_GT(gaps.least_before_m, -1e-9) << "late";
  if (found) {
    EXPECT_LE(gaps.at_m, 1e-6 + 4 * kFineError_m + 1e-7) << "early";
  }
  return found.has_value();
}

// ---- exact motion ----

// Neither side is composed of motions that turn, so that a search by pieces has nothing to add.
TEST(FirstPartContact, ExactMotionIsWhatCollisionAnswers) {
  Rng rng{std::mt19937_64(1)};
  int met = 0;
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    Boxes a, b;
    KinematicState flies = any_level(rng, 0.5), stands = level(Vec3(3, 0, 0) + rng.vec(0.5));
    flies.velocity.x() += 2.0;
    a.push_back({Vec3(1, 0.5, 0.5), {flies}});
    b.push_back({Vec3(0.5, 1, 0.5), {stands}});
    const Sides sides(a, b, CollisionType::kWitness);
    std::uint64_t searches = 0;
    const PartContact found = first_part_contact(sides.query(), sim(0s), sim(0s), sim(3s), searches);
    const Contact expected =
        collision::first_contact({a[0].body(), flies}, {b[0].body(), stands}, CollisionType::kWitness, 3.0);
    EXPECT_EQ(searches, 1u);
    ASSERT_EQ(found.contact.state, expected.state);
    EXPECT_TRUE(same_bits(found.a, flies));
    if (expected.state != ContactState::kContact) continue;
    ++met;
    EXPECT_EQ(found.contact.time_s, expected.time_s);
    EXPECT_EQ(found.contact.normal_world, expected.normal_world);
    EXPECT_EQ(found.at, sim(Duration{static_cast<std::int64_t>(std::floor(expected.time_s * 1e9))}));
  }
  EXPECT_GT(met, 30);
}

// A carrier that does not turn adds its motion, and no error.
TEST(FirstPartContact, CarriersThatDoNotTurnAreExact) {
  Boxes wheel, curb;
  wheel.push_back({Vec3(1, 1, 1), {level({0, 0, 0}, {3, 0, 0}), level({1, 0, 0}, {1, 0, 0}, {0, 0, 0})}});
  curb.push_back({Vec3(1, 1, 1), {level({6, 0.25, 0})}});
  const Sides sides(wheel, curb, CollisionType::kWitness);
  std::uint64_t searches = 0;
  const PartContact found = first_part_contact(sides.query(), sim(0s), sim(0s), sim(5s), searches);
  EXPECT_EQ(searches, 1u);
  ASSERT_EQ(found.contact.state, ContactState::kContact);
  EXPECT_EQ(found.contact.iterations, 0u) << "the closed form";
  EXPECT_EQ(found.at, sim(1s));
  EXPECT_EQ(found.contact.normal_world, -Vec3::UnitX());
}

// What nothing carries and nothing moves has no chain: it stands in the frame.
TEST(FirstPartContact, WhatHasNoChainStandsInTheFrame) {
  Boxes door, post;
  door.push_back({Vec3(1, 1, 1), {level({-4, 0, 0}, {2, 0, 0})}});
  post.push_back({Vec3(1, 1, 1), {}});
  const Sides sides(door, post, CollisionType::kWitness);
  std::uint64_t searches = 0;
  const PartContact found = first_part_contact(sides.query(), sim(0s), sim(0s), sim(5s), searches);
  ASSERT_EQ(found.contact.state, ContactState::kContact);
  EXPECT_EQ(found.at, sim(1500ms));
}

// The contact time does not depend on when it is asked for. What has been dealt with is not found again.
TEST(FirstPartContact, BeginsWhereTheMotionsDo) {
  Boxes a, b;
  KinematicState flies = moving({0, 0, 0}, {3, 0, 0}, {-1, 0, 0});
  flies.angular_velocity_body = {0.1, 0.3, 0.2};
  a.push_back({Vec3(1, 1, 1), {flies}});
  b.push_back({Vec3(1, 1, 1), {level({4, 0, 0})}});
  const Sides sides(a, b, CollisionType::kWitness);
  std::uint64_t searches = 0;
  const PartContact first = first_part_contact(sides.query(), sim(0s), sim(0s), sim(5s), searches);
  ASSERT_EQ(first.contact.state, ContactState::kContact);
  for (const Duration from : {10ms, 333ms, 700ms}) {
    ASSERT_LT(sim(from), first.at);
    EXPECT_EQ(first_part_contact(sides.query(), sim(0s), sim(from), sim(5s), searches).at, first.at);
  }
  EXPECT_EQ(searches, 4u);
  const SimTime later = first.at + 1ms;
  const PartContact again = first_part_contact(sides.query(), sim(0s), later, sim(5s), searches);
  EXPECT_EQ(searches, 6u) << "from the beginning, and then from where it has to";
  EXPECT_TRUE(again.contact.state == ContactState::kSeparated || again.at >= later);
}

// ---- composed motion ----

TEST(FirstPartContact, ComposedMotionIsNeverLateAndEarlyByWhatItSays) {
  Rng rng{std::mt19937_64(2)};
  int met = 0, passed = 0;
  for (int i = 0; i < 1500; ++i) {
    SCOPED_TRACE(i);
    Boxes a, b;
    a.push_back(any_box(rng, {-2, 0, 0}));
    b.push_back(any_box(rng, {2, 0, 0}));
    const auto gap = [&](double t) { return gap_of(a[0], b[0], t); };
    if (gap(0.0) < 0.01) continue;
    ++(meet_in_time(a, b, CollisionType::kWitness, gap) ? met : passed);
  }
  EXPECT_GT(met, 30);
  EXPECT_GT(passed, 15);
}

// A hand on a turning arm is ahead of its coarse piece by nearly all of the piece's error, at two instants of it. The
// wall stands where these are, and the hand comes straight at it.
TEST(FirstPartContact, AHandThatIsAheadOfItsPieceIsNotLate) {
  double deepest_m = 0.0;
  for (int i = 0; i < 400; ++i) {
    SCOPED_TRACE(i);
    const double x = -0.5 - 0.005 * i;  // of the wall's front
    Boxes hand, wall;
    hand.push_back({Vec3(0.5, 0.5, 0.5), {level({0, 0, 0}, {0, 0, 0}, {0, 1.5, 0}), level({3, 0, 0})}});
    wall.push_back({Vec3(1, 16, 16), {level({x - 0.5, 0, 0})}});
    const auto found = must(first_until({hand, wall, CollisionType::kWitness}, sim(3s)));
    const double gap_m = gap_of(hand[0], wall[0], to_seconds(found.at.time_since_epoch()));
    deepest_m = std::min(deepest_m, gap_m);
    EXPECT_LE(gap_m, 1e-6 + 4 * kFineError_m + 1e-7) << "early";
  }
  EXPECT_GT(deepest_m, -1e-9) << "late";
}

// A box that no carrier moves goes on a circle, of which the pieces of its timeline are off by some micrometres. Those
// that nobody answers meet where the circle is.
TEST(FirstPartContact, ALawThatItsPiecesRoundIsNotLate) {
  constexpr double kRadius_m = 2.0, kRate_rad_s = 2.0, kSpeed_m_s = kRadius_m * kRate_rad_s;
  MotionModel circle(level({kRadius_m, 0, 0}, {0, kSpeed_m_s, 0}));
  circle.state.acceleration = {-kSpeed_m_s * kRate_rad_s, 0, 0};
  circle.rate_rad_s = {0, 0, kRate_rad_s};
  circle.kind = MotionKind::kTurning;
  const Timeline timeline(sim(0s), circle);
  const Timeline* const chain[] = {&timeline};
  const CarriedBox cube({0.5, 0.5, 0.5}, {level({0, 0, 0})});
  double deepest_m = 0.0;
  for (int i = 0; i < 400; ++i) {
    SCOPED_TRACE(i);
    const double y = 0.3 + 0.004 * i;  // of the ceiling
    const CarriedBox ceiling({16, 1, 16}, {level({0, y + 0.5, 0})});
    const MovingPart a{.chain = chain, .body = &cube.body()}, b = ceiling.part();
    const PartQuery query{.a = {&a, 1}, .b = {&b, 1}, .as = collision::MeetAs::kPolygons};
    std::uint64_t searches = 0;
    std::optional<SimTime> met;
    for (SimTime s = sim(0s); !met && s < sim(1s);) {  // from piece to piece of the timeline, as a world searches
      const SimTime end = std::min(timeline.next_change_after(s).value_or(sim(1s)), sim(1s));
      const PartContact found = first_part_contact(query, s, s, end, searches);
      if (found.contact.state == ContactState::kContact && found.at < end) met = found.at;
      ASSERT_NE(found.contact.state, ContactState::kOverlapped) << "late";
      s = end;
    }
    ASSERT_TRUE(met);
    EXPECT_TRUE(parts_touch(query, *met));
    const double gap_m = y - 0.25 - kRadius_m * std::sin(kRate_rad_s * to_seconds(met->time_since_epoch()));
    deepest_m = std::min(deepest_m, gap_m);
    EXPECT_LE(gap_m, 1e-6 + 4 * kFineError_m + 1e-7) << "early";
  }
  EXPECT_GT(deepest_m, -1e-9) << "late";
}

TEST(FirstPartContact, BoxesOfSeveralPartsAreThoseOfTheWholeEnds) {
  Rng rng{std::mt19937_64(3)};
  int met = 0, passed = 0;
  for (int i = 0; i < 600; ++i) {
    SCOPED_TRACE(i);
    Boxes a, b;
    for (int k = static_cast<int>(rng(1, 4)); k > 0; --k) a.push_back(any_box(rng, {-4, 0, 0}));
    for (int k = static_cast<int>(rng(1, 3)); k > 0; --k) b.push_back(any_box(rng, {4, 0, 0}));
    const auto gap = [&](double t) { return world_gap_of(a, b, t); };
    if (gap(0.0) < 0.01) continue;
    ++(meet_in_time(a, b, CollisionType::kBox, gap) ? met : passed);
  }
  EXPECT_GT(met, 20);
  EXPECT_GT(passed, 10);
}

// ---- touching ----

TEST(PartsTouch, WhereContactTimesLeaveThemAndNotBefore) {
  Rng rng{std::mt19937_64(4)};
  int touched = 0, apart = 0;
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE(i);
    Boxes a, b;
    a.push_back(any_box(rng, {-0.7, 0, 0}));
    b.push_back(any_box(rng, {0.7, 0, 0}));
    for (const CollisionType type : {CollisionType::kWitness, CollisionType::kBox}) {
      const Sides sides(a, b, type);
      const double t = rng(0, 1);
      const bool touch = parts_touch(sides.query(), sim(seconds(t)));
      const double gap = type == CollisionType::kBox ? world_gap_of(a, b, t) : gap_of(a[0], b[0], t);
      if (gap < -1e-9) {
        EXPECT_TRUE(touch);
        ++touched;
      }
      if (gap > 2e-6 + 2 * kFineError_m) {
        EXPECT_FALSE(touch);
        ++apart;
      }
    }
  }
  EXPECT_GT(touched, 100);
  EXPECT_GT(apart, 100);
}

TEST(PartsTouch, AtTheirContactTime) {
  Rng rng{std::mt19937_64(5)};
  int met = 0;
  for (int i = 0; i < 600; ++i) {
    SCOPED_TRACE(i);
    Boxes a, b;
    a.push_back(any_box(rng, {-2, 0, 0}));
    b.push_back(any_box(rng, {2, 0, 0}));
    if (gap_of(a[0], b[0], 0.0) < 0.01) continue;
    const Sides sides(a, b, CollisionType::kWitness);
    const auto found = first_until(sides, sim(1500ms));
    if (!found) continue;
    ++met;
    EXPECT_TRUE(parts_touch(sides.query(), found->at));
    const SimTime before = found->at - 5ms;
    if (gap_of(a[0], b[0], to_seconds(before.time_since_epoch())) < 1e-5) continue;
    EXPECT_FALSE(parts_touch(sides.query(), before));
  }
  EXPECT_GT(met, 10);
}

TEST(PartsTouchUntil, BoxesCertainlyOverlapUntilThen) {
  Rng rng{std::mt19937_64(6)};
  int longer = 0;
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE(i);
    Boxes a, b;
    // Nothing turns, so that the motion is exact.
    a.push_back({Vec3(2, 2, 2), {level(rng.vec(0.5), rng.vec(1.0)), level(rng.vec(0.5), rng.vec(1.0))}});
    a.push_back({Vec3(1, 1, 1), {level(rng.vec(1.0), rng.vec(1.0))}});
    b.push_back({Vec3(2, 2, 2), {level(rng.vec(0.5), rng.vec(1.0))}});
    if (world_gap_of(a, b, 0.0) > -1e-3) continue;
    const Sides sides(a, b, CollisionType::kBox);
    const SimTime until = parts_touch_until(sides.query(), sim(0s), sim(1s));
    EXPECT_GT(until, sim(0s));
    EXPECT_LE(until, sim(1s));
    if (until <= sim(0s) + kTouchCheck) continue;
    ++longer;
    const double until_s = to_seconds(until.time_since_epoch());
    for (int k = 0; k <= 100; ++k) ASSERT_LT(world_gap_of(a, b, until_s * k / 100), 1e-9);
  }
  EXPECT_GT(longer, 50);
}

// By how deep they are in each other, on carriers that turn too.
TEST(PartsTouchUntil, PolygonsCertainlyTouchUntilThen) {
  Rng rng{std::mt19937_64(7)};
  int longer = 0;
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE(i);
    Boxes a, b;
    a.push_back(any_box(rng, {-0.3, 0, 0}));
    b.push_back(any_box(rng, {0.3, 0, 0}));
    const Sides sides(a, b, CollisionType::kWitness);
    if (gap_of(a[0], b[0], 0.0) > -1e-3 || !parts_touch(sides.query(), sim(0s))) continue;
    const SimTime until = parts_touch_until(sides.query(), sim(0s), sim(1s));
    EXPECT_GE(until, sim(0s) + kTouchCheck);
    EXPECT_LE(until, sim(1s));
    if (until == sim(0s) + kTouchCheck) continue;
    ++longer;
    const double until_s = to_seconds(until.time_since_epoch());
    for (int k = 0; k <= 100; ++k) ASSERT_LT(gap_of(a[0], b[0], until_s * k / 100), 1e-9);
  }
  EXPECT_GT(longer, 50);
}

TEST(PartsTouchUntil, WhatStandsTouchesForEver) {
  Boxes a, b;
  a.push_back({Vec3(2, 2, 2), {level({0, 0, 0})}});
  b.push_back({Vec3(2, 2, 2), {level({1, 0.25, 0.375})}});
  const Sides sides(a, b, CollisionType::kWitness);
  EXPECT_EQ(parts_touch_until(sides.query(), sim(1s), sim(9s)), sim(9s));
  EXPECT_EQ(parts_touch_until(sides.query(), sim(1s), sim(1s) + Duration{7}), sim(1s) + Duration{7});
}

}  // namespace peerd::replication::part_contact_test
