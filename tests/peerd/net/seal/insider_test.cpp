// A member tries what it can do to others: it has the session's key, hears all, and follows docs/protocol.md where that
// serves it.
#include <gtest/gtest.h>
#include <sodium.h>

#include <algorithm>
#include <random>
#include <vector>

#include "peerd/net/seal/sealer.hpp"
#include "tests/must.hpp"

namespace peerd::seal::insider_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Bytes = std::vector<std::byte>;
using Kind = Sealer::Finding::Kind;

constexpr RegionId kHere{7};

void put(std::uint64_t number, std::size_t size, std::uint8_t* at) {
  for (std::size_t i = 0; i < size; ++i) at[i] = static_cast<std::uint8_t>(number >> (8 * i));
}

// A datagram as the peer's own process would seal it, but for a signature, which may be any.
struct Forger {
  keys::SymmetricKey session;
  keys::PublicKey victim;
  BootId boot;

  [[nodiscard]] Bytes datagram(std::uint32_t sender, std::uint64_t counter, std::size_t size, bool is_signed) const {
    std::array<std::uint8_t, 53> of{};
    put(sender, 4, of.data() + 1);
    std::ranges::copy(victim.bytes(), of.data() + 5);
    std::ranges::copy(boot, of.data() + 37);
    const keys::SymmetricKey key = session.derived("datagrams", of);
    Bytes sealed(8 + size + 16);
    auto* const out = reinterpret_cast<std::uint8_t*>(sealed.data());
    out[0] = is_signed ? 0xA0 : 0x80;
    put(sender, 4, out + 1);
    put(counter, 3, out + 5);
    std::array<std::uint8_t, 12> nonce{};
    put(kHere.value, 4, nonce.data());
    put(counter, 8, nonce.data() + 4);
    std::array<std::uint8_t, 12> associated{};
    std::copy_n(out, 8, associated.data());
    put(kHere.value, 4, associated.data() + 8);
    crypto_aead_chacha20poly1305_ietf_encrypt(out + 8, nullptr, out + 8, size, associated.data(), associated.size(),
                                              nullptr, nonce.data(), key.data());
    return sealed;
  }
};

// a talks to b at 20 Hz; the forger hears all of it.
class Insider : public testing::Test {
 protected:
  Insider() {
    for (int i = 0; i < 4; ++i) step();
    EXPECT_EQ(b.proven_count(), 1u);
  }
  // A twentieth of a second. Returns how many of a's datagrams b has taken.
  int step(bool b_hears_announcements = true, int datagrams = 1) {
    now += milliseconds(50);
    if (const auto due = a.announcement_due(now); due && b_hears_announcements) (void)b.hear(*due, now);
    if (const auto due = b.announcement_due(now)) (void)a.hear(*due, now);
    int taken = 0;
    for (int i = 0; i < datagrams; ++i) {
      const auto sealed = a.seal(now, kHere, Bytes(40), false);
      ++sent;
      const Bytes on_the_wire(sealed.begin(), sealed.end());
      (void)a.open(now, kHere, on_the_wire);  // multicast comes back
      taken += b.open(now, kHere, on_the_wire).has_value();
    }
    return taken;
  }
  [[nodiscard]] bool forge(std::uint64_t counter, bool is_signed = false) {
    return b.open(now, kHere, forger.datagram(1, counter, 104, is_signed)).has_value();
  }

  const keys::SymmetricKey key = keys::SymmetricKey::random();
  HostTime now{seconds(100)};
  std::uint64_t sent = 0;
  const keys::Identity of_a = keys::Identity::random();
  const BootId boot_of_a = Sealer::random_boot();
  Sealer a{key, {.peer = PeerId{1}, .identity = of_a, .boot = boot_of_a}};
  Sealer b{key, {.peer = PeerId{2}, .identity = keys::Identity::random()}};
  Forger forger{key, of_a.public_key(), boot_of_a};
};

