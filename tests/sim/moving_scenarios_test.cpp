// The scenarios of many moving objects in short: crowd, traffic, flock and orbit of configs/scenarios.
#include <gtest/gtest.h>

#include <map>
#include <ranges>
#include <set>

#include "replication/wire/codec.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::moving_scenarios_test {

using testing_support::Ran;
using testing_support::run_scenario;

const std::string kScenarios = PEERD_SOURCE_DIR "/configs/scenarios/";
const std::vector<std::filesystem::path> kBest{PEERD_SOURCE_DIR "/configs/best.toml"};

Ran run_short(const std::string& name, std::vector<std::string> sets) {
  sets.insert(sets.end(), {"duration_s=8", "network.latency_ms=200", "network.loss=0.05"});
  auto runs = run_scenario(kScenarios + name + ".toml", sets, kBest);
  EXPECT_EQ(runs.size(), 1u);
  return std::move(runs.front());
}

class Traffic : public testing::TestWithParam<const char*> {};  // policies
TEST_P(Traffic, OneOutcomeEverywhere) {
  const Ran ran = run_short("traffic", {std::string("decisions.policy=") + GetParam()});
  testing_support::expect_one_outcome(ran, 5);
  EXPECT_EQ(ran.summary["collisions"]["missed"], 0);
}
// Contacts of an owner's own objects, which the other peers only predict, too. Updates go when they are due: if they
// went earlier, a box that grazes a car's edge would be predicted on its other side once.
TEST_P(Traffic, OwnersContactsArePredictedAsTheyAre) {
  const Ran ran =
      run_short("traffic", {std::string("decisions.policy=") + GetParam(), "replication.piggyback_fraction=1"});
  const auto& collisions = ran.summary["collisions"];
  EXPECT_GE(collisions["decided"], 5);
  EXPECT_EQ(collisions["agreed"], 2 * collisions["decided"].get<int>());
  EXPECT_EQ(collisions["disagreed"], 0);
  EXPECT_EQ(collisions["missed"], 0);
}
INSTANTIATE_TEST_SUITE_P(Policies, Traffic,
                         testing::Values("id", "velocity", "field-of-view", "expected-error", "server"),
                         [](const auto& c) {
                           std::string name = c.param;
                           std::erase(name, '-');
                           return name;
                         });

// Half of the bytes that they need make ghosts worse; no peer sends more, and outcomes stay the same.
TEST(ShortOfBytes, KeepsToItsBudgetAndToOneOutcome) {
  const auto most_bytes_per_s = [](const Ran& ran) {
    std::map<PeerId, double> sent;
    for (const measure::DatagramSent& each : ran.record.datagrams) sent[each.sender] += each.bytes / 8.0;
    return std::ranges::max(sent | std::views::values);
  };
  const Ran all = run_short("traffic", {"decisions.policy=id"});
  EXPECT_EQ(all.summary["counters"]["updates_withheld"], 0);
  const double half = 0.5 * most_bytes_per_s(all);
  const Ran ran = run_short("traffic", {"decisions.policy=id", "replication.bytes_per_s=" + std::to_string(half)});
  EXPECT_GT(ran.summary["counters"]["updates_withheld"], 100);
  // A budget begins with a datagram saved, and may end with one owed (ByteBudget).
  EXPECT_LE(most_bytes_per_s(ran), half + 2.0 * replication::kDatagramMax_bytes / 8.0);
  testing_support::expect_one_outcome(ran, 5);
}

struct Mover {
  const char* name;
  std::size_t objects, observers;  // observers of each object
  double way_m;                    // every object comes at least so far in 8 s ..
  double mean_error_m;             // greatest mean error [m] of any object, 200 ms away
};
class Movers : public testing::TestWithParam<Mover> {};
TEST_P(Movers, AreFollowed) {
  const Ran ran = run_short(GetParam().name, {});
  std::set<std::string> paths;
  for (const auto& o : ran.summary["objects"]) {
    paths.insert(o["path"].get<std::string>());
    EXPECT_LT(o["ghost_error_m"]["mean"].get<double>(), GetParam().mean_error_m) << o["path"];
  }
  EXPECT_EQ(paths.size(), GetParam().objects);
  EXPECT_EQ(ran.summary["objects"].size(), GetParam().objects * GetParam().observers);
  std::map<ObjectId, std::pair<Vec3, double>> ways;  // last place and distance covered
  for (const auto& b : ran.record.ghost_samples) {
    if (b.observer != PeerId{1} && b.observer != PeerId{2}) continue;
    const auto [way, first] = ways.try_emplace(b.object, b.truth.position, 0.0);
    if (!first) way->second.second += (b.truth.position - way->second.first).norm();
    way->second.first = b.truth.position;
  }
  for (const auto& [object, way] : ways) EXPECT_GT(way.second, GetParam().way_m) << object.number;
}
INSTANTIATE_TEST_SUITE_P(Table, Movers,
                         testing::Values(Mover{"crowd", 100, 2, 0.0, 0.1}, Mover{"flock", 64, 3, 70.0, 0.2},
                                         Mover{"orbit", 12, 2, 50.0, 0.05}),
                         [](const auto& c) { return std::string(c.param.name); });

}  // namespace peerd::sim::moving_scenarios_test
