#include "replication/wire/record.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/replication/peer/traffic.hpp"

namespace peerd::replication::record_test {

using namespace test;

constexpr double kAngle_rad = 0.05;

Message batch(const std::vector<UpdateRecord>& updates) {
  Message m;
  m.sender = PeerId{1};
  m.incarnation = 1;
  m.updates = updates;
  return m;
}
bool same_bits(const UpdateRecord& a, const UpdateRecord& b) { return test::same_bits(batch({a}), batch({b})); }

Bytes bytes_of(const UpdateRecord& u, SimTime base) {
  std::array<std::byte, kRecordMax_bytes> bytes{};
  const std::size_t size = encode_record(u, base, bytes);
  return {bytes.begin(), bytes.begin() + static_cast<long>(size)};
}

// The record of all the bytes, if they are one.
std::optional<UpdateRecord> decoded(std::span<const std::byte> bytes, SimTime base) {
  const auto u = decode_record(bytes, base);
  return u && bytes.empty() ? std::optional(*u) : std::nullopt;
}

// Records of one kind as they come from a world of metres and seconds.
class RecordMaker {
 public:
  explicit RecordMaker(std::uint64_t seed) : rng_(seed) {}

  double draw(double from, double to) {
    return from + (to - from) * std::ldexp(static_cast<double>(rng_() >> 11), -53);
  }
  UpdateRecord record(MotionKind kind) {
    MotionModel m;
    m.kind = kind;
    m.state.position = vector(1000);
    m.state.velocity = vector(30);
    if (kind != MotionKind::kFirst) m.state.acceleration = vector(10);
    if (kind == MotionKind::kSliding) m.state.acceleration = -draw(0.1, 2) * m.state.velocity;
    if (kind == MotionKind::kThird || kind == MotionKind::kOscillating) m.jerk = vector(10);
    if (kind == MotionKind::kTurning) m.rate_rad_s = vector(5);
    if (kind == MotionKind::kOscillating) m.rate_rad_s = vector(5).cwiseAbs();
    if (rng_() % 4 != 0) {
      m.state.orientation = Quat(draw(-1, 1), draw(-1, 1), draw(-1, 1), draw(-1, 1) + 1e-9).normalized();
    }
    const double spins[] = {0.0, 1e-4, 1.0, 100.0, 0.577e4};
    m.state.angular_velocity_body = vector(spins[rng_() % 5]);
    if (rng_() % 2 == 0) m.angular_acceleration_body = vector(10);
    if (kind == MotionKind::kSliding) m.angular_acceleration_body = -0.5 * m.state.angular_velocity_body / 10.0;
    if (rng_() % 3 == 0) set_level(m);
    if (rng_() % 3 == 0) set_upright(m);
    UpdateRecord u{ObjectId{static_cast<std::uint32_t>(rng_() % 3000)}, static_cast<std::uint32_t>(1 + rng_() % 3000),
                   sim(seconds(draw(0, 1e5))), m};
    if (rng_() % 3 == 0) u.carrier = ObjectId{static_cast<std::uint32_t>(rng_() % 3000)};
    if (rng_() % 4 == 0) u.drive = Drive{vector(10), u.at - seconds(draw(0, 6))};
    return u;
  }
  static void set_level(MotionModel& m) {
    for (Vec3* v : {&m.state.velocity, &m.state.acceleration, &m.jerk}) v->y() = 0.0;
    m.rate_rad_s = m.rate_rad_s.cwiseProduct(m.kind == MotionKind::kTurning ? Vec3(0, 1, 0) : Vec3(1, 0, 1)).eval();
  }
  static void set_upright(MotionModel& m) {
    for (Vec3* v : {&m.state.angular_velocity_body, &m.angular_acceleration_body}) *v = {0, v->y(), 0};
    Quat& q = m.state.orientation;
    q = std::abs(q.w()) < 0.1 ? Quat(0, 0, 1, 0) : Quat(q.w(), 0, q.y(), 0).normalized();
  }
  // A vector with some axes zero.
  Vec3 vector(double most) {
    Vec3 v(draw(-most, most), draw(-most, most), draw(-most, most));
    const auto zero = rng_() % 16;
    for (int i = 0; i < 3; ++i) {
      if ((zero >> i & 1) != 0 && zero < 8) v[i] = 0.0;
    }
    return v;
  }