TEST_F(Insider, ForgesNoSignedDatagram) {
  for (std::uint64_t i = 1; i <= 1000; ++i) EXPECT_FALSE(forge(sent + i, true));
  EXPECT_EQ(step(), 1) << "and takes no counter";
}

// One forged update, at the next counter or far ahead of it, is found within two seconds, and its sender signs from
// then on.
TEST_F(Insider, IsFoundWithinTwoSecondsOfSpeakingForAnother) {
  Duration quiet = seconds(0);
  for (const std::uint64_t ahead : {1u, 7u, 100u, 5000u, 1'000'000u}) {
    SCOPED_TRACE(ahead);
    std::vector<Sealer::Finding> findings;
    ASSERT_TRUE(forge(sent + ahead)) << "which nobody can tell by the datagram";
    const HostTime forged = now;
    while (findings.empty() && now < forged + seconds(5)) {
      step();
      findings = b.take_findings();
    }
    ASSERT_EQ(findings.size(), 1u);
    EXPECT_EQ(findings[0].kind, Kind::kImpersonated);
    EXPECT_EQ(findings[0].peer, PeerId{1});
    EXPECT_LE(now - forged, seconds(2));
    for (int i = 0; i < 40; ++i) step();
    EXPECT_TRUE(a.signs_all(now)) << "b has told it";
    const HostTime told = now;
    EXPECT_EQ(step(), 1) << "what it says is heard";
    for (std::uint64_t i = 1; i < 2000; ++i) EXPECT_FALSE(forge(sent + i)) << "and nobody else";
    while (a.signs_all(now) && now < told + std::chrono::hours(2)) EXPECT_EQ(step(), 1);
    EXPECT_GE(now - told, std::max(2 * quiet - seconds(5), Duration{seconds(55)})) << "longer each time";
    quiet = now - told;
    for (int i = 0; i < 20 * 5; ++i) EXPECT_EQ(step(), 1) << "and nothing is lost when that is over";
    (void)b.take_findings();
  }
}

// With a lossy link, and of many datagrams a second, of which a checkpoint has prints of some.
TEST_F(Insider, IsFoundOnALossyLinkAndAmongManyDatagrams) {
  std::mt19937 random(3);
  for (const int a_step : {1, 3, 30}) {
    Duration longest{0};
    for (int round = 0; round < 20; ++round) {
      a = Sealer{key, {.peer = PeerId{1}, .identity = of_a, .boot = boot_of_a}};
      b = Sealer{key, {.peer = PeerId{2}, .identity = keys::Identity::random()}};
      sent = 0;
      for (int i = 0; i < 40; ++i) step();
      ASSERT_EQ(step(), 1);
      std::vector<Sealer::Finding> findings;
      const HostTime begin = now;
      while (findings.empty() && now < begin + seconds(10)) {
        (void)forge(sent + 1 + random() % 3);
        (void)forge(sent + 5);
        step(random() % 10 != 0, a_step);
        findings = b.take_findings();
      }
      ASSERT_EQ(findings.size(), 1u);
      longest = std::max(longest, now - begin);
    }
    EXPECT_LE(longest, seconds(5)) << a_step << " datagrams in a twentieth of a second";
  }
}

TEST_F(Insider, IsFoundByThePeerInWhoseNameItSpeaks) {
  (void)a.open(now, kHere, forger.datagram(1, sent + 3, 104, false));
  ASSERT_TRUE(a.signs_all(now));
  EXPECT_EQ(only(a.take_findings()).peer, PeerId{1});
  step();
  EXPECT_FALSE(forge(sent + 1)) << "from the next announcement on";
}

