#include "replication/session/identity.hpp"

#include <gtest/gtest.h>

#include "replication/wire/codec.hpp"

namespace peerd::replication::identity_test {

Bytes answer_to(const IdentityQuestion& question) {
  auto m = decode(encode(question), SimTime{}).value();
  m.identity->answers = true;
  return encode(m);
}

TEST(Identity, AQuestionAsksForAnIdInAWorld) {
  const auto m = decode(encode(IdentityQuestion{PeerId{7}, 0xABCDEF01'23456789, 0x1234}), SimTime{}).value();
  EXPECT_EQ(m.sender, PeerId{7});
  EXPECT_EQ(m.number, 0u) << "nobody counts it";
  ASSERT_TRUE(m.identity);
  EXPECT_EQ(m.identity->asker, 0xABCDEF01'23456789);
  EXPECT_EQ(m.identity->world_hash, 0x1234u);
  EXPECT_FALSE(m.identity->answers);
}

// A datagram of the peer's last life, still under way, is no answer: it can't know who asks.
TEST(Identity, OnlyTheAnswerToThatQuestionCounts) {
  const IdentityQuestion question{PeerId{7}, 100, 5};
  EXPECT_TRUE(answers(answer_to(question), question));
  EXPECT_FALSE(answers(encode(question), question)) << "the question itself, by loopback";
  EXPECT_FALSE(answers(answer_to({PeerId{7}, 99, 5}), question)) << "another program's";
  EXPECT_FALSE(answers(answer_to({PeerId{8}, 100, 5}), question)) << "another peer's";
  EXPECT_FALSE(answers(answer_to({PeerId{7}, 100, 6}), question)) << "in another world";
  EXPECT_FALSE(answers({}, question));
}

}  // namespace peerd::replication::identity_test
