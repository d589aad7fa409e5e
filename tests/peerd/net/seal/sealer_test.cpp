#include "peerd/net/seal/sealer.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <random>
#include <set>
#include <string>

#include "tests/must.hpp"

namespace peerd::seal {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Bytes = std::vector<std::byte>;

constexpr RegionId kAll{0}, kHere{7};

Bytes bytes(std::string_view text) {
  Bytes all(text.size());
  std::memcpy(all.data(), text.data(), text.size());
  return all;
}
std::string text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

// Two peers of one session and what goes between them. The time is a hand's.
class Sealing : public testing::Test {
 protected:
  // The next start of a peer, which has an identity of its own.
  Sealer make(const keys::SymmetricKey& of, std::uint32_t id) {
    return {of, {.peer = PeerId{id}, .identity = identity(id)}};
  }
  const keys::Identity& identity(std::uint32_t id) {
    return identities.try_emplace(id, keys::Identity::random()).first->second;
  }
  Bytes sealed(Sealer& by, std::string_view what, RegionId region = kHere, bool is_signed = false) {
    const auto out = by.seal(now, region, bytes(what), is_signed);
    return {out.begin(), out.end()};
  }
  // The text of a datagram as that peer opens it, or the reason why it does not.
  std::string opened(Sealer& by, const Bytes& datagram, RegionId region = kHere) {
    const auto got = by.open(now, region, datagram);
    if (got) return text(got->datagram);
    switch (got.error()) {
      case Refusal::kOpen:
        return "<open>";
      case Refusal::kOwn:
        return "<own>";
      case Refusal::kUnproven:
        return "<unproven>";
      case Refusal::kForged:
        return "<forged>";
      case Refusal::kReplayed:
        return "<replayed>";
      case Refusal::kTooMany:
        return "<too many>";
      case Refusal::kNoMember:
        return "<no member>";
      case Refusal::kImpostor:
        return "<impostor>";
      case Refusal::kUnsigned:
        return "<unsigned>";
      case Refusal::kWrongSender:
        return "<wrong sender>";
      case Refusal::kObserver:
        return "<observer>";
      case Refusal::kOtherEpoch:
        return "<other epoch>";
      case Refusal::kUnchecked:
        return "<unchecked>";
    }
    return "";
  }
  // Lets the two hear each other's announcements until nothing more is due at once.
  void meet(Sealer& one, Sealer& other) {
    for (int i = 0; i < 4; ++i) {
      if (const auto due = one.announcement_due(now)) (void)other.hear(*due, now);
      if (const auto due = other.announcement_due(now)) (void)one.hear(*due, now);
      now += milliseconds(25);
    }
  }

