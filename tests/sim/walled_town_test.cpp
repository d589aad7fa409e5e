// Traffic in a walled town, of which each peer sees a part (thesis, 5.2): what it skips, and that nothing depends on
// it.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "tests/sim/run_scenario.hpp"
#include "tests/sim/walled_town.hpp"

namespace peerd::sim::walled_town_test {
namespace {

using testing_support::Ran;
using testing_support::run_scenario;
using testing_support::Town;
using testing_support::TownSize;

std::string write(const Town& town, const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / name;
  for (const char* const part : {"worlds", "scenarios"}) std::filesystem::create_directories(folder / part);
  std::ofstream(folder / "worlds/walled-town.wrl") << town.world;
  std::ofstream(folder / "scenarios/walled-town.toml") << town.scenario;
  return (folder / "scenarios/walled-town.toml").string();
}

struct Both {
  Ran all, skipping;
};

Both run_both(const TownSize& size, const std::vector<std::string>& sets) {
  const Town town = testing_support::walled_town(size);
  const std::string file = write(town, "walled_town_" + std::to_string(size.seed));
  std::vector<std::string> sees_all = sets;
  for (const std::string& peer : town.viewers) sees_all.push_back("peer." + peer + ".skip_unseen=false");
  auto all = run_scenario(file, sees_all), skipping = run_scenario(file, sets);
  EXPECT_EQ(all.size(), 1u);
  EXPECT_EQ(skipping.size(), 1u);
  return {std::move(all.front()), std::move(skipping.front())};
}

bool same_bits(const Vec3& a, const Vec3& b) { return a == b; }
bool same_bits(const KinematicState& a, const KinematicState& b) {
  return same_bits(a.position, b.position) && same_bits(a.velocity, b.velocity) &&
         same_bits(a.acceleration, b.acceleration) && a.orientation.coeffs() == b.orientation.coeffs() &&
         same_bits(a.angular_velocity_body, b.angular_velocity_body);
}

// A pyramid with an apex, and a far end, by its angles: nothing of collision's planes is used.
bool sees(const Pose& eye, double angle_rad, double far_m, const Vec3& p, double inside_m) {
  const Vec3 local = eye.orientation.conjugate() * (p - eye.position);
  const double depth = -local.z();
  if (depth < inside_m || depth > far_m - inside_m) return false;
  const double half = std::tan(angle_rad / 2), wide = 4.0 / 3.0 * half;
  return std::abs(local.y()) < depth * half - inside_m && std::abs(local.x()) < depth * wide - inside_m;
}

// What the peer that looks out of that car surely sees: ahead, or by its mirror.
bool surely_sees(const Pose& car, const Vec3& p) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  const Pose ahead{car * Vec3(0, 1, 0), car.orientation};
  const Pose back{ahead.position, car.orientation * Quat(Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitY()))};
  return sees(ahead, 75 * kDegree, 180.0, p, 1.5) || sees(back, 20 * kDegree, 60.0, p, 1.5);
}

// Peers have names of one letter, by district, if they look.
bool looks(const PeerLog& log) { return log.name.size() == 1; }

struct Compared {
  std::uint64_t own = 0, own_differ = 0, remote = 0, seen = 0, seen_differ = 0, shown_differ = 0, unseen_differ = 0;
};

Compared compare(const Both& both, const Scene& scene) {
  Compared c;
  EXPECT_EQ(both.all.logs.size(), both.skipping.logs.size());
  for (std::size_t p = 0; p < both.all.logs.size(); ++p) {
    const PeerLog &all = both.all.logs[p], &skipping = both.skipping.logs[p];
    std::optional<ObjectId> eye;
    if (looks(all)) eye = scene.find("CAR_" + std::string(1, static_cast<char>(all.name[0] - 'a' + 'A')) + "_0");
    std::optional<Pose> from;
    EXPECT_EQ(all.object_samples.size(), skipping.object_samples.size());
    if (all.object_samples.size() != skipping.object_samples.size()) continue;
    for (std::size_t i = 0; i < all.object_samples.size(); ++i) {
      const auto &a = all.object_samples[i], &b = skipping.object_samples[i];
      EXPECT_EQ(a.object, b.object);
      EXPECT_EQ(a.owner, b.owner);
      EXPECT_EQ(a.at, b.at);
      const bool equal = same_bits(a.state, b.state);
      if (a.owner == all.peer) {
        if (eye && a.object == *eye) from = a.state.pose();
        ++c.own;
        c.own_differ += equal ? 0 : 1;
        continue;
      }
      if (!eye) {
        EXPECT_TRUE(equal) << all.name << " looks at nothing, and skips nothing";
        continue;
      }
      ++c.remote;
      if (from && surely_sees(*from, a.state.position)) {
        ++c.seen;
        c.seen_differ += equal ? 0 : 1;
        c.shown_differ += same_bits(a.shown.position, b.shown.position) ? 0 : 1;
      } else {
        c.unseen_differ += equal ? 0 : 1;
      }
    }
  }
  return c;
}

