#include "replication/objects/updates/update_repeater.hpp"

#include <gtest/gtest.h>

#include "replication/wire/wire_limits.hpp"
#include "tests/replication/peer/lan.hpp"
#include "tests/replication/peer/parts.hpp"

namespace peerd::replication::update_repeater_test {

using namespace test;

class Repeating : public testing::Test {
 protected:
  void update(ObjectId object, SimTime at = sim(10s)) {
    OwnObject& mine = own.at(object);
    mine.last_sent = at;
    const UpdateRecord record{object, ++mine.sequence, at, {}};
    repeater.on_update(object, mine, record);
    repeater.note_sent(record, ++number);
  }
  static std::vector<ObjectId> objects_of(const std::vector<EncodedUpdate>& updates) {
    std::vector<ObjectId> objects;
    for (const EncodedUpdate& u : updates) objects.push_back(u.record().object);
    return objects;
  }
  std::vector<ObjectId> copied() {
    std::vector<EncodedUpdate> copies;
    repeater.copy(copies);
    return objects_of(copies);
  }
  // The member's hello came that long after 10 s, of host and of session time alike.
  std::vector<ObjectId> repeated(Duration after) {
    std::vector<EncodedUpdate> due;
    repeater.repeat(host(10s) + after, sim(10s) + after, due);
    return objects_of(due);
  }
  Duration patience() const { return members.acknowledged_within(conf.settled_hello_period); }

