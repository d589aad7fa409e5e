#include "replication/wire/codec.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <set>

#include "tests/replication/peer/messages.hpp"

namespace peerd::replication::codec_test {

using namespace test;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(Codec, RoundTripsBitForBit) {
  for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
    SCOPED_TRACE(seed);
    MessageMaker make(seed);
    const Message m = make.message(seed % 4, seed % 3 == 0, seed % 2 == 0);
    const Bytes bytes = encode(m);
    if (bytes.size() > kDatagramMax_bytes) continue;
    const auto back = received(bytes, m);
    ASSERT_TRUE(back.has_value()) << to_string(back.error());
    ASSERT_TRUE(same_bits(m, *back));
    ASSERT_EQ(encode(*back), bytes);
  }
}

// One message leaves no trace in the next, even if it is damaged.
TEST(Codec, OneServesManyMessages) {
  Codec codec;
  Bytes again;
  for (std::uint64_t seed = 1; seed <= 500; ++seed) {
    SCOPED_TRACE(seed);
    MessageMaker make(seed);
    const Message m = make.message(seed % 4, seed % 3 == 0, seed % 2 == 0);
    const Bytes bytes = encode(m);
    std::vector<EncodedUpdate> updates;
    for (const UpdateRecord& u : m.updates) updates.emplace_back(u, m.updates.front().at);
    codec.encode(m, updates, again);
    ASSERT_EQ(again, bytes);
    if (bytes.size() > kDatagramMax_bytes) continue;
    const SimTime near = !m.updates.empty()     ? m.updates.front().at
                         : !m.decisions.empty() ? m.decisions.front().contact
                                                : SimTime{};
    (void)codec.decode(std::span(bytes).first(bytes.size() - 1 - seed % 5), near);
    const auto back = codec.decode(bytes, near);
    ASSERT_TRUE(back.has_value()) << to_string(back.error());
    ASSERT_TRUE(same_bits(m, **back));
  }
}

Message from_one() {
  Message m;
  m.sender = PeerId{1};
  m.incarnation = 1;
  return m;
}

TEST(Codec, TheSmallestMessageIsFewBytes) {
  Message m = from_one();
  EXPECT_EQ(encode(m).size(), 6u);  // version, sender, boot
  const auto back = received(encode(m), m);
  ASSERT_TRUE(back.has_value());
  EXPECT_TRUE(same_bits(m, *back));
}

// A sender packs datagrams by the sizes that the records really take.
TEST(Codec, RecordsTakeWhatTheySay) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(seed);
    MessageMaker make(seed);
    Message m = make.message(0, 0, false);
    const std::size_t empty = encode(m).size();
    std::size_t records = 0;
    for (int i = 0; i < 3; ++i) {
      m.updates.push_back(make.update());
      records += encoded_size_bytes(m.updates.back(), m.updates.front().at);
      const std::size_t length_bytes = records + 5 < 128 ? 1 : 2;  // of the two that kUpdatesHeader_bytes counts
      EXPECT_EQ(encode(m).size() - empty, kUpdatesHeader_bytes - 2 + length_bytes + records);
    }
    const std::size_t with_update = encode(m).size();
    std::size_t decisions = 0;
    for (int i = 0; i < 2; ++i) {
      m.decisions.push_back(make.decision());
      decisions += encoded_size_bytes(m.decisions.back());
      const std::size_t length_bytes = decisions < 128 ? 1 : 2;  // of the two that kDecisionsHeader_bytes counts
      EXPECT_EQ(encode(m).size() - with_update, kDecisionsHeader_bytes - 2 + length_bytes + decisions);
    }
  }
}

// ---- values ----

