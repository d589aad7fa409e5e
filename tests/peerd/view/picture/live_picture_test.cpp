#include "peerd/view/picture/live_picture.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "peerd/view/picture/gltf_writer.hpp"
#include "peerd/view/picture/scene_picture.hpp"
#include "tests/has_members.hpp"
#include "tests/must.hpp"
#include "tests/peerd/view/picture/glb_reader.hpp"
#include "tests/peerd/view/picture/two_peers.hpp"

namespace peerd::view::live_picture_test {

using peerd::testing_support::Glb;
using peerd::testing_support::read_glb;
using peerd::testing_support::TwoPeers;
using testing::ElementsAre;

const std::string kWorld = R"(
DEF A Transform { distanceThreshold 0.25 children DEF S Shape { geometry Box { } } }
DEF B Transform { translation 0 0 -10 children Shape { geometry Box { } } }
DEF C Transform { translation 9 0 0 children Shape { geometry Box { } } }
)";

config::RunSettings settings() {
  config::RunSettings run;
  testing_support::add_movers(run, {.x = "t"}, {.z = "-10"});
  return run;
}

std::vector<std::string> paths(const Glb& glb) {
  std::vector<std::string> out;
  for (const Glb::Node& node : glb.nodes) {
    if (node.parent < 0 && !node.json.at("extras").contains("static")) out.push_back(node.json.at("extras").at("path"));
  }
  return out;
}

TEST(LivePicture, ItsFileHasEverythingWhereThePeerHasIt) {
  TwoPeers peers(kWorld, settings());
  peers.run_until(2.0);
  LivePicture picture("w.wrl", {});
  ASSERT_TRUE(picture.follow(*peers.nodes[0]));
  EXPECT_FALSE(picture.follow(*peers.nodes[0]));
  const Glb glb = read_glb(must(write_glb(picture_of(picture.input(*peers.nodes[0], peers.now)))));
  EXPECT_THAT(glb.problems, ElementsAre());
  EXPECT_THAT(paths(glb), ElementsAre("A", "B"));
  EXPECT_NEAR(glb.nodes[0].world.translation().x(), 2.0, 0.1);
  EXPECT_EQ(glb.nodes[0].json.at("extras").at("owner"), 1);
  EXPECT_EQ(glb.nodes[1].json.at("extras").at("owner"), 2);
  EXPECT_EQ(glb.extras().at("revision"), 1);
}

TEST(LivePicture, AnEditOfTheSceneIsAnotherRevision) {
  TwoPeers peers(kWorld, settings());
  peers.run_until(1.0);
  PeerNode& node = *peers.nodes[0];
  LivePicture picture("w.wrl", {});
  ASSERT_TRUE(picture.follow(node));
  const config::SceneEdit edit{
      .kind = config::SceneEdit::Kind::kAdd,
      .text = "DEF NEW Transform { translation 0 5 0 children Shape { geometry Sphere { } } }"};
  ASSERT_TRUE(node.edit(peers.now, edit).done());
  peers.run_until(3.0);
  ASSERT_TRUE(picture.follow(node));
  EXPECT_EQ(picture.revision(), 2u);
  picture.refresh(node, peers.now, set_of(PoseKind::kShown));
  PoseStream stream;
  (void)stream.next(picture.poses());
  EXPECT_EQ(read_glb(must(write_glb(picture_of(picture.input(node, peers.now))))).meshes.size(), 2u);
  const auto hit = picture.pick(node, peers.now, Vec3(0, 5, 10), -Vec3::UnitZ());
  EXPECT_EQ(hit.at("hit").at("path"), "NEW");
}

// Somebody takes an object that nobody has moved so far: from now on it moves.
TEST(LivePicture, WhatBeginsToBeOwnedGetsANodeOfItsOwn) {
  TwoPeers peers(kWorld, settings());
  peers.run_until(1.0);
  LivePicture picture("w.wrl", {});
  ASSERT_TRUE(picture.follow(*peers.nodes[0]));
  EXPECT_EQ(picture.poses().node_count(), 2u);
  config::SceneEdit edit{.kind = config::SceneEdit::Kind::kOwn, .path = "C"};
  ASSERT_TRUE(peers.nodes[1]->edit(peers.now, edit).done());
  peers.run_until(3.0);
  ASSERT_TRUE(picture.follow(*peers.nodes[0]));
  EXPECT_EQ(picture.poses().node_count(), 3u);
  picture.refresh(*peers.nodes[0], peers.now, set_of(PoseKind::kShown));
  ASSERT_EQ(picture.poses().rows(PoseKind::kShown).size(), 3u);
  EXPECT_EQ(picture.poses().rows(PoseKind::kShown)[2].owner, 2u);
  edit.kind = config::SceneEdit::Kind::kRelease;
  ASSERT_TRUE(peers.nodes[1]->edit(peers.now, edit).done());
  peers.run_until(5.0);
  EXPECT_FALSE(picture.follow(*peers.nodes[0])) << "it keeps its node";
}

TEST(LivePicture, PicksWhatMovesWhereItIsShown) {
  TwoPeers peers(kWorld, settings());
  peers.run_until(4.0);
  LivePicture picture("w.wrl", {});
  ASSERT_TRUE(picture.follow(*peers.nodes[0]));
  const auto reply = picture.pick(*peers.nodes[0], peers.now, Vec3(4, 0, 10), -Vec3::UnitZ());
  ASSERT_TRUE(reply.at("hit").is_object()) << reply.dump();
  EXPECT_THAT(reply.at("hit"), HasMembers(R"({"node": 0, "path": "A", "owner": 1, "shape": {"path": "A/S"}})"));
  EXPECT_DOUBLE_EQ(reply.at("hit").at("distance_m"), 9.0);
  EXPECT_TRUE(picture.pick(*peers.nodes[0], peers.now, Vec3(0, 9, 10), -Vec3::UnitZ()).at("hit").is_null());
  EXPECT_EQ(picture.pick(*peers.nodes[0], peers.now, Vec3(0, 0, 0), Vec3::Zero()).at("ok"), false);
  EXPECT_EQ(picture.inspect(*peers.nodes[0], 0).at("path"), "A");
  EXPECT_EQ(picture.inspect(*peers.nodes[0], 7).at("ok"), false);
}

}  // namespace peerd::view::live_picture_test