  World world{field(2)};
  ObjectId a = world["O0"], b = world["O1"];
  PeerConfig conf = config(1);
  PeerCounters counters;
  Membership members{conf.lost_after};
  std::vector<OwnedObject> objects{{a}, {b}};
  OwnObjects own{*world.in_force, objects, false};
  UpdateRepeater repeater{conf, members, own, true, counters};
  std::uint32_t number = 0;
};

// ---- copies ----

TEST_F(Repeating, CopiesGoATickApartAsTheLossAsksFor) {
  conf.policy.copies = 3;
  echo_us(add_member(members, 2), 0.2);
  update(a);
  EXPECT_EQ(copied(), std::vector{a});
  EXPECT_EQ(copied(), std::vector{a});
  EXPECT_TRUE(copied().empty());
  EXPECT_EQ(counters.updates_repeated, 2u);
}

TEST_F(Repeating, AGoodLinkAsksForNoCopies) {
  conf.policy.copies = 3;
  echo_us(add_member(members, 2), 0.001);
  update(a);
  EXPECT_TRUE(copied().empty());
}

TEST_F(Repeating, ANewerUpdateTakesTheOldersPlace) {
  conf.policy.copies = 3;
  echo_us(add_member(members, 2), 0.2);
  update(a);
  EXPECT_EQ(copied(), std::vector{a});
  update(a);
  update(b);
  std::vector<EncodedUpdate> copies;
  repeater.copy(copies);
  ASSERT_EQ(objects_of(copies), (std::vector{a, b}));
  EXPECT_EQ(copies[0].record().sequence, 2u);
  EXPECT_EQ(copied(), (std::vector{a, b}));
  EXPECT_TRUE(copied().empty());
}

TEST_F(Repeating, WhatAReceiverDependsOnIsCopiedMoreOften) {
  echo_us(add_member(members, 2), 0.2);
  update(a);
  update(b);
  own.at(b).delivery.copy_until_received = true;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(copied(), std::vector{b}) << "four in all";
  EXPECT_TRUE(copied().empty());
}

TEST_F(Repeating, WhereLossBeginsEarlierUpdatesAreCopiedToo) {
  conf.policy.copies = 2;
  Member& two = add_member(members, 2);
  echo_us(two, 0.001);
  update(a);
  EXPECT_TRUE(copied().empty());
  echo_us(two, 0.2);
  EXPECT_EQ(copied(), std::vector{a}) << "b has never been published";
  EXPECT_TRUE(copied().empty());
}

TEST_F(Repeating, WhatAnotherPeerOwnsByNowIsNotCopied) {
  conf.policy.copies = 3;
  echo_us(add_member(members, 2), 0.2);
  update(a);
  own.remove(std::vector{a});
  EXPECT_TRUE(copied().empty());
}

// ---- acknowledgements ----

TEST_F(Repeating, AllHaveItOnceEveryMemberHas) {
  EXPECT_TRUE(repeater.is_acknowledged_by_all(own.at(a))) << "nobody else is here";
  add_member(members, 2);
  add_member(members, 3);
  own.at(a).delivery.acknowledged_by.insert(PeerId{2});
  EXPECT_FALSE(repeater.is_acknowledged_by_all(own.at(a)));
  own.at(a).delivery.acknowledged_by.insert(PeerId{3});
  EXPECT_TRUE(repeater.is_acknowledged_by_all(own.at(a)));
  update(a);
  EXPECT_FALSE(repeater.is_acknowledged_by_all(own.at(a))) << "that was the update before";
}

TEST_F(Repeating, RemembersWhoHadTimeToAcknowledgeAndHasNot) {
  add_member(members, 2);
  add_member(members, 3);
  update(a);
  own.at(a).delivery.acknowledged_by.insert(PeerId{2});
  repeater.before_update(own.at(a), sim(10s) + patience() - 1ns);
  EXPECT_TRUE(own.at(a).delivery.unacknowledged_by.empty()) << "there was no time";
  repeater.before_update(own.at(a), sim(10s) + patience());
  EXPECT_EQ(own.at(a).delivery.unacknowledged_by, (FewPeers{PeerId{3}}));
}

TEST_F(Repeating, NotesTheDatagramsOfTheLastUpdateAlone) {
  update(a);
  UpdateRecord old{a, 1, {}, {}};
  update(a);
  EXPECT_EQ(own.at(a).delivery.sent_in, std::vector{2u});
  repeater.note_sent(old, 3);
  EXPECT_EQ(own.at(a).delivery.sent_in, std::vector{2u});
  old.sequence = 2;
  repeater.note_sent(old, 4);
  EXPECT_EQ(own.at(a).delivery.sent_in, (std::vector{2u, 4u}));
}

// ---- with hellos ----

TEST_F(Repeating, AnUnacknowledgedUpdateIsRepeatedOnceItShouldHaveBeen) {
  echo_us(add_member(members, 2), 0.001);
  update(a);
  EXPECT_TRUE(repeated(patience() - 1ns).empty());
  EXPECT_EQ(repeated(patience()), std::vector{a});
  EXPECT_TRUE(repeated(3 * patience()).empty()) << "on such a link once is enough";
  EXPECT_EQ(counters.updates_repeated, 1u);
}

TEST_F(Repeating, AnAcknowledgedUpdateIsNot) {
  echo_us(add_member(members, 2), 0.001);
  update(a);
  own.at(a).delivery.acknowledged_by.insert(PeerId{2});
  EXPECT_TRUE(repeated(patience()).empty());
}

TEST_F(Repeating, WhereDatagramsGetLostTheNextHelloRepeats) {
  echo_us(add_member(members, 2), 0.2);
  update(a);
  EXPECT_EQ(repeated(1ms), std::vector{a});
  EXPECT_TRUE(repeated(2ms).empty()) << "the next time it waits for an answer";
  EXPECT_EQ(repeated(1ms + patience()), std::vector{a});
}

// The member has received this peer's datagrams 3 and 9, and surely not the one with the update.
TEST_F(Repeating, WhatAHelloSaysIsLostIsRepeatedAtOnce) {
  Member& two = add_member(members, 2);
  echo_us(two, 0.001, {3, 1, 1});
  number = 4;
  update(a);
  ASSERT_EQ(own.at(a).delivery.sent_in, std::vector{5u});
  EXPECT_TRUE(repeated(1ms).empty());
  echo_us(two, 0.001, {9, 4, ~std::uint64_t{0b10000}});
  EXPECT_EQ(repeated(2ms), std::vector{a});
}

TEST_F(Repeating, WhatGoesOutAnywayIsNotRepeated) {
  echo_us(add_member(members, 2), 0.2);
  update(a);
  update(b);
  std::vector<EncodedUpdate> due{EncodedUpdate(*own.at(a).delivery.record, sim(10s))};
  repeater.repeat(host(11s), sim(11s), due);
  EXPECT_EQ(objects_of(due), (std::vector{a, b}));
}

TEST_F(Repeating, WhatNobodyWouldTakeAnyMoreIsPublishedAnew) {
  echo_us(add_member(members, 2), 0.2);
  update(a);
  const Duration oldest = kUpdateAgeMax - members.longest_latency();
  own.check_from(0, SimTime::max());
  EXPECT_TRUE(repeated(oldest + 1ns).empty());
  EXPECT_TRUE(own.at(a).resend);
  EXPECT_EQ(own.next_to_check(0, sim(10s)), 0u);
  own.at(a).resend = false;
  EXPECT_EQ(repeated(oldest), std::vector{a});
  EXPECT_FALSE(own.at(a).resend);
}

// Updates to regions are not acknowledged: one that was not replaced for a second is repeated once.
TEST_F(Repeating, WithoutAcknowledgementsOnceAfterASecond) {
  UpdateRepeater unacknowledged{conf, members, own, false, counters};
  echo_us(add_member(members, 2), 0.001);
  update(a);
  std::vector<EncodedUpdate> due;
  unacknowledged.repeat(host(11s), sim(11s) - 1ns, due);
  EXPECT_TRUE(due.empty());
  unacknowledged.repeat(host(11s), sim(11s), due);
  EXPECT_EQ(objects_of(due), std::vector{a});
  due.clear();
  unacknowledged.repeat(host(13s), sim(13s), due);
  EXPECT_TRUE(due.empty());
}

}  // namespace peerd::replication::update_repeater_test