Message updating(const std::function<void(UpdateRecord&)>& change) {
  Message m = from_one();
  m.updates.push_back({ObjectId{1}, 1, sim(1s), moving({1, 2, 3}, {4, 5, 6})});
  change(m.updates.front());
  return m;
}
Message of_kind(MotionKind kind, const std::function<void(UpdateRecord&)>& change) {
  return updating([&](UpdateRecord& u) {
    u.model.kind = kind;
    change(u);
  });
}
Message deciding(const std::function<void(DecisionRecord&)>& change) {
  Message m = from_one();
  m.decisions.push_back({ObjectId{1}, ObjectId{2}, sim(1s), Vec3::UnitX(), {}, {}, {}, {}, DecisionRule::kId});
  change(m.decisions.front());
  return m;
}
constexpr std::uint64_t kAll = ~std::uint64_t{0};
Message greeting(const std::function<void(Hello&)>& change) {
  Message m = from_one();
  m.hello.emplace();
  m.hello->session_tx = sim(2s);
  m.hello->echoes = {{PeerId{2}, 4990, 1s, {5003, 1000, kAll}, 0.5}};
  m.hello->notes = {{ObjectId{1}, ObjectId{2}, sim(1s), true}};
  change(*m.hello);
  return m;
}
Message having(const Received& received) {
  return greeting([&](Hello& h) { h.echoes[0].received = received; });
}
Message introducing(const std::function<void(Introduction&)>& change) {
  return greeting([&](Hello& h) {
    Introduction& i = h.introduction.emplace();
    i.name = "a";
    i.viewpoint = Viewpoint{ObjectId{3}, {Vec3(1, 2, 3), Quat::Identity()}, 1.0, 1.5};
    change(i);
  });
}

struct Case {
  const char* name;
  Message message;
  bool accepted;
};
class Value : public testing::TestWithParam<Case> {};
TEST_P(Value, IsChecked) {
  const auto decoded = received(encode(GetParam().message), GetParam().message);
  EXPECT_EQ(decoded.has_value(), GetParam().accepted);
  if (!decoded) {
    EXPECT_EQ(decoded.error(), DecodeError::kValue);
  }
}

// A newer build's models must not make the rest of its datagrams unreadable: its records of kind 8 begin with their
// length.
TEST(UnknownModel, IsLeftOutAndCounted) {
  const Message good = updating([](auto& u) { u.object = ObjectId{77}; });
  const auto decoded = received(with_records(good, {0x08, 3, 1, 2, 3}, {0xF8, 0}), good);
  ASSERT_TRUE(decoded);
  ASSERT_EQ(decoded->updates.size(), 1u);
  EXPECT_EQ(decoded->updates[0].object, ObjectId{77});
  EXPECT_EQ(decoded->unknown_models, 2u);
  EXPECT_FALSE(received(with_records(good, {}, {0x08}), good));           // no length
  EXPECT_FALSE(received(with_records(good, {}, {0x08, 2, 1}), good));     // cut short
  EXPECT_FALSE(received(with_records(good, {0x00, 2, 1, 1}, {}), good));  // no kind
}