// The contacts that a peer states of its own objects, and the decisions that it takes part in.
std::vector<std::string> own_contacts(const PeerLog& log) {
  std::vector<std::string> rows;
  for (const PeerLog::Contact& c : log.contacts) {
    if (c.kind != "owner" && c.kind != "decided") continue;
    std::ostringstream row;
    row.precision(17);
    row << c.kind << ' ' << c.at.time_since_epoch().count() << ' ' << c.collider.number << ' ' << c.collidee.number
        << ' ' << c.normal.transpose() << ' ' << c.known_at.time_since_epoch().count();
    rows.push_back(row.str());
  }
  return rows;
}

// Of the peers that look.
double searches(const Ran& ran) {
  double sum = 0;
  for (const PeerLog& log : ran.logs)
    sum += looks(log) ? static_cast<double>(log.counters.at("contact_searches")) : 0.0;
  return sum;
}

Scene scene_of(const TownSize& size) { return read_world(testing_support::walled_town(size).world).scene.value(); }

void expect_nothing_depends_on_what_nobody_sees(const Both& both, const TownSize& size) {
  const Compared c = compare(both, scene_of(size));
  std::size_t contacts = 0;
  for (std::size_t p = 0; p < both.all.logs.size(); ++p) {
    contacts += own_contacts(both.all.logs[p]).size();
    EXPECT_EQ(own_contacts(both.all.logs[p]), own_contacts(both.skipping.logs[p])) << both.all.logs[p].name;
  }
  EXPECT_EQ(c.own_differ, 0u) << "of " << c.own << " states of own objects";
  EXPECT_EQ(c.seen_differ, 0u) << "of " << c.seen << " states of ghosts in sight";
  EXPECT_EQ(c.shown_differ, 0u);
  EXPECT_GT(contacts, 10u) << "something must happen";
  EXPECT_GT(c.seen, 1000u);
  EXPECT_GT(c.unseen_differ, 0u) << "nothing was put off that would have mattered";
  const double share = static_cast<double>(c.seen) / static_cast<double>(c.remote);
  testing::Test::RecordProperty("surely_seen", std::to_string(share));
  testing::Test::RecordProperty("searches", std::to_string(searches(both.skipping) / searches(both.all)));
  testing::Test::RecordProperty("unseen_differ", std::to_string(c.unseen_differ));
  testing::Test::RecordProperty("contacts", std::to_string(contacts));
}

std::string text_of(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

}  // namespace

struct TownCase {
  std::uint64_t seed;
  int loose = 0;
};
class WalledTown : public testing::TestWithParam<TownCase> {};
TEST_P(WalledTown, NothingDependsOnWhatNobodySees) {
  const TownSize size{
      .columns = 3, .cars = 5, .boxes = 6, .bodies = 1, .loose = GetParam().loose, .seed = GetParam().seed};
  expect_nothing_depends_on_what_nobody_sees(run_both(size, {"duration_s=12"}), size);
}
INSTANTIATE_TEST_SUITE_P(Seeds, WalledTown, testing::Values(TownCase{1}, TownCase{2}, TownCase{3, 4}, TownCase{4, 4}));

TEST(WalledTownTraffic, TakesAFifthOfTheSearchesWhereATenthIsSeen) {
  const TownSize size;
  const Both both = run_both(size, {});
  expect_nothing_depends_on_what_nobody_sees(both, size);
  EXPECT_LE(searches(both.skipping), 0.2 * searches(both.all));
}

TEST(WalledTownTraffic, IsTheScenarioOfTheConfigurations) {
  const std::filesystem::path configs = PEERD_SOURCE_DIR "/configs";
  const Town town = testing_support::walled_town({});
  EXPECT_EQ(text_of(configs / "worlds/walled-town.wrl"), town.world);
  EXPECT_EQ(text_of(configs / "scenarios/walled-town.toml"), town.scenario);
}

}  // namespace peerd::sim::walled_town_test
