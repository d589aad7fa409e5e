// The oracle says what is wrong where something is: a judge that never does would be of no use.
#include "peerd/lab/chaos/oracle.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "peerd/lab/chaos/world_text.hpp"
#include "peerd/peer/node/peer_node.hpp"

namespace peerd::chaos::oracle_test {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

class ChaosOracle : public testing::Test {
 protected:
  // Peers that are driven by nobody and never hear each other.
  std::unique_ptr<PeerNode> peer(std::uint32_t id) {
    const config::PeerSettings settings{.name = "p" + std::to_string(id), .id = id};
    PeerNode::Options options;
    options.rows = &oracle;
    return PeerNode::make(settings, {}, *shared, {}, options);
  }
  std::unique_ptr<const SharedWorld> shared = share(draw_world(1, 2));
  Oracle oracle{2, true};
};

TEST_F(ChaosOracle, PosesAreNumbers) {
  PeerLog log;
  log.peer = PeerId{4};
  PeerLog::ObjectSample sample{};
  oracle.add(log, sample);
  EXPECT_THAT(oracle.violations(), IsEmpty());
  sample.state.velocity.y() = std::numeric_limits<double>::quiet_NaN();
  oracle.add(log, sample);
  EXPECT_THAT(oracle.violations(), Contains(HasSubstr("peer 4 has object 0:0 at no number")));
}

TEST_F(ChaosOracle, AHeldOperationIsHeldByAnother) {
  const auto a = peer(1), b = peer(2);
  oracle.begin_life(0, *a);
  oracle.begin_life(1, *b);
  oracle.on_output(1.0, 0, replication::OperationHeld{{replication::AuthorId{5}, 3}});
  EXPECT_THAT(oracle.violations(),
              Contains(HasSubstr("operation 5:3 is said to be held, and no other peer ever had it")));
}

TEST_F(ChaosOracle, PeersThatDoNotKnowEachOtherAreNotOneWorld) {
  const auto a = peer(1), b = peer(2);
  oracle.begin_life(0, *a);
  EXPECT_TRUE(oracle.is_one_world()) << "alone";
  oracle.begin_life(1, *b);
  EXPECT_FALSE(oracle.is_one_world());
  oracle.finish(9.0);
  EXPECT_THAT(oracle.violations(), Contains(HasSubstr("peer 1 knows 0 other peers of 1")));
}

TEST_F(ChaosOracle, ALifeThatIsOverCountsNoMore) {
  const auto a = peer(1), b = peer(2);
  oracle.begin_life(0, *a);
  oracle.begin_life(1, *b);
  oracle.end_life(1);
  EXPECT_TRUE(oracle.is_one_world());
  oracle.finish(9.0);
  EXPECT_THAT(oracle.violations(), IsEmpty());
}

TEST_F(ChaosOracle, BranchesAreCounted) {
  const auto a = peer(1);
  oracle.begin_life(0, *a);
  oracle.on_output(1.0, 0, replication::HostSuspended{std::chrono::seconds(1)});
  oracle.count("mine", 3);
  EXPECT_EQ(oracle.branches().at("host suspended"), 1u);
  EXPECT_EQ(oracle.branches().at("mine"), 3u);
}

}  // namespace peerd::chaos::oracle_test