 private:
  std::mt19937_64 rng_;
};

class Kind : public testing::TestWithParam<MotionKind> {};

TEST_P(Kind, RoundsOnceAndTravelsBitForBit) {
  RecordMaker make(1);
  for (int i = 0; i < 5000; ++i) {
    SCOPED_TRACE(i);
    const UpdateRecord u = make.record(GetParam());
    const Tolerance tolerance{std::ldexp(make.draw(1, 2), -static_cast<int>(make.draw(0, 22))), kAngle_rad};
    const UpdateRecord q = quantised(u, tolerance);
    ASSERT_TRUE(same_bits(quantised(q, tolerance), q));
    const SimTime base = i % 2 == 0 ? q.at : sim(seconds(make.draw(0, 1e5)));
    const Bytes bytes = bytes_of(q, base);
    const auto back = decoded(bytes, base);
    ASSERT_TRUE(back.has_value());
    ASSERT_TRUE(same_bits(*back, q));
    ASSERT_EQ(bytes_of(*back, base), bytes);
    EncodedUpdate encoded(q, q.at);
    encoded.count_from(base);
    ASSERT_TRUE(std::ranges::equal(encoded.bytes(), bytes));
  }
}

// Quarter turns, where two components tie, and their neighbours.
TEST(Upright, TurnsTravel) {
  const double half = std::sqrt(0.5);
  for (const double w : {-1.0, -half, 0.0, half, 1.0}) {
    for (const double y : {-1.0, -half, 0.0, half, 1.0}) {
      for (const double off : {0.0, 1e-16, -1e-16, 1e-4, -1e-4}) {
        if (w * w + y * y < 0.9 || w * w + y * y > 1.1) continue;
        UpdateRecord u{ObjectId{1}, 1, sim(1s), moving({1, 2, 3}, {4, 5, 6}), {}};
        u.model.state.orientation = Quat(w, 0, y + off, 0).normalized();
        const UpdateRecord q = quantised(u, {0.05, kAngle_rad});
        EXPECT_LE(angle_between(q.model.state.orientation, u.model.state.orientation), kOrientationError_rad);
        const auto back = decoded(bytes_of(q, q.at), q.at);
        ASSERT_TRUE(back.has_value());
        EXPECT_TRUE(same_bits(*back, q)) << w << ' ' << y << ' ' << off;
      }
    }
  }
}

// The error is at most one step of the position for each of position, velocity, acceleration, jerk and rate, on each
// axis; all but the first are taken after the horizon.
TEST_P(Kind, StaysCloseOverItsHorizon) {
  RecordMaker make(2);
  const double horizon_s = std::ldexp(1.0, horizon_log2_s(GetParam()));
  const double half_degrees = 0.05 * std::numbers::pi / 180.0;
  int rounded = 0;
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE(i);
    const UpdateRecord u = make.record(GetParam());
    const Tolerance tolerance{std::ldexp(make.draw(1, 2), -static_cast<int>(make.draw(0, 12))), kAngle_rad};
    const UpdateRecord q = quantised(u, tolerance);
    if (!q.position_step_log2) continue;
    ++rounded;
    const double step = std::ldexp(1.0, *q.position_step_log2);
    ASSERT_LE(step, tolerance.distance_m / 16);
    const auto &s = u.model.state, &r = q.model.state;
    const auto off = [](const Vec3& a, const Vec3& b) { return (a - b).cwiseAbs().maxCoeff(); };
    ASSERT_LE(off(s.position, r.position), 0.5 * step);
    ASSERT_LE(off(s.velocity, r.velocity) * horizon_s, step);
    ASSERT_LE(off(s.acceleration, r.acceleration) * horizon_s * horizon_s / 2, step);
    ASSERT_LE(off(u.model.jerk, q.model.jerk) * horizon_s * horizon_s * horizon_s / 6, step);
    ASSERT_LE((s.angular_velocity_body - r.angular_velocity_body).norm() * horizon_s, half_degrees);
    ASSERT_LE(
        (u.model.angular_acceleration_body - q.model.angular_acceleration_body).norm() * horizon_s * horizon_s / 2,
        half_degrees);
    ASSERT_LE(angle_between(s.orientation, r.orientation), kOrientationError_rad);
    const auto then = evaluate(u.model, horizon_s), believed = evaluate(q.model, horizon_s);
    ASSERT_LE((then.position - believed.position).norm(), std::sqrt(3.0) * 4.5 * step + 1e-9);
    const auto soon = evaluate(u.model, 1.0), believed_soon = evaluate(q.model, 1.0);
    ASSERT_LE(angle_between(soon.orientation, believed_soon.orientation), kOrientationError_rad + 2 * half_degrees);
  }
  EXPECT_EQ(rounded, 3000);
}

