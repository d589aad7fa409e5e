#include "peerd/peer/node/peer_node.hpp"

#include <gtest/gtest.h>

#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::peer_node_test {

using namespace std::chrono_literals;

// A peer that is suspended during the start must begin its motions when it resumes.
TEST(PeerNode, APeerSuspendedDuringTheStartBeginsWhenItResumes) {
  const testing_support::ScratchFolder folder;
  folder.write("w.wrl",
               "#VRML V2.0 utf8\nDEF A Transform { velocityVector 2 0 0 children Shape { geometry Box { } } }\n");
  const auto shared = must(share_world(folder / "w.wrl"));
  const config::PeerSettings settings{.name = "a", .id = 1};
  config::PeerObjects objects;
  objects.owned = {*shared->world.scene.find("A")};
  PeerNode::Options options;
  options.start_lead = 4s;
  const auto made = PeerNode::make(settings, {}, *shared, std::move(objects), options);
  PeerNode& node = *made;
  const auto run = [&](HostTime from, HostTime until) {
    for (HostTime now = from; now < until; now += 10ms) {
      node.on_tick(now);
      while (node.poll_output()) {
      }
    }
  };
  const HostTime begin{1000s};
  run(begin, begin + 2s);
  ASSERT_TRUE(node.start().has_value());
  const SimTime woken = node.peer().clock().to_session(begin + 12s);
  ASSERT_LT(*node.start(), woken);
  run(begin + 12s, begin + 14s);
  const ObjectId a = *shared->world.scene.find("A");
  const KinematicState s = node.peer().truth(a, woken + 1s);
  EXPECT_EQ(s.velocity.x(), 2.0);
  EXPECT_NEAR(s.position.x(), 2.0, 0.1);
}

// A peer without a part in any configuration begins nothing, unless it runs what the file gives to the founder.
TEST(PeerNode, AWatcherThatFoundsRunsWhatTheFileGivesToTheFounder) {
  for (const char* fields : {"", "enslaved TRUE"}) {
    const testing_support::ScratchFolder folder;
    folder.write("w.wrl", "#VRML V2.0 utf8\nDEF A Transform { velocityVector 2 0 0 " + std::string(fields) +
                              " children Shape { geometry Box { } } }\n");
    const auto shared = must(share_world(folder / "w.wrl"));
    config::RunSettings run;
    run.peers.emplace_back();
    run.peers[0].name = "a";
    run.peers[0].id = 1;
    PeerNode::Options options;
    options.late = options.watches = true;
    auto objects = must(config::resolve(run, shared->world.scene));
    const auto node = PeerNode::make(run.peers[0], {}, *shared, std::move(objects.front()), options);
    const HostTime begin{1000s};
    for (HostTime now = begin; now < begin + 5s; now += 10ms) {
      node->on_tick(now);
      while (node->poll_output()) {
      }
    }
    const bool founds = *fields != '\0';
    EXPECT_EQ(node->peer().owns_any(), founds);
    ASSERT_EQ(node->start().has_value(), founds);
    if (!founds) continue;
    const ObjectId a = *shared->world.scene.find("A");
    EXPECT_EQ(node->peer().truth(a, *node->start() + 1s).velocity.x(), 2.0);
  }
}

TEST(SharedWorld, NamesWhatTheWorldAsksForInVain) {
  const testing_support::ScratchFolder folder;
  std::string text = "#VRML V2.0 utf8\n";
  for (int i = 0; i < 25; ++i)
    text += "CollisionInterest { objectPath \"A" + std::to_string(i) + "\" interests [ ] }\n";
  for (int i = 0; i < 25; ++i) text += "DEF A" + std::to_string(i) + " Shape { geometry Box { } }\n";
  folder.write("v.wrl", text);
  const auto shared = must(share_world(folder / "v.wrl"));
  const std::vector<std::string> all = shared->findings();
  ASSERT_EQ(all.size(), 21u) << "the first twenty, and how many more there are";
  EXPECT_EQ(all[0], (folder / "v.wrl").string() + ":2:1: warning: this CollisionInterest has no interests");
  EXPECT_EQ(all[20], (folder / "v.wrl").string() + ": note: 5 more warnings; peerd check --json lists all");
}

}  // namespace peerd::peer_node_test
