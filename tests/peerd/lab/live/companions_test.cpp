#include "peerd/lab/live/companions.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::companions_test {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

struct CompanionsTest : testing::Test {
  CompanionsTest() {
    for (const char* name : {"a", "b", "c"}) run.peers.emplace_back().name = name;
    islands = {.stem = folder / "run-001", .port = 20'000};
  }
  [[nodiscard]] std::string configuration(const std::string& peer) const {
    return testing_support::text_of(folder / ("run-001." + peer + ".nats.conf"));
  }
  testing_support::ScratchFolder folder;
  Islands islands;
  config::RunSettings run;
};

TEST_F(CompanionsTest, TheNetworkItselfHasNone) {
  EXPECT_TRUE(must(companions_of(run, islands)).empty());
  EXPECT_TRUE(settings_by_companions(run, islands, 0).empty());
}

TEST_F(CompanionsTest, LeafNodesJoinTheFirstServer) {
  run.via = config::Via::kNats;
  const auto companions = must(companions_of(run, islands));
  ASSERT_EQ(companions.size(), 3u);
  EXPECT_EQ(companions[2].peer, 2u);
  EXPECT_EQ(companions[2].name, "c.nats");
  EXPECT_EQ(companions[2].command.front(), "nats-server");
  EXPECT_THAT(configuration("a"),
              AllOf(HasSubstr("listen: \"127.0.0.1:20100\""), HasSubstr("leafnodes { listen: \"0.0.0.0:20200\" }"),
                    Not(HasSubstr("remotes"))));
  EXPECT_THAT(configuration("c"),
              AllOf(HasSubstr("listen: \"127.0.0.1:20102\""), HasSubstr("nats-leaf://127.0.0.1:20200")));
  EXPECT_THAT(settings_by_companions(run, islands, 1), ElementsAre("transport.nats=[\"nats://127.0.0.1:20101\"]"));
}

// All have the same ports where each island is a computer.
TEST_F(CompanionsTest, ApartTheyJoinByAddress) {
  run.via = config::Via::kNats;
  islands.apart = true;
  ASSERT_TRUE(companions_of(run, islands));
  EXPECT_THAT(configuration("c"),
              AllOf(HasSubstr("listen: \"127.0.0.1:20100\""), HasSubstr("nats-leaf://10.83.0.1:20200")));
  EXPECT_THAT(settings_by_companions(run, islands, 2), ElementsAre("transport.nats=[\"nats://127.0.0.1:20100\"]"));
}

// Two that join each other at once close each other's connection as a duplicate, over and over where it takes long.
TEST_F(CompanionsTest, InAClusterOneOfEachTwoJoinsTheOther) {
  run.via = config::Via::kNatsCluster;
  ASSERT_TRUE(companions_of(run, islands));
  EXPECT_THAT(configuration("a"), AllOf(HasSubstr("listen: \"0.0.0.0:20200\""), Not(HasSubstr("nats-route"))));
  EXPECT_THAT(configuration("b"),
              AllOf(HasSubstr("listen: \"0.0.0.0:20201\""), HasSubstr("nats-route://127.0.0.1:20200"),
                    Not(HasSubstr("nats-route://127.0.0.1:20202")), Not(HasSubstr("leafnodes"))));
  EXPECT_THAT(configuration("c"),
              AllOf(HasSubstr("nats-route://127.0.0.1:20200"), HasSubstr("nats-route://127.0.0.1:20201")));
}

TEST_F(CompanionsTest, AFolderThatIsNotThereIsAnError) {
  run.via = config::Via::kNats;
  islands.stem = folder / "missing/run-001";
  EXPECT_EQ(error_of(companions_of(run, islands)).exit_code, 3);
}

// Each island is lo; on one computer each has a port of its own there.
TEST_F(CompanionsTest, RelaysAreBelowTheFirst) {
  run.via = config::Via::kRelay;
  islands.program = "/bin/peerd";
  islands.key_file = "session.key";
  for (const bool apart : {false, true}) {
    islands.apart = apart;
    const auto companions = must(companions_of(run, islands));
    ASSERT_EQ(companions.size(), 3u);
    const auto& first = companions.front().command;
    const auto& last = companions.back().command;
    EXPECT_THAT(first, Not(testing::Contains("--parent")));
    EXPECT_EQ(first.front(), "/bin/peerd");
    EXPECT_EQ(companions.back().name, "c.relay");
    EXPECT_THAT(last, testing::Contains(apart ? "10.83.0.1:20100" : "127.0.0.1:20100"));
    EXPECT_THAT(last, testing::Contains(apart ? "20200" : "20202"));
    EXPECT_THAT(settings_by_companions(run, islands, 2),
                ElementsAre(apart ? "transport.port=20200" : "transport.port=20202"));
  }
}

}  // namespace peerd::companions_test
