// What the world's file gives to the session's founder (`enslaved TRUE`): it runs it as what a configuration gives it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/peerd/scratch_folder.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::founder_test {

using peerd::testing_support::ScratchFolder;
using testing::Each;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing_support::Ran;
using testing_support::run_scenario;

// BALL flies to WALL at 1 m/s, touches it after 3 s, and comes back.
constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF BALL Transform {
  enslaved TRUE
  velocityVector 1 0 0
  collisionResponse CollisionResponse { }
  children Shape { geometry Box { size 1 1 1 } }
}
DEF WALL Transform { translation 4 0 0 children Shape { geometry Box { size 1 9 9 } } }
CollisionInterest { objectPath "BALL" interests "WALL" collisionType 1 }
)";

class Founder : public testing::Test {
 protected:
  Ran run(const std::string& peers) {
    folder.write("w.wrl", kWorld);
    const std::string text = "world = \"w.wrl\"\nduration_s = 6\n[network]\nlatency_ms = 50\n" + peers;
    return run_scenario(folder.write("s.toml", text)).front();
  }
  ScratchFolder folder;
};

// All owners of BALL that a peer has ever known.
std::vector<PeerId> owners(const PeerLog& log) {
  std::vector<PeerId> all;
  for (const PeerLog::ObjectSample& sample : log.object_samples) all.push_back(sample.owner);
  return all;
}
std::vector<std::string> kinds(const PeerLog& log) {
  std::vector<std::string> all;
  for (const PeerLog::Contact& contact : log.contacts) all.push_back(contact.kind);
  return all;
}

TEST_F(Founder, RunsTheObjectByPhysicsAndTheOthersPredictIt) {
  const Ran ran = run("[peer.a]\nid = 1\n[peer.b]\nid = 2\n");
  ASSERT_THAT(ran.logs, SizeIs(2));
  for (const PeerLog& log : ran.logs) {
    EXPECT_THAT(owners(log), SizeIs(testing::Ge(300u)));
    EXPECT_THAT(owners(log), Each(PeerId{1}));
  }
  EXPECT_THAT(kinds(ran.logs[0]), testing::ElementsAre("owner"));
  EXPECT_THAT(kinds(ran.logs[1]), testing::ElementsAre("predicted"));
  const PeerLog::ObjectSample& last = ran.logs[0].object_samples.back();
  EXPECT_EQ(last.state.velocity, Vec3(-1, 0, 0));
  EXPECT_EQ(ran.logs[1].object_samples.back().state.velocity, Vec3(-1, 0, 0));
}

TEST_F(Founder, ALateJoinerTakesNothingHoweverLowItsId) {
  const Ran ran = run("[peer.a]\nid = 1\n[peer.b]\nid = 2\n[event.late]\nat_s = 1\nkind = \"join\"\npeer = \"a\"\n");
  ASSERT_THAT(ran.logs, SizeIs(2));
  for (const PeerLog& log : ran.logs) {
    EXPECT_THAT(owners(log), Not(IsEmpty())) << log.name;
    EXPECT_THAT(owners(log), Each(PeerId{2})) << log.name;
  }
}

}  // namespace peerd::sim::founder_test
