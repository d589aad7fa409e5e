// Scenes of lasting contacts by chance (lasting_scenes/scene.hpp): peers agree, ends are those of one owner, nothing is
// in anything, and neither momentum nor energy comes from nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>

#include "tests/peerd/scratch_folder.hpp"
#include "tests/sim/lasting_scenes/scene.hpp"

namespace peerd::sim::lasting_scenes_test {

using lasting_scenes::LastingScene;
using peerd::testing_support::ScratchFolder;

// Seeds that fail, and why.
constexpr const char* kJerk =
    "At each sample a driven body is ahead of its last law, inside what it pushes and does not bear.";
constexpr const char* kDrivenGhost =
    "A driven body's ghost is off by its rounding, and ghosts of what it bears or has struck are off or in it.";
constexpr const char* kLate =
    "A contact that began before another owner's update came is found a latency late, inside, and stays there.";
constexpr const char* kDigests = "Peers show an object at different places, for no known reason.";
constexpr const char* kStorm =
    "Contacts of a squeezed light body go on and on at one instant, up to the greatest number.";
constexpr const char* kChain =
    "The way of a blow by two owners is longer than one latency, and the overlap a little beyond its bound.";
constexpr const char* kTwoGhosts = "By dead reckoning alone, two ghosts are off by a threshold each.";
const std::map<std::uint64_t, const char*> kKnownFailing = {
    {53, kJerk},        {6, kDrivenGhost},   {49, kDrivenGhost},  {50, kDrivenGhost}, {81, kDrivenGhost},
    {88, kDrivenGhost}, {120, kDrivenGhost}, {156, kDrivenGhost}, {44, kLate},        {124, kLate},
    {177, kLate},       {186, kLate},        {5, kDigests},       {110, kDigests},    {54, kStorm},
    {65, kStorm},       {143, kStorm},       {170, kStorm},       {11, kChain},       {68, kChain},
    {112, kChain},      {118, kChain},       {119, kChain},       {185, kChain},      {190, kChain},
    {57, kTwoGhosts},   {193, kTwoGhosts},
};

void expect_no_faults(std::uint64_t seed, bool known_too) {
  if (!known_too && kKnownFailing.contains(seed)) return;
  const LastingScene scene = lasting_scenes::draw_scene(seed);
  const ScratchFolder scratch;
  std::string folder = scratch.path().string();
  const char* const kept = std::getenv("PEERD_SCENES_KEPT_IN");
  if (kept != nullptr) {
    folder = std::string(kept) + "/" + std::to_string(seed);
    std::filesystem::create_directories(folder);
  }
  EXPECT_THAT(lasting_scenes::faults_of(scene, folder, kept != nullptr), testing::IsEmpty())
      << "PEERD_SCENES_FROM=" << seed << " PEERD_SCENES=1 sim_test --gtest_filter=LastingScene.*\n"
      << scene.text();
}

// Ten scenes each.
class LastingScenes : public testing::TestWithParam<int> {};
TEST_P(LastingScenes, HoldTogether) {
  for (int i = 0; i < 10; ++i) expect_no_faults(static_cast<std::uint64_t>(10 * GetParam() + i), false);
}
INSTANTIATE_TEST_SUITE_P(Tens, LastingScenes, testing::Range(0, 20));

// A ball that a decision pressed against the wall of a tray fell through its floor.
TEST(LastingScene, WhatLiesInACornerStaysOnTheFloor) { expect_no_faults(254, true); }

// A peer that decided contacts with another one's lift at each tick made the lift's updates void, and rose 84 m with
// it.
TEST(LastingScene, ALiftGoesAsItsOwnerSays) { expect_no_faults(638, true); }

TEST(LastingScene, HoldsForAsManySeedsAsAreAskedFor) {
  const char* const first = std::getenv("PEERD_SCENES_FROM");
  const char* const count = std::getenv("PEERD_SCENES");
  if (count == nullptr) GTEST_SKIP() << "PEERD_SCENES says how many, PEERD_SCENES_FROM from which seed on";
  const std::uint64_t begin = first != nullptr ? std::strtoull(first, nullptr, 10) : 0;
  for (std::uint64_t seed = begin; seed < begin + std::strtoull(count, nullptr, 10); ++seed) {
    expect_no_faults(seed, true);
  }
}

}  // namespace peerd::sim::lasting_scenes_test
