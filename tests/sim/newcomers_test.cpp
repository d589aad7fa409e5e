// A peer that joins late has, from its first second on, the ghosts that the others have, to the last bit, where nothing
// is on its way.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <tuple>

#include "tests/peerd/scratch_folder.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::newcomers_test {

using testing_support::Ran;
using testing_support::run_scenario;

constexpr Duration kFirstSecond = std::chrono::seconds(1);
constexpr PeerId kLate{99};

struct Comparison {
  std::size_t equal = 0, in_flight = 0;
  std::vector<std::string> differ;
};

bool same_bits(const KinematicState& a, const KinematicState& b) {
  return a.position == b.position && a.velocity == b.velocity && a.acceleration == b.acceleration &&
         a.orientation.coeffs() == b.orientation.coeffs() && a.angular_velocity_body == b.angular_velocity_body;
}

// The times at which something was said of each object: an update was published, or a contact became known to a peer.
std::map<ObjectId, std::vector<SimTime>> news_of(const std::vector<PeerLog>& logs) {
  std::map<ObjectId, std::vector<SimTime>> news;
  for (const PeerLog& log : logs) {
    for (const auto& update : log.updates) news[update.object].push_back(update.at);
    for (const auto& contact : log.contacts) {
      for (const ObjectId object : {contact.collider, contact.collidee}) {
        news[object].push_back(contact.known_at);
        news[object].push_back(contact.at);
      }
    }
  }
  for (auto& [object, times] : news) std::ranges::sort(times);
  return news;
}

// The samples of the late peer beside those of the others, of objects that neither owns, at times of both.
Comparison compare(const Ran& ran, Duration in_flight_for) {
  Comparison all;
  const auto late = std::ranges::find(ran.logs, kLate, &PeerLog::peer);
  if (late == ran.logs.end() || late->object_samples.empty()) return all;
  const auto news = news_of(ran.logs);
  const SimTime from = late->object_samples.front().at + kFirstSecond;
  std::map<std::pair<SimTime, ObjectId>, const PeerLog::ObjectSample*> theirs;
  for (const auto& sample : late->object_samples) {
    if (sample.at >= from && sample.owner != kLate) theirs.emplace(std::pair(sample.at, sample.object), &sample);
  }
  for (const PeerLog& log : ran.logs) {
    if (log.peer == kLate) continue;
    for (const auto& sample : log.object_samples) {
      const auto same = theirs.find({sample.at, sample.object});
      if (sample.owner == log.peer || same == theirs.end()) continue;
      const auto said = news.find(sample.object);
      const bool is_in_flight = said != news.end() && [&] {
        const auto next = std::ranges::lower_bound(said->second, sample.at - in_flight_for);
        return next != said->second.end() && *next <= sample.at + in_flight_for;
      }();
      if (same_bits(sample.state, same->second->state)) {
        ++all.equal;
      } else if (is_in_flight) {
        ++all.in_flight;
      } else {
        all.differ.push_back("object " + std::to_string(sample.object.number) + " at " +
                             std::to_string(to_seconds(sample.at - *log.start)) + " s, beside " + log.name);
      }
    }
  }
  return all;
}

class Newcomers : public testing::TestWithParam<std::tuple<const char*, double>> {};

TEST_P(Newcomers, HaveTheOthersGhosts) {
  const auto& [scenario, at_s] = GetParam();
  const peerd::testing_support::ScratchFolder folder;
  folder.write("late.toml", "[peer.late]\nid = 99\n[event.late-comes]\nat_s = " + std::to_string(at_s) +
                                "\nkind = \"join\"\npeer = \"late\"\n");
  const auto runs = run_scenario(PEERD_SOURCE_DIR "/configs/scenarios/" + std::string(scenario),
                                 {"network.latency_ms=100", "decisions.policy=id"}, {folder / "late.toml"});
  ASSERT_EQ(runs.size(), 1u);
  // Twice the way there, as an answer takes, and some ticks.
  const Comparison compared = compare(runs.front(), std::chrono::milliseconds(300));
  std::cout << compared.equal << " equal, " << compared.in_flight << " with something on its way\n";
  EXPECT_GT(compared.equal, 1000u);
  EXPECT_EQ(compared.differ.size(), 0u) << compared.differ.front() << ", " << compared.differ.back();
}
INSTANTIATE_TEST_SUITE_P(Moments, Newcomers,
                         testing::Combine(testing::Values("comings.toml", "traffic.toml"),
                                          testing::Values(0.5, 3.7, 6.1, 9.3, 12.9)));

}  // namespace peerd::sim::newcomers_test
