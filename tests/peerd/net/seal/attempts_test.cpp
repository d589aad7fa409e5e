// Ten million attempts of somebody who hears all that is sealed, and has everything but the key.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "peerd/net/seal/sealer.hpp"

namespace peerd::seal::attempts_test {
namespace {

using Bytes = std::vector<std::byte>;

constexpr RegionId kAll{0};

// Two peers, what they have said, and what they said in a session before.
class Recorded {
 public:
  Recorded() {
    const keys::SymmetricKey key = keys::SymmetricKey::random();
    const Sealer::Self one{.peer = PeerId{1}, .identity = keys::Identity::random()};
    const Sealer::Self two{.peer = PeerId{2}, .identity = keys::Identity::random()};
    const auto again = [](Sealer::Self self) {
      self.boot = Sealer::random_boot();
      return self;
    };
    Sealer before_a(key, one), before_b(key, two);
    meet(before_a, before_b);
    for (int i = 0; i < 1000; ++i) earlier.push_back(copy_of(before_a.seal(now, kAll, datagram(i), i % 2 == 0)));
    a_.emplace(key, again(one));
    b.emplace(key, again(two));
    earlier_announcements = announcements;
    announcements.clear();
    meet(*a_, *b);
    for (int i = 0; i < 1000; ++i) {
      said.push_back(copy_of(a_->seal(now, kAll, datagram(i), i % 2 == 0)));
      EXPECT_TRUE(b->open(now, kAll, said.back()));
    }
  }

  std::vector<Bytes> earlier, said, announcements, earlier_announcements;
  std::optional<Sealer> b;
  HostTime now{std::chrono::seconds(1)};

 private:
  static Bytes copy_of(std::span<const std::byte> bytes) { return {bytes.begin(), bytes.end()}; }
  static Bytes datagram(int i) { return Bytes(static_cast<std::size_t>(20 + i % 200), static_cast<std::byte>(i)); }
  void meet(Sealer& one, Sealer& other) {
    for (int i = 0; i < 4; ++i) {
      for (const auto& [from, to] : {std::pair{&one, &other}, {&other, &one}}) {
        const auto due = from->announcement_due(now);
        if (!due) continue;
        EXPECT_FALSE(to->hear(*due, now));
        announcements.push_back(*due);
      }
      now += std::chrono::milliseconds(25);
    }
  }

  std::optional<Sealer> a_;
};

TEST(SealedSession, AcceptsNoneOfTenMillionAttempts) {
  Recorded recorded;
  Sealer& b = *recorded.b;
  for (const Bytes& each : recorded.earlier_announcements) (void)b.hear(each, recorded.now);  // as they were
  std::mt19937_64 random(11);
  const auto any_of = [&](const std::vector<Bytes>& all) { return all[random() % all.size()]; };
  std::uint64_t accepted = 0;
  for (int i = 0; i < 10'000'000; ++i) {
    Bytes attempt = any_of(random() % 4 == 0 ? recorded.earlier : recorded.said);
    switch (random() % 6) {
      case 0:
        break;  // said once more, in this session or a later one
      case 1:
        attempt[random() % attempt.size()] ^= std::byte{1} << random() % 8;
        break;
      case 2:
        attempt.resize(random() % attempt.size());
        break;
      case 3:
        attempt.front() = static_cast<std::byte>(0x80 + random() % 64);
        attempt.back() ^= std::byte{1};
        break;  // epochs
      case 4:
        attempt[5 + random() % 3] = static_cast<std::byte>(random());
        break;  // other counters
      default:
        for (std::size_t k = 0; k < 4; ++k)
          attempt[8 + random() % (attempt.size() - 8)] = static_cast<std::byte>(random());
        attempt.push_back(std::byte{0});
    }
    accepted += b.open(recorded.now, kAll, attempt).has_value();
  }
  EXPECT_EQ(accepted, 0u);
  std::uint64_t heard = 0;
  for (int i = 0; i < 100'000; ++i) {
    Bytes attempt = any_of(recorded.announcements);
    attempt[1 + random() % (attempt.size() - 1)] ^= std::byte{1} << random() % 8;
    heard += !b.hear(attempt, recorded.now);
  }
  EXPECT_EQ(heard, 0u);
}

}  // namespace
}  // namespace peerd::seal::attempts_test
