// Ten thousand objects in one place, in one cell and in one line: the work grows with the objects and the named pairs,
// not with their squares.
#include "collision/broad_phase/broad_phase.hpp"
#include "collision/query/wide_query.hpp"
#include "collision/scene/collision_watch.hpp"
#include "tests/replication/peer/lan.hpp"

namespace peerd::crowds_test {

using namespace std::chrono_literals;

constexpr std::uint32_t kCrowd = 10'000;

// ---- the broad phase ----

struct Row {
  const char* name;
  collision::BroadPhaseMethod method;
  double step_m;  // between neighbours of a row of cubes of 1 m; 0: all in one place
};
class Crowd : public testing::TestWithParam<Row> {};

WorldBox cube(double x) { return {Vec3(x, 0, 0), Vec3(x + 1.0, 1, 1)}; }

// Each object is interested in its neighbour; all then move by the same.
TEST_P(Crowd, PairsCostWhatIsNamed) {
  const auto broad = collision::make_broad_phase(GetParam().method);
  for (std::uint32_t i = 0; i < kCrowd; ++i) broad->add(i, cube(i * GetParam().step_m));
  for (std::uint32_t i = 0; i + 1 < kCrowd; ++i) broad->register_interest(i, i + 1);
  EXPECT_EQ(broad->tick().size(), kCrowd - 1);
  const std::uint64_t first = broad->counters().box_tests;
  EXPECT_LE(first, 100u * kCrowd);
  for (std::uint32_t i = 0; i < kCrowd; ++i) broad->move(i, cube(i * GetParam().step_m + 0.25));
  EXPECT_EQ(broad->tick().size(), kCrowd - 1);
  EXPECT_LE(broad->counters().box_tests - first, 100u * kCrowd);
}
INSTANTIATE_TEST_SUITE_P(Rows, Crowd,
                         testing::Values(Row{"ListsInOnePlace", collision::BroadPhaseMethod::kInterestLists, 0.0},
                                         Row{"ListsInALine", collision::BroadPhaseMethod::kInterestLists, 1.0}),
                         [](const auto& r) { return std::string(r.param.name); });

// A group, in a line that touches: the answer is as long as the line.
TEST(CrowdGroup, InALineCostsTheLine) {
  const auto broad = collision::make_broad_phase();
  for (std::uint32_t i = 0; i < kCrowd; ++i) broad->add(i, cube(i));
  for (std::uint32_t i = 0; i < kCrowd; ++i) broad->join(0, i);
  EXPECT_EQ(broad->tick().size(), kCrowd - 1);
  // Fat boxes overlap a few neighbours; the tree was made by inserting in order, without rotations.
  EXPECT_LE(broad->counters().box_tests, 500u * kCrowd);
}

// ---- hierarchies ----

collision::TriangleSoup row_of_triangles(std::uint32_t n, double step_m) {
  collision::TriangleSoup soup;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double x = i * step_m;
    soup.vertices.insert(soup.vertices.end(), {Vec3(x, 0, 0), Vec3(x + 1, 0, 0), Vec3(x, 1, 0)});
    soup.faces.push_back({{3 * i, 3 * i + 1, 3 * i + 2}, i});
  }
  soup.box = {Vec3::Zero(), Vec3((n - 1) * step_m + 1.0, 1, 0)};
  return soup;
}

// Identical triangles can't be told apart by their places: the tree is as full and as flat as can be all the same. In a
// row the surface-area heuristic cuts between bins, so leaves are less full.
TEST(CrowdOfTriangles, OneTreeHoldsThem) {
  for (const double step_m : {0.0, 1.0}) {
    const collision::TriangleSoup many = row_of_triangles(kCrowd, step_m), one = row_of_triangles(1, 0.0);
    collision::WideTree tree(many), needle(one);
    tree.build_all();
    EXPECT_LE(tree.nodes_built(), step_m == 0.0 ? kCrowd / 8 + kCrowd / 32 : kCrowd * 7 / 32);
    collision::WideQuery query;
    // Across, through the middle of the first.
    const Pose across{Vec3(0.25, 0.25, -0.25), Quat(Eigen::AngleAxisd(1.5, Vec3::UnitX()))};
    const collision::RelativeMotion motion(Pose{}, across);
    collision::PolygonPair pair{};
    ASSERT_TRUE(query.find_pair(tree, needle, motion, pair));
    EXPECT_LE(query.counters().triangle_tests + query.counters().certain_pairs, 64u)
        << "the first that touches is enough";
    const std::size_t found = query.all_pairs(tree, needle, motion).size();
    EXPECT_EQ(found, step_m == 0.0 ? kCrowd : found);
    if (step_m > 0.0) {
      EXPECT_LE(found, 2u);
    }
  }
}

}  // namespace peerd::crowds_test