// A part with an unusually large value is alone there: a rate must be exact enough for whatever it turns.
TEST_P(Kind, ItsRateMovesNoAxisByMoreThanAStep) {
  if (GetParam() != MotionKind::kTurning && GetParam() != MotionKind::kOscillating) return;
  RecordMaker make(3);
  for (int i = 0; i < 5000; ++i) {
    SCOPED_TRACE(i);
    UpdateRecord u = make.record(GetParam());
    u.model.state.acceleration = make.vector(std::ldexp(1.0, static_cast<int>(make.draw(-8, 8))));
    const UpdateRecord q = quantised(u, {0.01, kAngle_rad});
    ASSERT_TRUE(q.position_step_log2);
    MotionModel exact_rate = q.model;
    exact_rate.rate_rad_s = u.model.rate_rad_s;
    const double horizon_s = std::ldexp(1.0, horizon_log2_s(GetParam()));
    for (const double t : {0.1 * horizon_s, 0.5 * horizon_s, horizon_s}) {
      const Vec3 off = evaluate(exact_rate, t).position - evaluate(q.model, t).position;
      ASSERT_LE(off.cwiseAbs().maxCoeff(), std::ldexp(1.0, *q.position_step_log2) + 1e-12);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Each, Kind, testing::ValuesIn(kMotionKinds),
                         [](const auto& kind) { return std::string(to_string(kind.param)); });

TEST(Step, IsASixteenthOfTheToleranceWithinWhatThereIs) {
  EXPECT_EQ(position_step_log2(MotionKind::kSecond, 0.05), -9);
  EXPECT_EQ(position_step_log2(MotionKind::kSecond, 1e9), kStepMost_log2);
  EXPECT_EQ(position_step_log2(MotionKind::kSecond, 0.005), -12);
  EXPECT_EQ(position_step_log2(MotionKind::kOscillating, 0.005), -14);
  EXPECT_EQ(position_step_log2(MotionKind::kSecond, std::ldexp(1.0, -19)), kStepLeast_log2);
  EXPECT_EQ(position_step_log2(MotionKind::kSecond, std::nextafter(std::ldexp(1.0, -19), 0.0)), std::nullopt);
  EXPECT_EQ(position_step_log2(MotionKind::kSecond, 0.0), std::nullopt);
  EXPECT_EQ(position_step_log2(MotionKind::kSecond, std::nan("")), std::nullopt);
}

// ---- bytes ----

// The example of proto/README.md.
TEST(Bytes, AreThoseOfTheSpecification) {
  UpdateRecord u{ObjectId{5}, 300, sim(2s), moving({10, 0, -2.5}, {1.5, 0, 0}, {0, 0, -0.5}), {}};
  u.model.state.orientation = Quat(std::sqrt(0.5), 0, std::sqrt(0.5), 0);
  u.model.state.angular_velocity_body = {0, 0.25, 0};
  const UpdateRecord q = quantised(u, {0.05, kAngle_rad});
  EXPECT_EQ(q.position_step_log2, -9);
  Bytes expected;
  for (const int b : {0xe2, 0xb4, 0x02, 0x56, 0x81, 0x66, 0x01, 0xd0, 0x00, 0x25, 0x01, 0x0c, 0xc0, 0x01, 0x08, 0xe4,
                      0xff, 0x13, 0x80}) {
    expected.push_back(static_cast<std::byte>(b));
  }
  EXPECT_EQ(bytes_of(q, q.at), expected);
  const auto back = decoded(expected, sim(2s));
  ASSERT_TRUE(back.has_value());
  EXPECT_TRUE(same_bits(*back, q));
  EXPECT_EQ(back->object, u.object);
  EXPECT_EQ(back->sequence, u.sequence);
  EXPECT_EQ(back->at, u.at);
  EXPECT_EQ(back->model.kind, MotionKind::kSecond);
  EXPECT_EQ(back->model.state.position, u.model.state.position);
  EXPECT_EQ(back->model.state.velocity, u.model.state.velocity);
  EXPECT_EQ(back->model.state.acceleration, u.model.state.acceleration);
  EXPECT_EQ(back->model.state.angular_velocity_body, u.model.state.angular_velocity_body);
  EXPECT_LT(angle_between(back->model.state.orientation, u.model.state.orientation), 1e-7);
}

// A set of bits that encode_record() never writes.
TEST(Bytes, ThatNobodyWritesAreRefused) {
  const auto taken = [](std::initializer_list<std::pair<std::uint64_t, int>> fields) {
    std::array<std::byte, kRecordMax_bytes> bytes{};
    std::size_t bits = 0;
    for (const auto& [value, count] : fields) {
      for (int i = 0; i < count; ++i, ++bits) bytes[bits / 8] |= static_cast<std::byte>((value >> i & 1) << bits % 8);
    }
    std::span<const std::byte> rest(bytes.data(), (bits + 7) / 8);
    return decode_record(rest, sim(1s)).has_value();
  };
  // kind, step; later, decided, turned, spins up, level, upright, borne; object; sequence; position, velocity; spin
  EXPECT_TRUE(taken({{1, 4}, {14, 4}, {48, 7}, {5, 8}, {1, 8}, {0, 6}, {0, 5}, {0, 5}}));
  EXPECT_FALSE(taken({{0, 4}, {14, 4}, {48, 7}, {5, 8}, {1, 8}, {0, 6}, {0, 5}, {0, 5}})) << "no kind";
  EXPECT_FALSE(taken({{1, 4}, {14, 4}, {48, 7}, {5, 8}, {0, 8}, {0, 6}, {0, 5}, {0, 5}})) << "no sequence";
  EXPECT_FALSE(taken({{1, 4}, {14, 4}, {48, 7}, {0x0085, 16}, {1, 8}, {0, 6}, {0, 5}, {0, 5}})) << "a group too many";
  EXPECT_FALSE(taken({{1, 4}, {14, 4}, {48, 7}, {5, 8}, {0x1FFFFFFFFF, 40}, {0, 6}, {0, 5}, {0, 5}})) << "33 bits";
  EXPECT_TRUE(taken({{1, 4}, {14, 4}, {48, 7}, {5, 8}, {0x0FFFFFFFFF, 40}, {0, 6}, {0, 5}, {0, 5}}));
  constexpr std::uint64_t kOnes = ~std::uint64_t{0};
  EXPECT_FALSE(taken({{1, 4}, {14, 4}, {48, 7}, {kOnes, 64}, {0x2FF, 16}, {1, 8}, {0, 6}, {0, 5}, {0, 5}}))
      << "65 bits";
  EXPECT_TRUE(taken({{1, 4}, {14, 4}, {48, 7}, {kOnes, 64}, {0x1FF, 16}, {1, 8}, {0, 6}, {0, 5}, {0, 5}}));
  EXPECT_FALSE(taken({{1, 4}, {14, 4}, {49, 7}, {5, 8}, {1, 8}, {0, 8}, {0, 6}, {0, 5}, {0, 5}})) << "later by nothing";
  EXPECT_FALSE(taken({{1, 4}, {14, 4}, {56, 7}, {5, 8}, {1, 8}, {0, 6}, {0, 5}, {0, 5}, {0, 5}})) << "spins up by none";
  EXPECT_FALSE(taken({{1, 4}, {14, 4}, {0, 7}, {5, 8}, {1, 8}, {0, 6}, {0, 5}, {0, 5}})) << "level and upright";
  EXPECT_FALSE(taken({{1, 4}, {14, 4}, {20, 7}, {5, 8}, {1, 8}, {0, 6}, {0, 5}, {0, 2}, {1, 1}, {0, 3}, {0, 5}}))
      << "an identity that is sent";
  EXPECT_TRUE(taken({{1, 4}, {14, 4}, {20, 7}, {5, 8}, {1, 8}, {0, 6}, {0, 5}, {1, 2}, {1, 1}, {0, 3}, {0, 5}}));
  EXPECT_FALSE(taken({{1, 4}, {14, 4}, {20, 7}, {5, 8}, {1, 8}, {0, 6}, {0, 5}, {2, 2}, {1, 1}, {0, 3}, {0, 5}}))
      << "half a turn about the vertical";
  const auto turned_upright = [&](std::uint64_t largest_is_y, std::uint64_t other) {
    return taken({{1, 4}, {14, 4}, {52, 7}, {5, 8}, {1, 8}, {0, 6}, {0, 5}, {largest_is_y, 1}, {other, 13}, {0, 5}});
  };
  EXPECT_TRUE(turned_upright(1, 0));
  EXPECT_TRUE(turned_upright(0, 0b11));
  EXPECT_FALSE(turned_upright(0, 0)) << "an identity that is sent";
  EXPECT_FALSE(turned_upright(1, 1)) << "minus zero";
  const auto velocity = [&](std::uint64_t x, std::uint64_t z) {
    return taken({{1, 4}, {14, 4}, {48, 7}, {5, 8}, {1, 8}, {0, 6}, {3, 5}, {x, 4}, {z, 4}, {0, 5}});
  };
  EXPECT_TRUE(velocity(0b1010, 0));
  EXPECT_FALSE(velocity(0b1010, 1)) << "minus zero";
  EXPECT_FALSE(velocity(0b0110, 0b0101)) << "a width too many";
  const auto position = [&](std::uint64_t width, std::uint64_t sparse, std::uint64_t mask, std::uint64_t axis) {
    return taken({{1, 4},
                  {14, 4},
                  {48, 7},
                  {5, 8},
                  {1, 8},
                  {width, 6},
                  {sparse, 1},
                  {mask, 3},
                  {axis, static_cast<int>(width) + 1},
                  {0, 5},
                  {0, 5}});
  };
  EXPECT_TRUE(position(3, 1, 1, 0b1010));
  EXPECT_FALSE(position(3, 1, 1, 0b0110)) << "a width too many";
  EXPECT_FALSE(position(3, 1, 1, 0b0001)) << "minus zero";
  EXPECT_FALSE(position(3, 1, 0, 0b1010)) << "a width of nothing";
  EXPECT_FALSE(position(53, 1, 1, std::uint64_t{1} << 53)) << "no whole number of binary64";
  EXPECT_TRUE(position(48, 1, 1, std::uint64_t{1} << 48));
  EXPECT_FALSE(position(50, 1, 1, std::uint64_t{1} << 50)) << "2^40 m";
  EXPECT_FALSE(taken({{1, 4}, {14, 4}, {48, 7}, {5, 8}, {1, 8}, {0, 6}, {0, 5}, {0, 5}, {1, 1}})) << "padding";
  EXPECT_FALSE(taken({{2, 4}, {14, 4}, {48, 7}, {5, 8}, {1, 8}, {0, 6}, {0, 5}, {0, 5}})) << "no spin";
  const auto borne_since = [&](std::uint64_t zigzag_ns) {
    return taken({{1, 4}, {14, 4}, {112, 7}, {5, 8}, {1, 8}, {0, 6}, {0, 5}, {0, 5}, {0, 1}, {zigzag_ns, 8}});
  };
  EXPECT_TRUE(borne_since(0)) << "by an acceleration of zero";
  EXPECT_TRUE(borne_since(1)) << "a nanosecond before";
  EXPECT_FALSE(borne_since(2)) << "a nanosecond later";
}

// What drives an object that others bear travels exactly beside a rounded law.
TEST(Borne, DriveTravelsBitForBit) {
  UpdateRecord u{ObjectId{5}, 300, sim(10s), moving({10, 0, -2.5}, {1.5, 0, 0}, {0, 0, -0.5})};
  const std::size_t alone = bytes_of(quantised(u, {0.05, kAngle_rad}), u.at).size();
  u.drive = Drive{{0, -9.81, 0}, sim(8s)};
  const UpdateRecord q = quantised(u, {0.05, kAngle_rad});
  ASSERT_TRUE(q.position_step_log2);
  const Bytes bytes = bytes_of(q, q.at);
  EXPECT_LE(bytes.size(), alone + 15) << "one binary64, its axis, and five bytes of time";
  const auto back = decoded(bytes, q.at);
  ASSERT_TRUE(back && back->drive);
  EXPECT_EQ(back->drive->acceleration, u.drive->acceleration);
  EXPECT_EQ(back->drive->since, sim(8s));
  for (const double wrong : {std::nan(""), 1e13}) {
    UpdateRecord w = q;
    w.drive->acceleration.y() = wrong;
    EXPECT_FALSE(decoded(bytes_of(w, w.at), w.at)) << wrong;
  }
}

// ---- sizes ----

// DESIGN, section 5: at most 32 bytes for each moving object in a batch, headers included.
TEST(Size, OfTrafficIsAtMost32BytesEachInABatch) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Traffic traffic(seed);
    std::size_t bytes = 0;
    Message m = batch({});
    for (int i = 0; i < 40; ++i) {
      UpdateRecord u = quantised(traffic.update(sim(10s)), {0.05, kAngle_rad});
      ASSERT_TRUE(u.position_step_log2);
      m.updates.push_back(u);
      if (encode(m).size() <= kDatagramMax_bytes) continue;
      m.updates.pop_back();
      bytes += encode(m).size();
      m.updates = {u};
    }
    bytes += encode(m).size();
    EXPECT_LE(bytes, 40u * 32u) << seed;
  }
}