// Nobody is suspected who loses datagrams, sends many or few, or whose datagrams overtake each other.
TEST_F(Insider, NobodyIsSuspectedWhoDoesNothing) {
  std::mt19937 random(4);
  for (int i = 0; i < 4000; ++i) {
    const bool is_busy = i / 500 % 2 == 1;
    std::vector<Bytes> late;
    now += milliseconds(50);
    for (const auto& [from, to] : {std::pair{&a, &b}, {&b, &a}}) {
      const auto due = from->announcement_due(now);
      if (due && random() % 10 != 0) (void)to->hear(*due, now);
    }
    for (unsigned k = 0; k < (is_busy ? random() % 80 : random() % 2); ++k) {
      const auto sealed = a.seal(now, kHere, Bytes(40), random() % 9 == 0);
      if (random() % 10 != 0) late.emplace_back(sealed.begin(), sealed.end());
    }
    std::ranges::shuffle(late, random);
    for (const Bytes& each : late) (void)b.open(now, kHere, each);
    ASSERT_TRUE(b.take_findings().empty() && a.take_findings().empty()) << i;
  }
}

// A peer that is gone says nothing of what was sent in its name: it is not believed for long.
TEST_F(Insider, SpeaksForNobodyWhoIsGone) {
  for (int i = 0; i < 20; ++i) step();
  now += milliseconds(4900);
  EXPECT_TRUE(forge(sent + 1));
  now += milliseconds(200);
  EXPECT_FALSE(forge(sent + 2));
}

// It announces itself with another's number, or with another's boot.
TEST_F(Insider, TakesNobodysNumber) {
  Sealer impostor(key, {.peer = PeerId{1}, .identity = keys::Identity::random()});
  EXPECT_EQ(b.hear(impostor.announcement_due(now).value(), now), Refusal::kImpostor);
  now += seconds(2);
  EXPECT_FALSE(impostor.hear(b.announcement_due(now).value(), now));
  EXPECT_EQ(only(impostor.take_findings()).kind, Kind::kNumberTaken) << "it is told";
  Sealer same_boot(key, {.peer = PeerId{1}, .identity = keys::Identity::random(), .boot = boot_of_a});
  EXPECT_EQ(b.hear(same_boot.announcement_due(now).value(), now), Refusal::kImpostor);
  step();
  EXPECT_EQ(step(), 1);
  EXPECT_EQ(b.key_of(PeerId{1}), of_a.public_key());
}

TEST_F(Insider, IsNotHeardWhereItsKeyIsNoMembers) {
  const keys::Identity known = keys::Identity::random(), unknown = keys::Identity::random();
  const auto is_member = [&](const keys::PublicKey& who) { return who == known.public_key(); };
  Sealer strict(key, {.peer = PeerId{3}, .identity = known}, is_member);
  Sealer good(key, {.peer = PeerId{4}, .identity = known}), bad(key, {.peer = PeerId{5}, .identity = unknown});
  EXPECT_EQ(strict.hear(good.announcement_due(now).value(), now), std::nullopt);
  EXPECT_EQ(strict.hear(bad.announcement_due(now).value(), now), Refusal::kNoMember);
  EXPECT_FALSE(bad.hear(strict.announcement_due(now).value(), now));
  EXPECT_EQ(only(bad.take_findings()).kind, Kind::kNoMember);
}

// An announcement that its sender has not signed: the forger seals what it likes.
TEST_F(Insider, AnnouncesNobodyElse) {
  Announcement says{.sender = PeerId{1}, .boot = boot_of_a, .number = 1'000'000, .key = of_a.public_key()};
  const Bytes forged = seal_announcement(says, 0xC0, announcing_key(key), keys::Identity::random());
  EXPECT_EQ(b.hear(forged, now), Refusal::kUnsigned);
  step();
  EXPECT_EQ(step(), 1);
  const Bytes of_another_session = seal_announcement(says, 0xC0, announcing_key(keys::SymmetricKey::random()), of_a);
  EXPECT_EQ(b.hear(of_another_session, now), Refusal::kForged);
}

}  // namespace
}  // namespace peerd::seal::insider_test
