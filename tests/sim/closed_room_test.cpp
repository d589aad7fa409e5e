// Closed rooms by chance (closed_room.hpp): nothing leaves them, no contact adds energy, and the peers agree.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <map>
#include <sstream>

#include "tests/peerd/scratch_folder.hpp"
#include "tests/sim/closed_room.hpp"
#include "tests/sim/run_scenario.hpp"

namespace peerd::sim::closed_room_test {

using peerd::testing_support::ScratchFolder;
using testing_support::ClosedRoom;
using testing_support::kRoomHalf_m;

// Kinetic energies are compared up to this part of themselves: the rounding of 14 s of motion.
constexpr double kRounding = 1e-9;

// What is wrong with the run of a room; a line each.
class Faults {
 public:
  Faults(const ClosedRoom& room, const ScratchFolder& folder) : room_(room) {
    folder.write("room.wrl", room.world);
    const auto file = folder.write("room.toml", room.scenario);
    const config::Scenario scenario = testing_support::scenario_of(file);
    const auto shared = must(share_world(scenario.world));
    scene_ = shared->model->scene;
    const auto logs =
        must(simulate(scenario.runs[0], *shared, [&](HostTime, const PeerNode&, const replication::Output& o) {
          if (const auto* seen = std::get_if<replication::ContactSeen>(&o)) take(*seen);
        }));
    for (const PeerLog& log : logs) {
      take(log);
      if (room.one_owner && log.start) take_energies(log);
    }
    const auto record = must(assemble(scenario.runs[0], *shared, logs));
    take(measure::summarise({scenario.name, "sim", scenario.seed, {}}, {&record, 1})["runs"][0]);
  }
  [[nodiscard]] const std::vector<std::string>& lines() const { return lines_; }

 private:
  double mass(ObjectId object) const {
    const auto& response = scene_->object(object).response;
    return response ? response->mass_kg : 1.0;
  }
  double energy(ObjectId object, const KinematicState& s) const {
    return 0.5 * mass(object) * s.velocity.squaredNorm();
  }
  template <class... Parts>
  void add(const Parts&... parts) {
    std::ostringstream line;
    line.precision(12);
    (line << ... << parts);
    lines_.push_back(line.str());
  }

  void take(const replication::ContactSeen& seen) {
    using replication::ContactKind;
    if (seen.kind != ContactKind::kDecided) return;
    const auto& c = seen.contact;
    const double before = energy(c.collider, c.collider_before) + energy(c.collidee, c.collidee_before);
    const double after = energy(c.collider, c.collider_after) + energy(c.collidee, c.collidee_after);
    if (after > before * (1.0 + kRounding)) {
      add(scene_->path_of(c.collider), " meets ", scene_->path_of(c.collidee), " at ", to_seconds(c.at - SimTime{}),
          " s: energy from ", before, " to ", after, " J");
    }
  }
  void take(const PeerLog& log) {
    std::map<ObjectId, bool> told;
    for (const auto& sample : log.object_samples) {
      if (sample.owner != log.peer || told[sample.object]) continue;
      const double out = sample.state.position.cwiseAbs().maxCoeff();
      if (out < kRoomHalf_m) continue;
      told[sample.object] = true;
      add(scene_->path_of(sample.object), " of ", log.name, " is outside at ",
          to_seconds(sample.true_at.time_since_epoch()), " s: ", out, " m");
    }
  }
  // The sum of kinetic and potential energy never grows once all bodies have been launched.
  void take_energies(const PeerLog& log) {
    std::map<SimTime, std::pair<std::size_t, double>> sums_J;  // the bodies that they are of
    for (const auto& sample : log.object_samples) {
      if (sample.owner != log.peer) continue;
      const auto body = static_cast<std::size_t>(std::stoi(scene_->path_of(sample.object).substr(1)));
      auto& [bodies, sum_J] = sums_J[sample.at];
      ++bodies;
      sum_J += energy(sample.object, sample.state) -
               mass(sample.object) * room_.gravity_m_s2[body] * (sample.state.position.y() + kRoomHalf_m);
    }
    double least_J = std::numeric_limits<double>::infinity();
    for (const auto& [at, sum] : sums_J) {
      if (at <= *log.start || sum.first != room_.gravity_m_s2.size()) continue;
      if (sum.second > least_J * (1.0 + kRounding)) {
        add("the energy grows from ", least_J, " to ", sum.second, " J at ", to_seconds(at - *log.start), " s");
        return;
      }
      least_J = std::min(least_J, sum.second);
    }
  }
  void take(const nlohmann::ordered_json& summary) {
    const auto& shared = summary["collisions"]["shared"];
    if (shared["disagreed"] != 0) add("disagreed: ", shared["disagreed"]);
    if (room_.steady && shared["missed"] != 0) add("missed: ", shared["missed"]);
  }

  const ClosedRoom& room_;
  const Scene* scene_ = nullptr;
  std::vector<std::string> lines_;
};

void expect_no_faults(std::uint64_t seed) {
  const ScratchFolder folder;
  EXPECT_THAT(Faults(testing_support::make_closed_room(seed), folder).lines(), testing::IsEmpty()) << "seed " << seed;
}

// Ten rooms each.
class ClosedRooms : public testing::TestWithParam<int> {};
TEST_P(ClosedRooms, HoldWhatIsInThem) {
  for (int i = 0; i < 10; ++i) expect_no_faults(static_cast<std::uint64_t>(10 * GetParam() + i));
}
INSTANTIATE_TEST_SUITE_P(Tens, ClosedRooms, testing::Range(0, 10));

TEST(ClosedRoom, HoldsForAsManySeedsAsAreAskedFor) {
  const char* const first = std::getenv("PEERD_ROOMS_FROM");
  const char* const count = std::getenv("PEERD_ROOMS");
  if (count == nullptr) GTEST_SKIP() << "PEERD_ROOMS says how many, PEERD_ROOMS_FROM from which seed on";
  const std::uint64_t begin = first != nullptr ? std::strtoull(first, nullptr, 10) : 0;
  for (std::uint64_t seed = begin; seed < begin + std::strtoull(count, nullptr, 10); ++seed) expect_no_faults(seed);
}

}  // namespace peerd::sim::closed_room_test