// ---- peers ----

namespace peerd::replication::crowds_test {

using namespace test;
using peerd::crowds_test::kCrowd;

std::string crowd(double step_m, bool each_with_the_next) {
  std::string text =
      "DEF B0 Transform { collisionResponse CollisionResponse { } children DEF S Shape { geometry Box { "
      "size 1 1 1 } } }\n";
  for (std::uint32_t i = 1; i < kCrowd; ++i) {
    text += "DEF B" + std::to_string(i) + " Transform { translation " + std::to_string(i * step_m) +
            " 0 0 collisionResponse CollisionResponse { } children USE S }\n";
  }
  for (std::uint32_t i = 0; each_with_the_next && i + 1 < kCrowd; ++i) {
    text += interest("B" + std::to_string(i), "\"B" + std::to_string(i + 1) + '"');
  }
  return text;
}
std::vector<OwnedObject> all_of(const World& world) {
  std::vector<OwnedObject> all;
  for (std::uint32_t i = 0; i < kCrowd; ++i) all.push_back({world[("B" + std::to_string(i)).c_str()], false});
  return all;
}

struct Place {
  const char* name;
  double step_m;
  bool regions;
};
class CrowdedPeer : public testing::TestWithParam<Place> {};
TEST_P(CrowdedPeer, WorksInProportion) {
  const World world(crowd(GetParam().step_m, true));
  ASSERT_EQ(world.model->pairs.size(), kCrowd - 1);
  Lan lan(world, {5ms, 0ms, 0, 0});
  for (const std::uint32_t id : {1u, 2u}) {
    PeerConfig c = config(id, id == 1 ? all_of(world) : std::vector<OwnedObject>{});
    c.tick_hz = 10;
    if (GetParam().regions) {
      c.regions.cell_m = 1e6;  // all in one cell
      c.regions.regions = {4, 1, 4};
    }
    lan.add(c);
  }
  lan.run_until(4s);
  ASSERT_TRUE(lan.all_in_session());
  // Nothing moves: each pair is checked a few times when the world begins, and whenever its owner publishes, not each
  // tick.
  for (const std::size_t i : {0u, 1u}) {
    const auto& counters = lan.peer(i).motion_counters();
    EXPECT_LE(counters.contact_searches + counters.searches_far, 20u * kCrowd) << i;
    EXPECT_EQ(counters.capped, 0u);
  }
  EXPECT_EQ(lan.peer(1).counters().updates_in, kCrowd);
  const auto& out = lan.peer(0).counters();
  EXPECT_LE(out.datagrams_out, 4u * kCrowd / 10) << "many records share a datagram";
  const auto searches = lan.peer(0).motion_counters().contact_searches;
  const auto looked = lan.peer(0).motion_counters().searches_skipped;
  lan.run_until(5s);
  EXPECT_EQ(lan.peer(0).motion_counters().contact_searches, searches) << "standing pairs are searched once";
  EXPECT_LE(lan.peer(0).motion_counters().searches_skipped - looked, 60u * kCrowd);
}
INSTANTIATE_TEST_SUITE_P(Places, CrowdedPeer,
                         testing::Values(Place{"AllIdentical", 0.0, false}, Place{"InALine", 1.0, false},
                                         Place{"InOneCell", 0.0, true}),
                         [](const auto& p) { return std::string(p.param.name); });

// Ten thousand objects that overlap begin to move together: each pair is checked every 10 ms of its time at most.
TEST(CrowdThatMoves, IsSampledAHundredTimesASecond) {
  const World world(crowd(0.0, true));
  MotionWorld motions(*world.model, sim(0s));
  for (const OwnedObject& e : all_of(world)) {
    motions.declare(e.object, Role::kAuthoritative);
    motions.set_base(e.object, sim(0s), moving({0, 0, 0}, {1, 0, 0}));
  }
  for (Duration t = 0s; t <= 500ms; t += 100ms) motions.advance(sim(t));
  EXPECT_LE(motions.counters().contact_searches, 2u * 51u * kCrowd);
  EXPECT_EQ(motions.counters().capped, 0u);
  EXPECT_EQ(motions.counters().contacts, 0u) << "none comes nearer to another";
}

}  // namespace peerd::replication::crowds_test