TEST(Size, OfTheLongestRecordFits) {
  MessageMaker make(1);
  UpdateRecord u = make.update();
  u.position_step_log2.reset();
  u.object = ObjectId{0xFFFF'FFFF};
  u.sequence = 0xFFFF'FFFF;
  u.at = sim(Duration{std::int64_t{1} << 62});
  u.decision = sim(Duration{-(std::int64_t{1} << 62)});
  u.model.kind = MotionKind::kOscillating;
  u.drive = Drive{{1.0 / 3.0, 2.0 / 3.0, -9.81}, sim(Duration{-(std::int64_t{1} << 62)})};
  u.model.state = moving({1, 2, 3}, {4, 5, 6}, {7, 8, 9});
  u.model.state.orientation = Quat(0.5, 0.5, 0.5, 0.5);
  u.model.state.angular_velocity_body = u.model.jerk = u.model.rate_rad_s =
      u.model.angular_acceleration_body = {1, 2, 3};
  const Bytes bytes = bytes_of(u, sim(Duration{-(std::int64_t{1} << 62)}));
  EXPECT_LE(bytes.size(), kRecordMax_bytes);
  EXPECT_TRUE(same_bits(decoded(bytes, sim(Duration{-(std::int64_t{1} << 62)})).value(), u));
}

// ---- what is exact ----

TEST(Exact, IsWhatHasNoTolerance) {
  RecordMaker make(4);
  const UpdateRecord u = make.record(MotionKind::kSecond);
  for (const Tolerance& none : {Tolerance{}, Tolerance{0.05, 0.0}, Tolerance{1e-7, kAngle_rad},
                                Tolerance{0.05, 0.99 * kCoarsestAngle_rad}, Tolerance{std::nan(""), kAngle_rad}}) {
    EXPECT_TRUE(same_bits(quantised(u, none), u));
  }
  EXPECT_TRUE(quantised(u, {0.05, kCoarsestAngle_rad}).position_step_log2);
}

TEST(Exact, IsWhatIsTooFarOrTooFastForItsSteps) {
  const auto rounds = [](const KinematicState& s, double tolerance_m) {
    return quantised({ObjectId{1}, 1, {}, s}, {tolerance_m, kAngle_rad}).position_step_log2.has_value();
  };
  EXPECT_TRUE(rounds(moving({1e9, -1e9, 3}, {10, 0, 0}, {1, 0, 0}), 0.05));
  EXPECT_FALSE(rounds(moving({1e12, 0, 0}, {10, 0, 0}, {1, 0, 0}), 1e-5));  // beyond 2^52 steps
  EXPECT_FALSE(rounds(moving({0, 0, 0}, {1e10, 0, 0}, {1, 0, 0}), 0.05));
}

// Rounding must not lead out of the limits that receivers enforce.
TEST(Exact, IsWhatRoundsBeyondTheLimits) {
  UpdateRecord u{ObjectId{1}, 1, {}, moving({1, 2, 3})};
  u.model.state.angular_velocity_body = Vec3(1, 1, 1).normalized() * (kRateMax_rad_s * 100.0 - 1e-7);
  for (int i = 0; i < 2000; ++i) {
    u.model.state.angular_velocity_body = (Vec3(1, 1, 1) + Vec3(i, 2 * i, 0) * 1e-3).normalized() * (1e4 - 1e-7);
    const UpdateRecord q = quantised(u, {0.05, kAngle_rad});
    ASSERT_LE(q.model.state.angular_velocity_body.norm(), 1e4);
    ASSERT_TRUE(decoded(bytes_of(q, q.at), q.at).has_value());
  }
}

// Friction that rounds to nothing would stop the object at once, metres before it does stop.
TEST(Exact, IsWhatWouldStopShort) {
  UpdateRecord u{ObjectId{1}, 1, {}, moving({1, 2, 3}, {1, 0, 0}, {-1e-5, 0, 0})};
  u.model.kind = MotionKind::kSliding;
  EXPECT_TRUE(same_bits(quantised(u, {0.05, kAngle_rad}), u));
  u.model.state.acceleration.x() = -0.01;
  EXPECT_TRUE(quantised(u, {0.05, kAngle_rad}).position_step_log2);
}

TEST(Exact, KeepsEveryBit) {
  UpdateRecord u{ObjectId{1}, 1, sim(1s), moving({0.1, -0.0, 1e-300}, {1.0 / 3.0, 0, 0})};
  u.model.state.orientation = Quat(-1.0, 0, 0, 0);
  EXPECT_TRUE(same_bits(quantised(u, {}), u));
  EXPECT_TRUE(same_bits(decoded(bytes_of(u, u.at), u.at).value(), u));
}

TEST(Quantised, SaysASecondOrderWhoseAccelerationRoundsToZeroAsTheFirst) {
  for (const MotionKind kind : {MotionKind::kSecond, MotionKind::kHistory}) {
    UpdateRecord u{ObjectId{1}, 1, {}, moving({1, 2, 3}, {1, 2, 3})};
    u.model.kind = kind;
    EXPECT_EQ(quantised(u, {0.05, kAngle_rad}).model.kind, MotionKind::kFirst);
    const double half_a_step = std::ldexp(1.0, kStepMost_log2 + 1);
    u.model.state.acceleration = {0.0, half_a_step, -half_a_step};
    EXPECT_EQ(quantised(u, {0.05, kAngle_rad}).model.kind, MotionKind::kFirst);
    u.model.state.acceleration.y() *= 1.001;
    EXPECT_EQ(quantised(u, {0.05, kAngle_rad}).model.kind, kind);
  }
}

// ---- times ----

TEST(Time, IsExactAndCostsNothingAtTheBase) {
  RecordMaker make(5);
  const UpdateRecord plain = quantised(make.record(MotionKind::kSecond), {0.05, kAngle_rad});
  const std::size_t size = bytes_of(plain, plain.at).size();
  struct Offset {
    Duration d;
    std::size_t bytes;
  };
  for (const auto& [d, bytes] : {Offset{1ns, 1}, Offset{-1ns, 1}, Offset{16'666'667ns, 4}, Offset{-1s, 5},
                                 Offset{Duration{std::int64_t{1} << 61}, 9}}) {
    EXPECT_EQ(bytes_of(plain, plain.at - d).size(), size + bytes);
    UpdateRecord decided = plain;
    decided.decision = plain.at - d;
    const Bytes out = bytes_of(decided, plain.at);
    EXPECT_EQ(out.size(), size + bytes);
    EXPECT_EQ(decoded(out, plain.at).value().decision, plain.at - d);
  }
}

// ---- damage ----

// The bytes are accepted only if they are a record: then the record encodes to the same bytes.
void expect_refused_or_same(const Bytes& bytes, SimTime base) {
  std::span<const std::byte> rest = bytes;
  const auto u = decode_record(rest, base);
  if (!u) return;
  ASSERT_TRUE(is_sound(u->model));
  const Bytes again = bytes_of(*u, base);
  ASSERT_EQ(again.size(), bytes.size() - rest.size());
  ASSERT_TRUE(same_bits(decoded(again, base).value(), *u));
}

TEST_P(Kind, SurvivesEveryFlippedBitAndTruncation) {
  RecordMaker make(6);
  for (int i = 0; i < 300; ++i) {
    SCOPED_TRACE(i);
    UpdateRecord u = quantised(make.record(GetParam()), {i % 4 == 0 ? 0.0 : 0.05, kAngle_rad});
    if (i % 3 == 0) u.decision = u.at - 300ms;
    const SimTime base = i % 2 == 0 ? u.at : u.at - 17ms;
    const Bytes good = bytes_of(u, base);
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
      Bytes bad = good;
      bad[bit / 8] ^= std::byte{1} << (bit % 8);
      ASSERT_NO_FATAL_FAILURE(expect_refused_or_same(bad, base)) << "bit " << bit;
    }
    for (std::size_t size = 1; size < good.size(); ++size) {
      const Bytes cut(good.begin(), good.begin() + static_cast<long>(size));
      std::span<const std::byte> rest = cut;
      ASSERT_FALSE(decode_record(rest, base).has_value()) << size;
    }
  }
}

TEST(Damage, OfNoiseIsRefusedOrARecord) {
  std::mt19937_64 rng(7);
  int taken = 0;
  for (int i = 0; i < 300000; ++i) {
    Bytes noise(1 + rng() % 80);
    for (std::byte& b : noise) b = static_cast<std::byte>(rng());
    ASSERT_NO_FATAL_FAILURE(expect_refused_or_same(noise, sim(1s)));
    std::span<const std::byte> rest = noise;
    taken += decode_record(rest, sim(1s)).has_value();
  }
  EXPECT_GT(taken, 0);  // some noise is one
}

TEST(Record, ACarrierCostsItsNumberAlone) {
  UpdateRecord u{ObjectId{200}, 1, sim(3s), moving({1, 2, 3}, {4, 5, 6})};
  const std::size_t in_the_world = bytes_of(u, u.at).size();
  u.carrier = ObjectId{100};
  EXPECT_EQ(bytes_of(u, u.at).size(), in_the_world + 1);
  u.carrier = ObjectId{1000};
  EXPECT_EQ(bytes_of(u, u.at).size(), in_the_world + 2);
}

}  // namespace peerd::replication::record_test
