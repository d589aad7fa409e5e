// Two probes on a virtual clock and a network of which the test says what it carries.
#include "peerd/net/doctor/pair_probe.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace peerd::doctor::pair_probe_test {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr HostTime kStart{seconds(1'700'000'000)};

struct Side {
  explicit Side(std::uint64_t session, Duration clock_offset = Duration{0}, Duration wait = seconds(60))
      : offset(clock_offset),
        probe({.session = session, .tcp_port = static_cast<std::uint16_t>(session), .multicast = true, .wait = wait},
              kStart + clock_offset) {}
  Duration offset;  // of its clock
  PairProbe probe;
  std::size_t sent = 0, sent_bytes = 0;
  std::vector<std::uint16_t> connects;
};

// A pair and what lies between: whether a datagram of so many bytes arrives.
struct Pair {
  using Carries = std::function<bool(bool from_a, Path, std::size_t size_bytes)>;
  explicit Pair(Carries network) : carries(std::move(network)) {}

  void exchange(Side& from, Side& to, bool from_a) {
    from.probe.on_tick(now + from.offset);
    for (const auto& output : from.probe.take_outputs()) {
      if (const auto* connect = std::get_if<PairProbe::Connect>(&output)) from.connects.push_back(connect->port);
      const auto* send = std::get_if<PairProbe::Send>(&output);
      if (send == nullptr) continue;
      ++from.sent;
      from.sent_bytes += send->datagram.size();
      if (carries(from_a, send->path, send->datagram.size()))
        in_flight.push_back({now + delay, &to, send->path, send->datagram});
    }
  }
  // Steps of 1 ms until both have ended, at most 100 s.
  void run() {
    while (!(a.probe.ended() && b.probe.ended()) && now < kStart + seconds(100)) {
      exchange(a, b, true);
      if (now >= b_starts) exchange(b, a, false);
      now += milliseconds(1);
      std::erase_if(in_flight, [&](const Flying& f) {
        if (f.at > now) return false;
        f.to->probe.on_datagram(now + f.to->offset, f.path, f.datagram);
        return true;
      });
    }
  }

  struct Flying {
    HostTime at;
    Side* to;
    Path path;
    std::vector<std::byte> datagram;
  };
  Carries carries;
  Duration delay = milliseconds(10);
  HostTime now = kStart, b_starts = kStart;
  Side a{1}, b{2, milliseconds(250)};
  std::vector<Flying> in_flight;
};

bool all_of(bool, Path, std::size_t) { return true; }

TEST(PairProbe, BothKnowThatAllArrives) {
  Pair pair(all_of);
  pair.run();
  for (const Side* side : {&pair.a, &pair.b}) {
    const PairResult& r = side->probe.result();
    EXPECT_TRUE(r.answered && r.is_heard && r.complete);
    EXPECT_EQ(r.unicast_in, (Heard{true, kStream, 1472}));
    EXPECT_EQ(r.unicast_out, (Heard{true, kStream, 1472}));
    EXPECT_EQ(r.multicast_in, (Heard{true, kStream, 1232}));
    EXPECT_EQ(r.multicast_out, (Heard{true, kStream, 1232}));
    ASSERT_TRUE(r.round_trip);
    EXPECT_GE(*r.round_trip, milliseconds(20));
    EXPECT_LE(*r.round_trip, milliseconds(22)) << "steps of 1 ms";
  }
  EXPECT_LE(abs(pair.a.probe.result().clock_ahead - milliseconds(250)), milliseconds(1));
  EXPECT_LE(abs(pair.b.probe.result().clock_ahead + milliseconds(250)), milliseconds(1));
  EXPECT_EQ(pair.a.connects, std::vector<std::uint16_t>{2}) << "once, to the port that the other has named";
  EXPECT_LT(pair.now, kStart + seconds(10));
}

TEST(PairProbe, WaitsForTheOtherSideAndNoLonger) {
  Pair late(all_of);
  late.b_starts = kStart + seconds(50);
  late.run();
  EXPECT_TRUE(late.a.probe.result().complete);
  EXPECT_EQ(late.a.probe.result().multicast_in.stream, kStream);
  Pair alone([](bool, Path, std::size_t) { return false; });
  alone.run();
  EXPECT_FALSE(alone.a.probe.result().answered);
  EXPECT_GE(alone.now, kStart + seconds(60));
  EXPECT_LT(alone.now, kStart + seconds(61));
}

TEST(PairProbe, EachWayIsToldFromTheOthers) {
  Pair pair([](bool from_a, Path path, std::size_t) { return path == Path::kUnicast || from_a; });
  pair.run();
  EXPECT_FALSE(pair.a.probe.result().multicast_in.any);
  EXPECT_TRUE(pair.a.probe.result().multicast_out.any);
  EXPECT_TRUE(pair.b.probe.result().multicast_in.any);
  EXPECT_FALSE(pair.b.probe.result().multicast_out.any);
  EXPECT_TRUE(pair.a.probe.result().complete && pair.b.probe.result().complete);
}

TEST(PairProbe, WhoIsNotHeardKnowsItWithin13Seconds) {
  Pair pair([](bool from_a, Path, std::size_t) { return !from_a; });
  pair.run();
  EXPECT_TRUE(pair.a.probe.result().answered);
  EXPECT_FALSE(pair.a.probe.result().is_heard);
  EXPECT_FALSE(pair.b.probe.result().answered);
}

