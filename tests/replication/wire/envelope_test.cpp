#include "replication/wire/envelope.hpp"

#include <gtest/gtest.h>

#include <random>

#include "replication/wire/codec.hpp"

namespace peerd::replication::envelope_test {
namespace {

Message of(std::uint32_t sender) {
  Message m;
  m.sender = PeerId{sender};
  m.incarnation = 5;
  m.number = 300;
  return m;
}
bool has_only_updates(const Message& m) {
  const auto envelope = envelope_of(encode(m));
  EXPECT_TRUE(envelope);
  EXPECT_EQ(envelope->sender, m.sender);
  return envelope->has_only_updates;
}

TEST(Envelope, SaysWhoseItIsAndWhetherItHasOnlyUpdates) {
  Message m = of(4'000'000'000);
  EXPECT_TRUE(has_only_updates(m)) << "nothing";
  m.updates.push_back({.object = ObjectId{7}, .sequence = 3, .at = SimTime{Duration{5}}, .model = {}});
  EXPECT_TRUE(has_only_updates(m));
}

TEST(Envelope, KnowsAllElse) {
  std::vector<Message> all(8, of(1));
  all[0].hello.emplace();
  all[1].decisions.emplace_back().normal = Vec3::UnitX();
  all[2].subscriptions.push_back({RegionId{1}, SimTime{}});
  all[3].handovers.push_back({ObjectId{1}, 1, RegionId{2}});
  all[4].leaving = true;
  all[5].operations.push_back({AuthorId{1}, 0, {std::byte{1}}});
  all[6].operation_requests.push_back({AuthorId{1}, 0, 5});
  all[7].identity = IdentityCheck{1, 2, true};
  for (const Message& m : all) EXPECT_FALSE(has_only_updates(m)) << &m - all.data();
}

// Whatever the reader of a datagram reads, this one has read the same sender of.
TEST(Envelope, AgreesWithTheReaderOnDamagedDatagrams) {
  std::mt19937 random(6);
  Message m = of(9);
  m.updates.push_back({.object = ObjectId{7}, .sequence = 3, .at = SimTime{Duration{5}}, .model = {}});
  const Bytes good = encode(m);
  int read = 0;
  for (int i = 0; i < 200'000; ++i) {
    Bytes bad = good;
    for (unsigned k = 1 + random() % 3; k > 0; --k) bad[random() % bad.size()] = static_cast<std::byte>(random());
    if (random() % 3 == 0) bad.insert(bad.end(), bad.begin(), bad.begin() + static_cast<std::ptrdiff_t>(random() % 9));
    const auto envelope = envelope_of(bad);
    const auto message = decode(bad, SimTime{});
    if (!message || !envelope) continue;
    ++read;
    ASSERT_EQ(envelope->sender, message->sender);
    const bool has_more = message->hello || !message->decisions.empty() || message->leaving || message->identity ||
                          !message->operations.empty() || !message->subscriptions.empty();
    ASSERT_FALSE(envelope->has_only_updates && has_more);
  }
  EXPECT_GT(read, 1000);
}

TEST(Envelope, OfWhatIsNoDatagramThereIsNone) {
  EXPECT_FALSE(envelope_of({}));
  const Bytes two_senders{std::byte{0x10}, std::byte{1}, std::byte{0x10}, std::byte{2}};
  EXPECT_FALSE(envelope_of(two_senders));
  const Bytes group{std::byte{0x10}, std::byte{1}, std::byte{0x0B}};
  EXPECT_FALSE(envelope_of(group));
}

}  // namespace
}  // namespace peerd::replication::envelope_test