  const keys::SymmetricKey key = keys::SymmetricKey::random();
  std::map<std::uint32_t, keys::Identity> identities;
  HostTime now{seconds(100)};
  Sealer a = make(key, 1), b = make(key, 2);
};

TEST_F(Sealing, WhatOneSealsTheOtherOpens) {
  meet(a, b);
  EXPECT_EQ(opened(b, sealed(a, "hello")), "hello");
  EXPECT_EQ(opened(a, sealed(b, "")), "");
  EXPECT_EQ(opened(b, sealed(a, std::string(1200, 'x'))), std::string(1200, 'x'));
  EXPECT_EQ(sealed(a, "hello").size(), 5 + Sealer::kAdded_bytes);
  EXPECT_LE(Sealer::kAdded_bytes, 24u);
  EXPECT_EQ(a.proven_count(), 1u);
}

TEST_F(Sealing, NothingOfItCanBeReadOnTheWay) {
  EXPECT_EQ(text(sealed(a, "a secret")).find("secret"), std::string::npos);
  EXPECT_NE(text(sealed(a, "a secret")).substr(8), text(sealed(a, "a secret")).substr(8)) << "nor that it is the same";
}

// The first announcement of each names nobody. The answer to it proves its sender.
TEST_F(Sealing, ThreeAnnouncementsProveBoth) {
  const auto first = must(a.announcement_due(now));
  EXPECT_EQ(a.announcement_due(now), std::nullopt) << "one at a time";
  const Bytes early = sealed(a, "early");
  ASSERT_EQ(b.hear(first, now), std::nullopt);
  EXPECT_EQ(opened(b, early), "<unproven>") << "it may be a record";
  const auto answer = must(b.announcement_due(now));
  ASSERT_EQ(a.hear(answer, now), std::nullopt);
  EXPECT_EQ(opened(a, sealed(b, "by b")), "by b");
  EXPECT_EQ(a.announcement_due(now), std::nullopt) << "announcements are 20 ms apart";
  now += milliseconds(20);
  const auto proof = must(a.announcement_due(now));
  ASSERT_EQ(b.hear(proof, now), std::nullopt);
  EXPECT_EQ(opened(b, sealed(a, "by a")), "by a");
  now += milliseconds(25);
  EXPECT_EQ(b.announcement_due(now), std::nullopt) << "both know";
}

// Each announcement may get lost.
TEST_F(Sealing, LostAnnouncementsAreMadeUpFor) {
  std::mt19937 random(5);
  for (int round = 0; round < 50; ++round) {
    Sealer one = make(key, 1), other = make(key, 2);
    const HostTime begin = now;
    while (one.proven_count() + other.proven_count() < 2) {
      ASSERT_LT(now - begin, seconds(20));
      if (const auto due = one.announcement_due(now); due && random() % 2 == 0) (void)other.hear(*due, now);
      if (const auto due = other.announcement_due(now); due && random() % 2 == 0) (void)one.hear(*due, now);
      now += milliseconds(10);
    }
  }
}

// The one hears the other, and is not heard.
TEST_F(Sealing, APeerThatNamesOthersOnlyIsDeaf) {
  const auto hear_for = [&](milliseconds time, bool both) {
    for (const HostTime end = now + time; now < end; now += milliseconds(50)) {
      if (const auto due = a.announcement_due(now)) (void)b.hear(*due, now);
      if (const auto due = b.announcement_due(now); due && both) (void)a.hear(*due, now);
    }
  };
  hear_for(milliseconds(1750), false);
  EXPECT_TRUE(b.deaf_peers(now - milliseconds(1)).empty()) << "it is new";
  EXPECT_EQ(b.deaf_peers(now), std::vector{PeerId{1}});
  EXPECT_TRUE(a.deaf_peers(now).empty()) << "it has heard of nobody";
  hear_for(seconds(2), true);
  EXPECT_TRUE(b.deaf_peers(now).empty());
  now += seconds(60);
  EXPECT_TRUE(b.deaf_peers(now).empty()) << "it was proven, and its datagrams say the rest";
}

TEST_F(Sealing, ADeafPeerThatHasGoneIsNoneAnyMore) {
  for (int i = 0; i < 3; ++i, now += seconds(1)) (void)b.hear(must(a.announcement_due(now)), now);
  EXPECT_EQ(b.deaf_peers(now), std::vector{PeerId{1}});
  now += seconds(4);
  EXPECT_TRUE(b.deaf_peers(now).empty());
}

TEST_F(Sealing, NoFlippedByteAndNoPartOfADatagramIsOpened) {
  meet(a, b);
  const Bytes good = sealed(a, "twenty bytes of text");
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      Bytes bad = good;
      bad[at] ^= std::byte{1} << bit;
      ASSERT_EQ(opened(b, bad).front(), '<') << at << ' ' << bit;
    }
  }
  for (std::size_t size = 0; size < good.size(); ++size) {
    ASSERT_EQ(opened(b, {good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size)}).front(), '<') << size;
  }
  Bytes longer = good;
  longer.push_back(std::byte{0});
  EXPECT_EQ(opened(b, longer), "<forged>");
  EXPECT_EQ(opened(b, good, kAll), "<forged>") << "of another region";
  EXPECT_EQ(opened(b, good), "twenty bytes of text") << "none of these has used it up";
}

TEST_F(Sealing, NoFlippedByteAndNoPartOfAnAnnouncementIsHeard) {
  const Bytes good = a.announcement_due(now).value();
  for (std::size_t at = 1; at < good.size(); ++at) {
    Bytes bad = good;
    bad[at] ^= std::byte{0x10};
    ASSERT_EQ(b.hear(bad, now), Refusal::kForged) << at;
  }
  Bytes of_another_epoch = good;
  of_another_epoch[0] ^= std::byte{1};
  EXPECT_EQ(b.hear(of_another_epoch, now), Refusal::kOtherEpoch);
  for (std::size_t size = 1; size < good.size(); ++size) {
    ASSERT_EQ(b.hear({good.data(), size}, now), Refusal::kForged) << size;
  }
  EXPECT_EQ(b.hear(good, now), std::nullopt);
}

