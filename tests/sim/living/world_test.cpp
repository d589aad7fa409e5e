// Worlds that live by themselves, by chance (world.hpp): each contact that `peerd collide` finds is found by every
// peer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <iostream>

#include "core/scene/reader.hpp"
#include "tests/sim/living/run.hpp"

namespace peerd::living::world_test {

using testing_support::ScratchFolder;

// What is outside of VRML97's ranges and means what it says.
constexpr const char* kMirrored = "a scale of 0 or less is outside VRML97; it is applied as written";

// Peers leave out what moves below what moves, nested interests and what bends. Once they take part, this is true.
constexpr bool kPeersTakePart = false;

std::string where(const World& world) {
  const char* const folder = std::getenv("PEERD_LIVING_TEXTS");
  std::string text = "seed " + std::to_string(world.seed);
  if (folder == nullptr) return text + "; PEERD_LIVING_TEXTS names a folder for its text";
  const std::filesystem::path path = std::filesystem::path(folder) / ("living-" + std::to_string(world.seed));
  std::filesystem::create_directories(path);
  std::ofstream(path / "living.wrl") << vrml_of(world);
  std::ofstream(path / "living.toml") << scenario_of(world);
  return text + "; " + path.string();
}

void expect_found(std::uint64_t seed, const ScratchFolder& folder) {
  const World world = make_world(seed);
  const Reference reference = reference_of(world);
  EXPECT_THAT(reference.problems, testing::Each(testing::HasSubstr(kMirrored))) << where(world);
  const Comparison comparison = compare(world, reference, run_peers(world, folder));
  for (const Missing& missing : comparison.missing) {
    ADD_FAILURE() << text_of(world, reference, missing) << '\n' << where(world);
  }
}

class LivingWorlds : public testing::TestWithParam<int> {};
TEST_P(LivingWorlds, AreReadAsTheyAreMeant) {
  const World world = make_world(std::uint64_t(GetParam()));
  const std::string text = vrml_of(world);
  EXPECT_EQ(text, vrml_of(make_world(world.seed)));
  const ReadResult read = read_world(text);
  for (const Diagnostic& problem : read.diagnostics) EXPECT_THAT(problem.message, testing::HasSubstr(kMirrored));
  ASSERT_TRUE(read.scene) << where(world);
  const Scene& scene = *read.scene;
  std::size_t interests = 0;
  for (const Interest& interest : world.interests) {
    const CollisionInterest& there = scene.interests.at(interests++);
    EXPECT_EQ(there.collider, scene.find(path_of(world, interest.collider)));
    EXPECT_EQ(there.collidees.size(), interest.collidees.size());
  }
  EXPECT_EQ(interests, scene.interests.size());
  // A node of the world and the instance that its path names are one: same kind, same parent, same place.
  for (int i = 0; i < int(world.nodes.size()); ++i) {
    const Node& node = world.nodes[std::size_t(i)];
    const auto object = scene.find(path_of(world, i));
    ASSERT_TRUE(object) << path_of(world, i);
    EXPECT_EQ(scene.at(*object).parent < 0, node.parent < 0);
    if (node.parent >= 0) {
      EXPECT_EQ(scene.find(path_of(world, node.parent))->value, std::uint32_t(scene.at(*object).parent));
    }
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(scene.transform(*object).scale[k], double(node.scale[std::size_t(k)]));
      EXPECT_EQ(scene.object(*object).velocity[k], double(node.velocity[std::size_t(k)]));
    }
  }
}
TEST_P(LivingWorlds, AreFoundByEveryPeer) {
  if (!kPeersTakePart && std::getenv("PEERD_LIVING_PEERS") == nullptr) {
    GTEST_SKIP() << "peers leave out what moves below what moves; PEERD_LIVING_PEERS compares all the same";
  }
  expect_found(std::uint64_t(GetParam()), ScratchFolder());
}
INSTANTIATE_TEST_SUITE_P(Dozen, LivingWorlds, testing::Range(0, 12));

TEST(LivingWorld, IsFoundForAsManySeedsAsAreAskedFor) {
  const char* const first = std::getenv("PEERD_LIVING_FROM");
  const char* const count = std::getenv("PEERD_LIVING");
  if (count == nullptr) GTEST_SKIP() << "PEERD_LIVING says how many, PEERD_LIVING_FROM from which seed on";
  const std::uint64_t begin = first != nullptr ? std::strtoull(first, nullptr, 10) : 0;
  for (std::uint64_t seed = begin; seed < begin + std::strtoull(count, nullptr, 10); ++seed) {
    expect_found(seed, ScratchFolder());
  }
}

}  // namespace peerd::living::world_test