// Of a scene that has only such records nothing is left, not even its time.
TEST(UnknownModel, ASceneOfNothingElseIsNone) {
  Message m = updating([](auto&) {});
  m.scene.since = SimTime{Duration{0x0102'0304'0506'0708}};
  m.scene.states = {m.updates[0]};
  m.scene.states[0].position_step_log2.reset();
  const Bytes bytes = encode(m);
  const std::vector since{std::byte{8}, std::byte{7}, std::byte{6}, std::byte{5},
                          std::byte{4}, std::byte{3}, std::byte{2}, std::byte{1}};
  const auto at = std::ranges::search(bytes, since).begin();
  ASSERT_NE(at, bytes.end());
  const auto size = std::to_integer<long>(at[-1]);
  ASSERT_LT(size, 128);
  const std::vector unknown{std::byte{8}, std::byte{3}, std::byte{1}, std::byte{2}, std::byte{3}};
  Bytes out(bytes.begin(), at - 1);
  out.push_back(static_cast<std::byte>(16 + unknown.size()));  // behind two times
  out.insert(out.end(), at, at + 16);
  out.insert(out.end(), unknown.begin(), unknown.end());
  out.insert(out.end(), at + size, bytes.end());
  const auto decoded = received(out, m);
  ASSERT_TRUE(decoded);
  EXPECT_EQ(decoded->unknown_models, 1u);
  EXPECT_TRUE(decoded->scene.states.empty());
  EXPECT_EQ(decoded->scene.since, SimTime{});
}

constexpr std::int64_t kFarthest_ns = std::int64_t{1} << 62;
INSTANTIATE_TEST_SUITE_P(
    Update, Value,
    testing::Values(
        Case{"Good", updating([](auto&) {}), true},
        Case{"NaNPosition", updating([](auto& u) { u.model.state.position.y() = kNaN; }), false},
        Case{"InfPosition", updating([](auto& u) { u.model.state.position.z() = kInf; }), false},
        Case{"FarPosition", updating([](auto& u) { u.model.state.position.x() = 1e12; }), true},
        Case{"TooFarPosition", updating([](auto& u) { u.model.state.position.x() = -1.0001e12; }), false},
        Case{"HugePosition", updating([](auto& u) { u.model.state.position.x() = 1e300; }), false},
        Case{"NaNVelocity", updating([](auto& u) { u.model.state.velocity.x() = kNaN; }), false},
        Case{"HugeVelocity", updating([](auto& u) { u.model.state.velocity.x() = 1e200; }), false},
        Case{"InfAcceleration", updating([](auto& u) { u.model.state.acceleration.x() = -kInf; }), false},
        Case{"NaNSpin", updating([](auto& u) { u.model.state.angular_velocity_body.z() = kNaN; }), false},
        Case{"FastestSpin", updating([](auto& u) { u.model.state.angular_velocity_body.z() = -1e4; }), true},
        Case{"TooFastASpin", updating([](auto& u) { u.model.state.angular_velocity_body.z() = 1.0001e4; }), false},
        Case{"ZeroQuaternion", updating([](auto& u) { u.model.state.orientation = Quat(0, 0, 0, 0); }), false},
        Case{"LongQuaternion", updating([](auto& u) { u.model.state.orientation = Quat(2, 0, 0, 0); }), false},
        Case{"NaNQuaternion", updating([](auto& u) { u.model.state.orientation = Quat(kNaN, 0, 0, 1); }), false},
        Case{"UnitQuaternion", updating([](auto& u) { u.model.state.orientation = Quat(0.6, 0, -0.8, 0); }), true},
        Case{"SequenceZero", updating([](auto& u) { u.sequence = 0; }), false},
        Case{"SequenceLast", updating([](auto& u) { u.sequence = 0xFFFF'FFFF; }), true},
        Case{"NoModel", updating([](auto& u) { u.model.kind = MotionKind{0}; }), false},
        Case{"MostJerk", of_kind(MotionKind::kThird, [](auto& u) { u.model.jerk.x() = -1e9; }), true},
        Case{"TooMuchJerk", of_kind(MotionKind::kThird, [](auto& u) { u.model.jerk = Vec3::Constant(1e9); }), false},
        Case{"NaNJerk", of_kind(MotionKind::kOscillating, [](auto& u) { u.model.jerk.z() = kNaN; }), false},
        Case{"FastestTurn", of_kind(MotionKind::kTurning, [](auto& u) { u.model.rate_rad_s.z() = -100; }), true},
        Case{"TooFastATurn",
             of_kind(MotionKind::kTurning,
                     [](auto& u) {
                       u.model.rate_rad_s = {80, 0, 80};
                     }),
             false},
        Case{"FastestWaves",
             of_kind(MotionKind::kOscillating, [](auto& u) { u.model.rate_rad_s = Vec3::Constant(100); }), true},
        Case{"TooFastAWave", of_kind(MotionKind::kOscillating, [](auto& u) { u.model.rate_rad_s.y() = 100.001; }),
             false},
        Case{"NegativeRateOfAWave", of_kind(MotionKind::kOscillating, [](auto& u) { u.model.rate_rad_s.y() = -1e-9; }),
             false},
        Case{"NaNRate", of_kind(MotionKind::kTurning, [](auto& u) { u.model.rate_rad_s.x() = kNaN; }), false},
        Case{"MostSpinAcceleration", updating([](auto& u) { u.model.angular_acceleration_body.x() = 2e3; }), true},
        Case{"TooMuchSpinAcceleration", updating([](auto& u) { u.model.angular_acceleration_body.x() = 2001; }), false},
        Case{"NaNSpinAcceleration", updating([](auto& u) { u.model.angular_acceleration_body.y() = kNaN; }), false},
        Case{"Farthest", updating([](auto& u) { u.at = sim(Duration{-kFarthest_ns}); }), true},
        Case{"TooFarAhead", updating([](auto& u) { u.at = sim(Duration{kFarthest_ns + 1}); }), false},
        Case{"EndOfTime", updating([](auto& u) { u.at = SimTime::max(); }), false},
        Case{"DecisionAtTheEndOfTime", updating([](auto& u) { u.decision = SimTime::max(); }), false},
        Case{"BeginOfTime", updating([](auto& u) { u.at = SimTime::min(); }), false}),
    [](const auto& c) { return std::string(c.param.name); });
// The others are in decision_bits_test.
INSTANTIATE_TEST_SUITE_P(
    Decision, Value,
    testing::Values(Case{"Good", deciding([](auto&) {}), true},
                    Case{"DecisionOnOneObject", deciding([](DecisionRecord& d) { d.collidee = d.collider; }), false},
                    Case{"NoNormal", deciding([](auto& d) { d.normal.setZero(); }), false},
                    Case{"EndOfTime", deciding([](auto& d) { d.contact = SimTime::max(); }), false}),
    [](const auto& c) { return std::string(c.param.name); });
INSTANTIATE_TEST_SUITE_P(
    Hello, Value,
    testing::Values(Case{"Good", greeting([](auto&) {}), true},
                    Case{"WithoutASession", greeting([](auto& h) { h.session_tx.reset(); }), true},
                    Case{"LongestLatency", greeting([](auto& h) { h.latency = kLatencyMax; }), true},
                    Case{"TooLongALatency", greeting([](auto& h) { h.latency = kLatencyMax + 1ms; }), false},
                    Case{"EndOfItsClock", greeting([](auto& h) { h.session_tx = SimTime::max(); }), false},
                    Case{"NoteOfTheEndOfTime", greeting([](auto& h) { h.notes[0].contact = SimTime::max(); }), false},
                    Case{"LongestHeld", greeting([](auto& h) { h.echoes[0].hold_time = 10s; }), true},
                    Case{"HeldForTooLong", greeting([](auto& h) { h.echoes[0].hold_time = 10s + 1ns; }), false},
                    Case{"LosesAll", greeting([](auto& h) { h.echoes[0].loss = 1.0; }), true},
                    Case{"LosesMoreThanAll", greeting([](auto& h) { h.echoes[0].loss = 1.001; }), false},
                    Case{"LongestRow", having({20'000, 16'383, kAll}), true},
                    Case{"TooLongARow", having({20'000, 16'384, kAll}), false},
                    Case{"FromTheFirst", greeting([](auto& h) { h.echoes[0].received.run = 5003; }), true},
                    Case{"FromBeforeTheFirst", greeting([](auto& h) { h.echoes[0].received.run = 5004; }), false},
                    Case{"Holes", having({5003, 3, ~0b101000ULL}), true},
                    Case{"AskedForAgain", greeting([](auto& h) {
                           h.echoes[0].received = {5003, 0, ~std::uint64_t{1}};
                         }),
                         true},
                    Case{"NoHoleBehindTheRow", having({5003, 3, ~0b110000ULL}), false}),
    [](const auto& c) { return std::string(c.param.name); });
INSTANTIATE_TEST_SUITE_P(
    Introduction, Value,
    testing::Values(
        Case{"Good", introducing([](auto&) {}), true},
        Case{"LooksFromNowhere", introducing([](auto& i) { i.viewpoint->pose.position.x() = kNaN; }), false},
        Case{"LooksNowhere", introducing([](auto& i) { i.viewpoint->pose.orientation = Quat(0, 0, 0, 0); }), false},
        Case{"SeesNothing", introducing([](auto& i) { i.viewpoint->field_of_view = 0.0; }), false},
        Case{"SeesAll", introducing([](auto& i) { i.viewpoint->field_of_view = 3.2; }), false},
        Case{"NaNView", introducing([](auto& i) { i.viewpoint->field_of_view = kNaN; }), false},
        Case{"NoAspect", introducing([](auto& i) { i.viewpoint->aspect = -1.0; }), false},
        Case{"NaNAspect", introducing([](auto& i) { i.viewpoint->aspect = kNaN; }), false},
        Case{"InfAspect", introducing([](auto& i) { i.viewpoint->aspect = kInf; }), false},
        Case{"NoName", introducing([](auto& i) { i.name.clear(); }), false},
        Case{"NameWithABlank", introducing([](auto& i) { i.name = "a b"; }), false},
        Case{"NameThatIsAPath", introducing([](auto& i) { i.name = "a/b"; }), false},
        Case{"NameThatIsNoText", introducing([](auto& i) { i.name = "\xff\n"; }), false},
        Case{"LongestName", introducing([](auto& i) { i.name.assign(kNameMax_bytes, 'n'); }), true},
        Case{"TooLongAName", introducing([](auto& i) { i.name.assign(kNameMax_bytes + 1, 'n'); }), false},
        Case{"StartTooFar", introducing([](auto& i) { i.start = SimTime::max(); }), false},
        Case{"ZeroTooFar", introducing([](auto& i) { i.world_zero = SimTime::min(); }), false}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(Datagram, OfALargeSessionSaysWhoItIsFor) {
  Message m = greeting([](auto&) {});
  m.nearby = true;
  auto decoded = decode(encode(m), SimTime{});
  ASSERT_TRUE(decoded);
  EXPECT_TRUE(decoded->nearby);
  EXPECT_FALSE(decoded->next_hello);
  m.nearby = false;
  m.next_hello = 41'500ms;
  decoded = decode(encode(m), SimTime{});
  ASSERT_TRUE(decoded);
  EXPECT_FALSE(decoded->nearby);
  EXPECT_EQ(decoded->next_hello, 41'500ms);
  m.next_hello = kNextHelloMax;
  EXPECT_TRUE(decode(encode(m), SimTime{}));
  m.next_hello = kNextHelloMax + 1ms;
  EXPECT_EQ(decode(encode(m), SimTime{}).error(), DecodeError::kValue);
}

TEST(Decode, SaysWhyItRefuses) {
  const Bytes good = encode(updating([](auto&) {}));
  EXPECT_EQ(decode(Bytes{}, SimTime{}).error(), DecodeError::kVersion);
  EXPECT_EQ(decode(Bytes(kDatagramMax_bytes + 1), SimTime{}).error(), DecodeError::kTooLong);
  EXPECT_EQ(decode(Bytes(100, std::byte{0xFF}), SimTime{}).error(), DecodeError::kNotADatagram);
  Bytes next_version = good;
  ASSERT_EQ(next_version[1], std::byte{kProtocolVersion});
  next_version[1] = std::byte{kProtocolVersion + 1};
  EXPECT_EQ(decode(next_version, SimTime{}).error(), DecodeError::kVersion);
  Bytes from_nobody = good;
  ASSERT_EQ(from_nobody[3], std::byte{1});
  from_nobody[3] = std::byte{0};
  EXPECT_EQ(decode(from_nobody, SimTime{}).error(), DecodeError::kSender);
}

// The first update's time is the base that the others' count from; each is checked.
TEST(Update, TimesOfABatchAreCheckedOneByOne) {
  Message m = updating([](auto&) {});
  for (const std::int64_t ns : {-kFarthest_ns, kFarthest_ns, std::int64_t{0}}) {
    m.updates.push_back(m.updates.front());
    m.updates.back().at = sim(Duration{ns});
  }
  const auto decoded = received(encode(m), m);
  ASSERT_TRUE(decoded);
  EXPECT_TRUE(same_bits(m, *decoded));
  m.updates.back().at = sim(Duration{kFarthest_ns + 1});
  EXPECT_FALSE(received(encode(m), m));
}

// The bits of a time that travel are enough for a receiver within nine minutes of it, on either side of any round
// number.
TEST(Update, TimesAreTakenToBeNear) {
  constexpr Duration kNear{(std::int64_t{1} << 39) - 1};
  for (const std::int64_t ns : {std::int64_t{0}, std::int64_t{1} << 40, -(std::int64_t{1} << 40) - 1,
                                std::int64_t{1'700'000'000'123'456'789}}) {
    const SimTime at{Duration{ns}};
    const Bytes bytes = encode(updating([&](auto& u) { u.at = at; }));
    for (const Duration off : {-kNear, Duration{-1}, Duration{0}, Duration{1}, kNear}) {
      EXPECT_EQ(decode(bytes, at + off)->updates[0].at, at) << ns << " from " << off.count();
    }
    EXPECT_NE(decode(bytes, at + 2 * kNear)->updates[0].at, at);
  }
}

TEST(SceneStates, KeepTheirTimesHoweverOldTheyAre) {
  Message m = updating([](auto&) {});
  m.scene.since = sim(-5s);
  m.scene.states.assign(2, m.updates[0]);
  m.scene.states[0].at = sim(3'000'000s);
  m.scene.states[1].at = sim(7s);
  m.scene.states[1].decision = sim(6s);
  for (UpdateRecord& u : m.scene.states) u.position_step_log2.reset();
  const auto back = decode(encode(m), m.updates[0].at);
  ASSERT_TRUE(back);
  EXPECT_TRUE(same_bits(m, *back));
  m.scene.states[0] = quantised(m.scene.states[0], {0.1, 0.1});
  ASSERT_TRUE(m.scene.states[0].position_step_log2);
  EXPECT_EQ(decode(encode(m), m.updates[0].at).error(), DecodeError::kValue) << "states are exact";
}

// Every datagram carries the low bits of the incarnation, one with an introduction all of them.
TEST(Boot, IsWholeWhereTheSenderIsIntroduced) {
  Message m = introducing([](auto&) {});
  m.incarnation = 0x0123'4567'89AB'CDEF;
  EXPECT_EQ(received(encode(m), m)->incarnation, m.incarnation);
  m.hello->introduction.reset();
  EXPECT_EQ(received(encode(m), m)->incarnation, incarnation_low(m.incarnation));
}

// The most frequent datagrams: the hello of a quarter of a second among three peers, and a batch of one update.
TEST(Sizes, AreFewBytes) {
  Message m = greeting([](Hello& h) {
    h.session_tx = sim(1'000'000s);
    h.sessions = 1;
    h.latency = 100ms;
    h.notes.clear();
    h.echoes = {{PeerId{2}, 5000, 150ms, {5003, 5003, kAll}, 0.0}, {PeerId{3}, 5000, 150ms, {5003, 5003, kAll}, 0.0}};
  });
  m.number = 5000;
  EXPECT_EQ(encode(m).size(), 48u);
}

// ---- damage ----

// The codec either refuses the bytes, or returns a message that keeps every promise and survives being sent on.
void expect_refused_or_sound(const Bytes& bytes) {
  auto m = decode(bytes, SimTime{});
  if (!m) return;
  ASSERT_TRUE(is_sound(*m));
  SimTime now{};
  if (m->unknown_models > 0 && !m->updates.empty()) {  // the base time may have been that of what was left out
    Message others = *m;
    others.updates.clear();
    const auto again = decode(encode(others), now);
    ASSERT_TRUE(again && same_bits(others, *again));
    now = m->updates.front().at;
    m->decisions.clear();
  }
  const auto again = decode(encode(*m), now);
  ASSERT_TRUE(again.has_value());
  ASSERT_TRUE(same_bits(*m, *again));
}

TEST(Decode, SurvivesEveryFlippedBit) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    MessageMaker make(seed);
    const Bytes good = encode(make.message(2, 1, true));
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
      Bytes bad = good;
      bad[bit / 8] ^= std::byte{1} << (bit % 8);
      ASSERT_NO_FATAL_FAILURE(expect_refused_or_sound(bad)) << "bit " << bit;
    }
  }
}

TEST(Decode, SurvivesEveryTruncation) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    MessageMaker make(seed);
    const Bytes good = encode(make.message(3, 1, true));
    for (std::size_t size = 0; size < good.size(); ++size) {
      ASSERT_NO_FATAL_FAILURE(expect_refused_or_sound(Bytes(good.begin(), good.begin() + static_cast<long>(size))));
    }
  }
}

TEST(Decode, SurvivesNoise) {
  std::mt19937_64 rng(1);
  for (int i = 0; i < 20000; ++i) {
    Bytes noise(rng() % 64);
    for (std::byte& b : noise) b = static_cast<std::byte>(rng());
    ASSERT_NO_FATAL_FAILURE(expect_refused_or_sound(noise));
  }
}

TEST(DecodeErrorName, IsDistinctForEach) {
  std::set<std::string> names;
  for (int i = 0; i <= static_cast<int>(DecodeError::kValue); ++i) names.insert(to_string(static_cast<DecodeError>(i)));
  EXPECT_EQ(names.size(), 5u);
  EXPECT_FALSE(names.contains("?"));
}

// The largest of everything that a peer puts into one hello.
TEST(HelloSize, AFullHelloFits) {
  constexpr std::uint32_t kHigh = 0xFFFF'FFFF;
  Message m;
  m.sender = PeerId{kHigh};
  m.incarnation = ~std::uint64_t{0};
  m.leaving = true;
  m.number = kHigh;
  Hello& h = m.hello.emplace();
  h.session_tx = sim(1s);
  h.sessions = kHigh;
  h.latency = kLatencyMax;
  h.clock_error = kClockErrorMax;
  h.os_clock = {Duration{kFarthest_ns}, kOsErrorMax};
  h.echoes.assign(kEchoesMax, {PeerId{kHigh}, 0x7FFF'FFFF, 10s, {kHigh, 0, 0}, 1.0});
  h.notes.assign(kNotesMax, {ObjectId{kHigh}, ObjectId{kHigh}, SimTime{Duration{kFarthest_ns}}, true});
  Introduction& i = h.introduction.emplace();
  i.name.assign(kNameMax_bytes, 'n');
  i.world_hash = ~std::uint64_t{0};
  i.start = i.world_zero = sim(1s);
  i.viewpoint = Viewpoint{ObjectId{kHigh}, {Vec3(1, 2, 3), Quat(0.5, 0.5, 0.5, 0.5)}, 1.0, 1.5};
  std::uint32_t id = 0;  // as many as can be differ by five bytes, the others by four
  for (std::uint32_t k = 0; k < 50; ++k) i.owned.push_back(ObjectId{id += k < 15 ? 0x1000'0000 : 0x0020'0000});
  m.subscriptions.assign(kSubscriptionsWithHello, {RegionId{kHigh}, sim(0s)});
  m.subscriptions.back().since = sim(10s);
  EXPECT_LE(encode(m).size(), kDatagramMax_bytes);
  i.owned_as_founder = ~std::uint64_t{0};
  i.line = ~std::uint64_t{0};
  i.has_edits = true;
  m.subscriptions.erase(m.subscriptions.begin());
  h.scene_digest = ~std::uint64_t{0};  // instead of one of the subscriptions
  m.subscriptions.pop_back();
  EXPECT_LE(encode(m).size(), kDatagramMax_bytes);
  m.leaving = false;
  m.nearby = true;
  EXPECT_LE(encode(m).size(), kDatagramMax_bytes);
  m.nearby = false;
  m.subscriptions.clear();
  h.notes.clear();
  h.scene_digest = 0;
  m.next_hello = std::chrono::hours(24);
  EXPECT_LE(encode(m).size(), kDatagramMax_bytes) << "a far hello";
}

}  // namespace peerd::replication::codec_test