TEST_F(Sealing, EachDatagramIsOpenedOnce) {
  meet(a, b);
  const Bytes one = sealed(a, "one"), two = sealed(a, "two");
  EXPECT_EQ(opened(b, two), "two");
  EXPECT_EQ(opened(b, one), "one") << "the other way round";
  EXPECT_EQ(opened(b, one), "<replayed>");
  EXPECT_EQ(opened(b, two), "<replayed>");
}

// Regions come by different sockets, and one of them may be read long after the other.
TEST_F(Sealing, RegionsOvertakeEachOther) {
  meet(a, b);
  const Bytes early = sealed(a, "early", kAll);
  for (int i = 0; i < 5000; ++i) ASSERT_EQ(opened(b, sealed(a, "here")), "here");
  EXPECT_EQ(opened(b, early, kAll), "early");
  EXPECT_EQ(opened(b, early, kAll), "<replayed>");
}

TEST_F(Sealing, AnotherKeyOpensNothing) {
  Sealer outsider = make(keys::SymmetricKey::random(), 2);
  const Bytes announcement = outsider.announcement_due(now).value();
  EXPECT_EQ(a.hear(announcement, now), Refusal::kForged);
  meet(a, b);
  EXPECT_EQ(opened(a, sealed(outsider, "hello")), "<forged>");
  EXPECT_EQ(opened(a, bytes("\x08\x09 an open datagram")), "<open>");
  EXPECT_EQ(opened(a, {}), "<open>");
}

// All that two peers said to each other, said once more to one that has started again, and to one that is new.
TEST_F(Sealing, ARecordOfASessionIsNotHeardInTheNextOne) {
  std::vector<Bytes> announcements;
  std::vector<Bytes> datagrams;
  for (int i = 0; i < 20; ++i) {
    if (auto due = a.announcement_due(now)) {
      (void)b.hear(*due, now);
      announcements.push_back(*std::move(due));
    }
    if (auto due = b.announcement_due(now)) {
      (void)a.hear(*due, now);
      announcements.push_back(*std::move(due));
    }
    datagrams.push_back(sealed(a, "by a"));
    now += milliseconds(300);
  }
  for (const std::uint32_t id : {2u, 3u}) {
    Sealer later = make(key, id);
    for (const Bytes& each : announcements) {
      if (id == 3u)
        EXPECT_EQ(later.hear(each, now), std::nullopt) << "they are of the session";
      else
        (void)later.hear(each, now);
    }
    for (const Bytes& each : datagrams) EXPECT_EQ(opened(later, each), "<unproven>");
  }
}

// The sender runs on. Nothing that it said before the newcomer came is new to it.
TEST_F(Sealing, ARecordOfThisSessionIsNotHeardByANewcomer) {
  meet(a, b);
  std::vector<Bytes> before;
  for (int i = 0; i < 50; ++i) before.push_back(sealed(a, "before"));
  Sealer c = make(key, 3);
  now += seconds(1);
  meet(a, c);
  for (const Bytes& each : before) EXPECT_EQ(opened(c, each), "<replayed>");
  EXPECT_EQ(opened(c, sealed(a, "now")), "now");
}

// The header has three bytes of the counter.
TEST_F(Sealing, CountersAreToldApartThoughTheirLastBytesAreAlike) {
  Sealer talks = make(key, 1);
  for (int i = 0; i < (1 << 24) - 3; ++i) (void)talks.seal(now, kAll, {}, false);
  meet(talks, b);
  for (int i = 0; i < 8; ++i) ASSERT_EQ(opened(b, sealed(talks, "over the end")), "over the end") << i;
  now += seconds(2);
  Sealer late = make(key, 4);
  meet(talks, late);
  EXPECT_EQ(opened(late, sealed(talks, "later")), "later");
}

