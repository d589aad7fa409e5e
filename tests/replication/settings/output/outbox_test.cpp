#include "replication/settings/output/outbox.hpp"

#include <gtest/gtest.h>

#include "tests/replication/peer/parts.hpp"

namespace peerd::replication::outbox_test {

using namespace test;

struct Box {
  PeerCounters counters;
  Outbox outbox{PeerId{3}, 0x12345678, counters};
};

UpdateRecord update_of(std::uint32_t object, SimTime at) {
  return {ObjectId{object}, 1, at, moving({1, 2, 3}, {4, 5, 6})};
}

TEST(Outbox, GivesOutputsInTheOrderOfTheirMaking) {
  Box box;
  EXPECT_FALSE(box.outbox.poll());
  for (int round = 0; round < 2; ++round) {
    box.outbox.push(Join{RegionId{1}});
    Message m = box.outbox.blank();
    box.outbox.send(m);
    box.outbox.push(Leave{RegionId{2}});
    EXPECT_TRUE(std::holds_alternative<Join>(*box.outbox.poll()));
    EXPECT_TRUE(std::holds_alternative<Send>(*box.outbox.poll()));
    box.outbox.push(IdInUse{PeerId{3}, true, false});  // while it is being emptied
    EXPECT_TRUE(std::holds_alternative<Leave>(*box.outbox.poll()));
    EXPECT_TRUE(std::holds_alternative<IdInUse>(*box.outbox.poll()));
    EXPECT_FALSE(box.outbox.poll());
    EXPECT_FALSE(box.outbox.poll());
  }
}

TEST(Outbox, NumbersEachRegionsDatagramsFromOne) {
  Box box;
  EXPECT_EQ(box.outbox.last_number(), 0u);
  for (const auto& [region, number] : {std::pair(0u, 1u), {0u, 2u}, {7u, 1u}, {0u, 3u}, {7u, 2u}}) {
    Message m = box.outbox.blank();
    EXPECT_EQ(box.outbox.send(m, RegionId{region}), number);
    EXPECT_EQ(m.number, number);
    EXPECT_EQ(box.outbox.last_number(RegionId{region}), number);
  }
  EXPECT_EQ(box.outbox.last_number(RegionId{8}), 0u);
  const auto messages = drain_messages(box.outbox, sim(0s));
  ASSERT_EQ(messages.size(), 5u);
  EXPECT_EQ(messages[2].first, RegionId{7});
  EXPECT_EQ(messages[3].second.number, 3u);
}

TEST(Outbox, ABlankMessageNamesThisPeerAlone) {
  Box box;
  Message m = box.outbox.blank();
  EXPECT_EQ(m.sender, PeerId{3});
  EXPECT_EQ(m.incarnation, 0x12345678u);
  box.outbox.send(m);
  const auto messages = drain_messages(box.outbox, sim(0s));
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].second.sender, PeerId{3});
  EXPECT_EQ(messages[0].second.incarnation, incarnation_low(0x12345678)) << "it introduces nobody";
  EXPECT_FALSE(messages[0].second.hello);
}

TEST(Outbox, EncodedUpdatesGoInPlaceOfTheMessagesOwn) {
  Box box;
  Message m = box.outbox.blank();
  m.updates.push_back(update_of(1, sim(1s)));
  std::vector<EncodedUpdate> encoded;
  for (const std::uint32_t object : {5u, 6u}) encoded.emplace_back(update_of(object, sim(1s)), sim(1s));
  box.outbox.send(m, kWholeScene, encoded);
  const auto messages = drain_messages(box.outbox, sim(1s));
  ASSERT_EQ(messages.size(), 1u);
  ASSERT_EQ(messages[0].second.updates.size(), 2u);
  EXPECT_EQ(messages[0].second.updates[0].object, ObjectId{5});
  EXPECT_EQ(messages[0].second.updates[1].object, ObjectId{6});
  EXPECT_EQ(messages[0].second.updates[1].at, sim(1s));
}

TEST(Outbox, CountsDatagramsAndBytesInAllAndByRegion) {
  Box box;
  Message small = box.outbox.blank(), large = box.outbox.blank();
  large.leaving = true;
  box.outbox.send(small);
  box.outbox.send(large, RegionId{4});
  const auto sent = drain<Send>(box.outbox);
  ASSERT_EQ(sent.size(), 2u);
  ASSERT_LT(sent[0].datagram.size(), sent[1].datagram.size());
  EXPECT_EQ(box.counters.datagrams_out, 2u);
  EXPECT_EQ(box.counters.bytes_out, sent[0].datagram.size() + sent[1].datagram.size());
  EXPECT_EQ(box.counters.regions[RegionId{4}].datagrams_out, 1u);
  EXPECT_EQ(box.counters.regions[RegionId{4}].bytes_out, sent[1].datagram.size());
  EXPECT_EQ(box.counters.regions[kWholeScene].bytes_out, sent[0].datagram.size());
}

TEST(Outbox, SpendsTheBudgetOfBytes) {
  Box box;
  PublishPolicy policy;
  policy.bytes_per_s = 1e5;
  const double full = box.outbox.bytes().left(policy, sim(0s));
  Message m = box.outbox.blank();
  m.leaving = true;
  const std::vector<EncodedUpdate> updates{EncodedUpdate(update_of(1, sim(0s)), sim(0s))};
  box.outbox.send(m, kWholeScene, updates);
  const double size = static_cast<double>(drain<Send>(box.outbox).at(0).datagram.size());
  EXPECT_EQ(box.outbox.bytes().left(policy, sim(0s)), full - size);
}

TEST(Outbox, UsesTheMemoryOfDatagramsThatWereSent) {
  Box box;
  Bytes memory;
  memory.reserve(kDatagramMax_bytes);
  const std::byte* const at = memory.data();
  box.outbox.reuse(std::move(memory));
  Message m = box.outbox.blank();
  box.outbox.send(m);
  box.outbox.send(m);
  const auto sent = drain<Send>(box.outbox);
  EXPECT_EQ(sent[0].datagram.data(), at);
  EXPECT_NE(sent[1].datagram.data(), at);
  m.number = 1;
  EXPECT_EQ(sent[0].datagram, encode(m)) << "nothing of the former datagram is left";
}

}  // namespace peerd::replication::outbox_test