TEST(PairProbe, LengthsThatDoNotFitAreKnown) {
  Pair pair([](bool, Path, std::size_t size_bytes) { return size_bytes <= 1232; });
  pair.run();
  EXPECT_EQ(pair.a.probe.result().unicast_in.largest_bytes, 1232);
  EXPECT_EQ(pair.a.probe.result().unicast_out.largest_bytes, 1232);
}

TEST(PairProbe, LossIsCounted) {
  int datagrams = 0;
  Pair pair([&](bool from_a, Path path, std::size_t size_bytes) {
    return !(from_a && path == Path::kMulticast && size_bytes == 300 && datagrams++ % 10 == 0);
  });
  pair.run();
  EXPECT_EQ(pair.b.probe.result().multicast_in.stream, kStream - kStream / 10);
  EXPECT_EQ(pair.a.probe.result().multicast_out.stream, kStream - kStream / 10);
  EXPECT_EQ(pair.a.probe.result().multicast_in.stream, kStream);
}

// Whatever arrives, how much is sent is decided by time alone: a forger gains nothing.
TEST(PairProbe, NothingIsAnAnswer) {
  PairProbe probe({.session = 1, .wait = seconds(60)}, kStart);
  PairMessage forged{.session = 9, .sent = kStart};
  std::size_t sent_at_once = 0;
  probe.on_tick(kStart);
  EXPECT_FALSE(probe.take_outputs().empty());
  for (int i = 0; i < 1000; ++i) {
    forged.session = 9 + static_cast<std::uint64_t>(i);
    probe.on_datagram(kStart + milliseconds(1), Path::kUnicast, encode(forged, kPairMessage_bytes));
    probe.on_tick(kStart + milliseconds(1));
    sent_at_once += probe.take_outputs().size();
  }
  EXPECT_EQ(sent_at_once, 0u);
}

TEST(PairProbe, ASecondRunOfTheOtherSideReplacesTheFirst) {
  PairProbe probe({.session = 1, .wait = seconds(60)}, kStart);
  PairMessage m;
  m.sent = kStart;
  const auto hear = [&](std::uint64_t session, Duration after) {
    m.session = session;
    probe.on_datagram(kStart + after, Path::kUnicast, encode(m, 500));
  };
  hear(5, milliseconds(0));
  hear(6, milliseconds(500));
  EXPECT_EQ(probe.other(), 5u) << "the first is not silent";
  hear(6, milliseconds(1600));
  EXPECT_EQ(probe.other(), 6u);
  m.path = Path::kMulticast;
  hear(6, milliseconds(1700));
  EXPECT_FALSE(probe.result().multicast_in.any) << "it came by another path than it was sent by";
  m.path = Path::kUnicast;
  hear(1, milliseconds(5000));
  EXPECT_EQ(probe.other(), 6u) << "a side does not meet itself";
}

TEST(PairProbe, ReportsAboutOthersAndAbsurdTimesAreNotBelieved) {
  PairProbe probe({.session = 1, .wait = seconds(60)}, kStart);
  PairMessage m{.session = 2, .other = 3, .sent = kStart, .echo_sent = kStart, .unicast = {true, kStream, 1472}};
  probe.on_datagram(kStart + milliseconds(5), Path::kUnicast, encode(m, kPairMessage_bytes));
  EXPECT_TRUE(probe.result().answered);
  EXPECT_FALSE(probe.result().is_heard);
  EXPECT_FALSE(probe.result().unicast_out.any);
  m.other = 1;
  m.echo_held = seconds(1);
  probe.on_datagram(kStart + milliseconds(5), Path::kUnicast, encode(m, kPairMessage_bytes));
  EXPECT_FALSE(probe.result().round_trip) << "held for longer than it was on its way";
  m.echo_held = Duration{0};
  m.echo_sent = kStart + seconds(1);
  probe.on_datagram(kStart + milliseconds(5), Path::kUnicast, encode(m, kPairMessage_bytes));
  EXPECT_FALSE(probe.result().round_trip) << "sent in the future";
  m.echo_sent = kStart;
  probe.on_datagram(kStart + milliseconds(5), Path::kUnicast, encode(m, kPairMessage_bytes));
  EXPECT_EQ(probe.result().round_trip, milliseconds(5));
}

// The driver sleeps until the next deadline: nothing may be due earlier, and none may stay in the past.
TEST(PairProbe, DeadlinesAreWhenSomethingIsDue) {
  PairProbe probe({.session = 1, .wait = seconds(2)}, kStart);
  const PairMessage m{.session = 2, .sent = kStart};
  probe.on_datagram(kStart + milliseconds(100), Path::kUnicast, encode(m, kPairMessage_bytes));
  HostTime now = kStart;
  int steps = 0;
  for (; !probe.ended() && steps < 2000; ++steps) {
    probe.on_tick(now);
    (void)probe.take_outputs();
    if (probe.ended()) break;
    ASSERT_GT(probe.next_deadline(), now);
    now = probe.next_deadline();
  }
  EXPECT_TRUE(probe.ended());
  EXPECT_EQ(now, kStart + milliseconds(100) + seconds(13));
  EXPECT_LT(steps, 400);
}

}  // namespace peerd::doctor::pair_probe_test