TEST_F(Sealing, WhoStartsAgainIsHeardAndSoIsItsTwin) {
  meet(a, b);
  Sealer again = make(key, 1);  // of the same peer
  now += seconds(2);
  meet(again, b);
  EXPECT_EQ(opened(b, sealed(again, "again")), "again");
  EXPECT_EQ(opened(b, sealed(a, "before")), "before") << "which is what says that there are two";
  meet(again, a);
  EXPECT_EQ(opened(a, sealed(again, "a question")), "a question") << "of the same peer";
  EXPECT_EQ(opened(a, sealed(a, "an echo")), "<own>") << "no other boot of that peer has sent it";
}

TEST_F(Sealing, WhatComesBackIsOwn) {
  EXPECT_EQ(opened(a, sealed(a, "an echo")), "<own>");
  EXPECT_EQ(a.hear(a.announcement_due(now).value(), now), Refusal::kOwn);
}

TEST_F(Sealing, OfOnePeerTheBootsThatWereHeardOfLastAreOpened) {
  meet(a, b);
  for (std::size_t i = 0; i < Sealer::kBootsOfPeerMax; ++i) {
    Sealer again = make(key, 1);
    now += seconds(2);
    meet(again, b);
    EXPECT_EQ(opened(b, sealed(again, "again")), "again") << i;
  }
  EXPECT_EQ(opened(b, sealed(a, "at first")), "<forged>");
  now += seconds(2);
  EXPECT_EQ(b.hear(a.announcement_due(now).value(), now), Refusal::kTooMany) << "a record would begin anew";
}

// Somebody has recorded announcements of many starts of a peer, and says them again and again.
TEST_F(Sealing, RecordedAnnouncementsTakeNobodysPlaceAndBringFewAnswers) {
  std::vector<Bytes> recorded;
  for (int i = 0; i < 300; ++i) recorded.push_back(make(key, 1).announcement_due(now).value());
  now += seconds(100);
  meet(a, b);
  std::size_t answers = 0;
  for (int i = 0; i < 3000; ++i) {
    now += milliseconds(1);
    (void)b.hear(recorded[static_cast<std::size_t>(i) % recorded.size()], now);
    answers += b.announcement_due(now).has_value();
  }
  EXPECT_EQ(opened(b, sealed(a, "still here")), "still here");
  EXPECT_LE(answers, 40u) << "in three seconds";
  now += seconds(20);
  (void)b.announcement_due(now);
  EXPECT_EQ(b.heard_count(), 1u) << "what is silent and unproven is forgotten";
}

// Somebody says records of a peer's earlier starts all the time, to it and to the other, who waits for it.
TEST_F(Sealing, RecordsOfEarlierStartsKeepNobodyOut) {
  std::vector<Bytes> recorded;
  for (int i = 0; i < 300; ++i) recorded.push_back(make(key, 2).announcement_due(now).value());
  std::size_t said = 0;
  const auto flood = [&](Sealer& to) {
    for (int i = 0; i < 5; ++i) (void)to.hear(recorded[said++ % recorded.size()], now);
  };
  now += seconds(100);
  for (int ms = 0; ms < 12'000; ++ms, now += milliseconds(1)) {
    flood(a);
    (void)a.announcement_due(now);
  }
  for (int ms = 0; ms < 2'000; ++ms, now += milliseconds(1)) {
    flood(a), flood(b);
    const auto by_a = a.announcement_due(now), by_b = b.announcement_due(now);
    if (by_a) (void)b.hear(*by_a, now);
    if (by_b) (void)a.hear(*by_b, now);
  }
  EXPECT_EQ(opened(a, sealed(b, "hello")), "hello");
  EXPECT_EQ(opened(b, sealed(a, "hello")), "hello");
}

TEST_F(Sealing, AnnouncementsOfManyFitADatagramAndNameAllInTurns) {
  constexpr std::uint32_t kPeers = 300;
  std::vector<Sealer> peers;
  for (std::uint32_t i = 0; i < kPeers; ++i) {
    peers.push_back(make(key, 10 + i));
    (void)a.hear(peers.back().announcement_due(now).value(), now);
  }
  for (int i = 0; i < 3; ++i) {
    const Bytes announcement = a.announcement_due(now).value();
    EXPECT_LE(announcement.size(), kAnnouncementMax_bytes);
    for (Sealer& peer : peers) (void)peer.hear(announcement, now);
    now += seconds(1);
  }
  for (Sealer& peer : peers) EXPECT_EQ(opened(peer, sealed(a, "all")), "all");
}

