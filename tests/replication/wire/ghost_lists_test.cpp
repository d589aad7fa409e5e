#include "replication/wire/ghost_lists.hpp"

#include <gtest/gtest.h>

#include "replication/wire/codec.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::ghost_lists_test {

using namespace test;

Message message() {
  Message m;
  m.sender = PeerId{7};
  m.incarnation = 100;
  return m;
}

TEST(GhostLists, ADigestTakesTwelveBytesOfADatagram) {
  Message with = message();
  with.ghosts = GhostDigest{sim(10'250ms), {1, 0, 0xFFFF, 300}};
  EXPECT_EQ(encode(with).size(), encode(message()).size() + 12u);
}

TEST(GhostLists, AllComesBackAsItWas) {
  Message m = message();
  m.ghosts = GhostDigest{sim(10'250ms), {1, 0, 0xFFFF, 300}};
  GhostQuestion& question = m.ghost_question.emplace(GhostQuestion{PeerId{9}, RegionId{70'000}, sim(9s), 3, {}});
  for (std::size_t k = 0; k < kGhostBuckets; ++k) question.buckets[k] = static_cast<std::uint16_t>(2'000 * k);
  const UpdateRecord state{ObjectId{3, 12}, 5, sim(9s), moving({1, 2, 3}, {0.1, 0, 0}), sim(8s)};
  m.ghost_answer.states = {state, state};
  m.ghost_reports = {{ObjectId{3}, 0.25f}, {ObjectId{4, 12}, 1e12f}};
  const auto back = decode(encode(m), sim(12s));
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->ghosts, m.ghosts);
  ASSERT_TRUE(back->ghost_question.has_value());
  EXPECT_EQ(back->ghost_question->owner, PeerId{9});
  EXPECT_EQ(back->ghost_question->region, RegionId{70'000});
  EXPECT_EQ(back->ghost_question->at, sim(9s));
  EXPECT_EQ(back->ghost_question->group, 3u);
  EXPECT_EQ(back->ghost_question->buckets, question.buckets);
  ASSERT_EQ(back->ghost_answer.states.size(), 2u);
  EXPECT_EQ(back->ghost_answer.states[1].object, state.object);
  EXPECT_EQ(back->ghost_answer.states[1].at, sim(9s));
  EXPECT_TRUE(same_bits(back->ghost_answer.states[1].model.state, state.model.state));
  ASSERT_EQ(back->ghost_reports.size(), 2u);
  EXPECT_EQ(back->ghost_reports[1].object, (ObjectId{4, 12}));
  EXPECT_EQ(back->ghost_reports[1].distance_m, 1e12f);
}

TEST(GhostLists, TheNearestInstantOfTheGridIsMeant) {
  const std::string bytes = packed(GhostDigest{sim(100s), {}});
  GhostDigest digest;
  for (const Duration near : {Duration(69s), Duration(100s), Duration(131s)}) {
    ASSERT_TRUE(take_ghosts(bytes, sim(near), digest));
    EXPECT_EQ(digest.at, sim(100s)) << near.count();
  }
  ASSERT_TRUE(take_ghosts(bytes, sim(-3600s), digest));
  EXPECT_LE(sim(-3600s) - digest.at, Duration(32s));
  EXPECT_GE(sim(-3600s) - digest.at, Duration(-32s));
}

TEST(GhostLists, NothingElseIsTaken) {
  GhostDigest digest;
  const std::string good = packed(GhostDigest{sim(1s), {1, 2, 3, 4}});
  EXPECT_FALSE(take_ghosts(good.substr(1), sim(1s), digest));
  EXPECT_FALSE(take_ghosts(good + "x", sim(1s), digest));
  GhostQuestion question;
  const std::string asked = packed(GhostQuestion{PeerId{9}, RegionId{0}, sim(1s), 1, {}});
  EXPECT_TRUE(take_ghosts(asked, sim(1s), question));
  EXPECT_FALSE(take_ghosts(asked + "x", sim(1s), question));
  std::string of_nobody = asked, of_no_group = asked;
  of_nobody[0] = 0;
  of_no_group[3] = static_cast<char>(kGhostGroups);
  EXPECT_FALSE(take_ghosts(of_nobody, sim(1s), question));
  EXPECT_FALSE(take_ghosts(of_no_group, sim(1s), question));
  std::vector<GhostReport> reports;
  std::string report = packed(std::vector<GhostReport>{{ObjectId{3}, 1.0f}});
  EXPECT_TRUE(take_ghosts(report, reports));
  report.back() = static_cast<char>(0xFF);  // negative
  reports.clear();
  EXPECT_FALSE(take_ghosts(report, reports));
  std::string many;
  for (std::size_t k = 0; k <= kGhostReportsMax; ++k) many += packed(std::vector<GhostReport>{{ObjectId{3}, 1.0f}});
  reports.clear();
  EXPECT_FALSE(take_ghosts(many, reports));
}

}  // namespace peerd::replication::ghost_lists_test