TEST_F(Sealing, AnnouncementsComeOnceASecondWhereAllIsWell) {
  meet(a, b);
  int of_a = 0;
  for (int i = 0; i < 1000; ++i) {
    now += milliseconds(10);
    if (const auto due = a.announcement_due(now)) {
      ++of_a;
      (void)b.hear(*due, now);
    }
    if (const auto due = b.announcement_due(now)) (void)a.hear(*due, now);
  }
  EXPECT_GE(of_a, 10);
  EXPECT_LE(of_a, 12);
}

// Ten thousand starts, each of which is killed wherever it stands: it keeps nothing that the next one could repeat.
TEST_F(Sealing, NoKeyAndNonceComeTwice) {
  std::set<std::pair<std::string, std::uint64_t>> seen;  // what the key is derived from, and the nonce
  std::mt19937 random(1);
  for (int start = 0; start < 10000; ++start) {
    const BootId boot = Sealer::random_boot();
    Sealer peer(key, {.peer = PeerId{1}, .identity = identity(1), .boot = boot});
    const unsigned sends = random() % 5;
    for (unsigned i = 0; i < sends; ++i) {
      const RegionId region{static_cast<std::uint32_t>(random() % 3)};
      const auto out = peer.seal(now, region, {}, random() % 2 == 0);
      const auto* const counter = reinterpret_cast<const unsigned char*>(out.data()) + 5;
      const std::uint64_t nonce =
          (counter[0] | counter[1] << 8 | counter[2] << 16) + (std::uint64_t{region.value} << 32);
      EXPECT_TRUE(seen.emplace(std::string(boot.begin(), boot.end()), nonce).second);
    }
  }
}

// One member makes identities without end, each of which proves itself and falls silent.
class Newcomers : public Sealing {
 protected:
  // A new identity meets `a` from an address. Whether it is proven there.
  bool comes(std::uint32_t id, const boost::asio::ip::address& from) {
    Sealer one{key, {.peer = PeerId{id}, .identity = keys::Identity::random()}};
    const std::size_t before = a.bound_count();
    for (int i = 0; i < 3; ++i) {
      if (const auto due = a.announcement_due(now)) (void)one.hear(*due, now);
      if (const auto due = one.announcement_due(now)) (void)a.hear(*due, now, from);
      now += milliseconds(25);
    }
    return a.bound_count() > before;
  }
  const boost::asio::ip::address bad = boost::asio::ip::make_address("192.0.2.1");
  const boost::asio::ip::address good = boost::asio::ip::make_address("192.0.2.2");
};

TEST_F(Newcomers, AreForgottenWhereTheyWereHereForAMomentAlone) {
  std::size_t most = 0;
  for (std::uint32_t id = 1000; id < 4000; ++id) {
    (void)comes(id, bad);
    most = std::max(most, a.bound_count());
  }
  EXPECT_LT(most, 128 + 16 * 80) << "of the last 75 s";
  EXPECT_TRUE(comes(5000, good));
}

TEST_F(Newcomers, OfOneAddressLeaveRoomForThoseOfAnother) {
  for (std::uint32_t id = 1000; id < 1400; ++id) {
    Sealer one{key, {.peer = PeerId{id}, .identity = keys::Identity::random()}};
    (void)a.hear(must(one.announcement_due(now)), now, bad);
  }
  EXPECT_LE(a.heard_count(), 128u);
  EXPECT_FALSE(comes(2000, bad));
  EXPECT_TRUE(comes(2001, good));
}

TEST_F(Newcomers, ThatAreForgottenComeBackAndTheirRecordsDoNot) {
  meet(a, b);
  now += seconds(1);
  const auto record = must(b.announcement_due(now));
  ASSERT_EQ(a.hear(record, now), std::nullopt);
  EXPECT_EQ(a.bound_count(), 2u);
  for (int i = 0; i < 40; ++i) {
    now += seconds(1);
    (void)a.announcement_due(now);
  }
  EXPECT_EQ(a.bound_count(), 1u);
  EXPECT_EQ(a.hear(record, now), Refusal::kReplayed);
  meet(a, b);
  EXPECT_EQ(opened(a, sealed(b, "again")), "again");
  EXPECT_EQ(a.bound_count(), 2u);
}

}  // namespace
}  // namespace peerd::seal
