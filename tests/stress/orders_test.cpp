// The same things in another order: peers, objects, datagrams, polygons, interests.
#include <algorithm>
#include <numeric>
#include <random>

#include "collision/scene/scene_query.hpp"
#include "tests/collision/shapes.hpp"
#include "tests/replication/peer/lan.hpp"

namespace peerd::replication::orders_test {

using namespace test;

// A peer's predictions of all objects, bit for bit.
std::vector<std::uint64_t> beliefs(const Lan& lan, std::size_t i, const World& world, SimTime t) {
  std::vector<std::uint64_t> bits;
  for (const char* name : {"A", "B", "C", "D"}) {
    const KinematicState s = lan.peer(i).ghost(world[name], t);
    for (const Vec3& v : {s.position, s.velocity, s.acceleration}) {
      for (const double x : v) bits.push_back(std::bit_cast<std::uint64_t>(x + 0.0));  // -0 is 0 on the wire
    }
  }
  return bits;
}
const std::string kBodies = box("A", "1 1 1", "-4 0 0", std::string(kBounces) + "velocityVector 1.3 0 0 ") +
                            box("B", "1 1 1", "0 0.1 0", std::string(kBounces) + "velocityVector -0.2 0 0 ") +
                            box("C", "1 1 1", "4 0 0.1", std::string(kBounces) + "velocityVector -1.1 0 0 ") +
                            box("D", "1 1 1", "0 0 5", std::string(kBounces) + "velocityVector 0 0 -0.7 ") +
                            box("WALL", "1 50 50", "9 0 0");
const std::vector<std::string> kInterests = {
    interest("A", "\"B\" \"C\" \"D\" \"WALL\""), interest("B", "\"A\" \"C\" \"D\" \"WALL\""),
    interest("C", "\"A\" \"B\" \"D\" \"WALL\""), interest("D", "\"A\" \"B\" \"C\" \"WALL\"")};
std::string text_of(const std::vector<std::string>& parts) {
  return std::accumulate(parts.begin(), parts.end(), std::string());
}

// All objects of three peers collide with all. The hosts' clocks are one, so that it does not matter which peer founds
// the session.
std::vector<std::uint64_t> meet(const World& world, const std::vector<std::uint32_t>& ids,
                                const std::vector<const char*>& objects) {
  Lan lan(world, {5ms, 0ms, 0, 0});
  std::vector<std::size_t> place(4);
  for (const std::uint32_t id : ids) {
    PeerConfig c = config(id);
    c.wait_for_start = true;
    for (const char* name : objects) {
      const std::uint32_t owner = *name == 'A' || *name == 'D' ? 1 : *name == 'B' ? 2 : 3;
      if (owner == id) c.owned.push_back({world[name], false});
    }
    place[id] = lan.add(c);
  }
  lan.run_until(3s);
  for (std::size_t i = 0; i < lan.size(); ++i) {
    lan.peer(i).announce_start(SimTime{kEpoch + 4s});
    lan.peer(i).start_motions(lan.host_now(i), SimTime{kEpoch + 4s});
  }
  lan.run_until(14s);
  const auto all = beliefs(lan, place[1], world, SimTime{kEpoch + 12s});
  for (const std::uint32_t id : {2u, 3u}) EXPECT_EQ(beliefs(lan, place[id], world, SimTime{kEpoch + 12s}), all) << id;
  std::size_t contacts = 0;
  for (std::size_t i = 0; i < lan.size(); ++i) contacts += lan.contacts(i, ContactKind::kDecided).size();
  EXPECT_GE(contacts, 2u);
  return all;
}

TEST(Orders, OfPeersAndOfTheirObjects) {
  const World world(kBodies + text_of(kInterests));
  std::vector<std::uint32_t> ids{1, 2, 3};
  std::vector<const char*> objects{"A", "B", "C", "D"};
  const auto expected = meet(world, ids, objects);
  do {
    EXPECT_EQ(meet(world, ids, objects), expected) << ids[0] << ids[1] << ids[2];
  } while (std::ranges::next_permutation(ids).found);
  std::mt19937_64 rng(1);
  for (int i = 0; i < 12; ++i) {
    std::ranges::shuffle(objects, rng);
    EXPECT_EQ(meet(world, ids, objects), expected) << i;
  }
}

// The case in which no two contacts are of one instant.
TEST(Orders, OfInterests) {
  const auto end_of = [](std::vector<std::string> interests, bool turned) {
    if (turned) {  // who is named by whom
      for (std::string& i : interests) {
        const std::size_t open = i.find('['), close = i.find(']');
        std::vector<std::string> names;
        std::istringstream in(i.substr(open + 1, close - open - 1));
        for (std::string name; in >> name;) names.insert(names.begin(), name);
        std::string list;
        for (const std::string& name : names) list += name + ' ';
        i.replace(open + 1, close - open - 1, list);
      }
    }
    const World world(kBodies + text_of(interests));
    MotionWorld motions(*world.model, sim(0s));
    const std::map<const char*, Vec3> velocities{
        {"A", {1.3, 0, 0}}, {"B", {-0.2, 0, 0}}, {"C", {-1.1, 0, 0}}, {"D", {0, 0, -0.7}}};
    for (const auto& [name, velocity] : velocities) {
      motions.declare(world[name], Role::kAuthoritative);
      motions.set_base(world[name], sim(0s), moving(world.scene.rigid_pose(world[name]).position, velocity));
    }
    motions.advance(sim(9s));
    EXPECT_GE(motions.counters().contacts, 3u);
    std::vector<std::uint64_t> bits;
    for (const char* name : {"A", "B", "C", "D"}) {
      const KinematicState s = motions.at(world[name], sim(9s));
      for (const Vec3& v : {s.position, s.velocity}) {
        for (const double x : v) bits.push_back(std::bit_cast<std::uint64_t>(x + 0.0));
      }
    }
    return bits;
  };
  std::vector<std::string> interests = kInterests;
  std::ranges::sort(interests);
  const auto expected = end_of(interests, false);
  do {
    EXPECT_EQ(end_of(interests, false), expected);
    EXPECT_EQ(end_of(interests, true), expected);
  } while (std::ranges::next_permutation(interests).found);
}

// Five datagrams of two peers in all orders in which no object's news overtakes its own (what is overtaken is dropped,
// and is as good as lost): what is believed in the end is the same.
TEST(Orders, OfArrivalOfTheSameDatagrams) {
  const World world(kBodies + text_of(kInterests));
  std::vector<std::size_t> order{0, 1, 2, 3, 4};
  std::vector<std::uint64_t> expected;
  int orders = 0;
  do {
    const auto comes = [&](std::size_t i) { return std::ranges::find(order, i) - order.begin(); };
    if (comes(0) > comes(1) || comes(2) > comes(4)) continue;
    ++orders;
    Lan lan(world);
    const std::size_t self = lan.add(config(5, {{world["D"], false}}));
    lan.run_until(2s);
    lan.inject(self, encode(hello_of(2, lan.host_now(self), {world["A"], world["B"]})));
    lan.inject(self, encode(hello_of(3, lan.host_now(self), {world["C"]})));
    const SimTime now = lan.session_now(self);
    const auto update = [&](std::uint32_t of, const char* object, std::uint32_t sequence, Duration ago, const Vec3& p,
                            const Vec3& v) {
      Message m = message_of(of);
      m.updates = {{world[object], sequence, now - ago, moving(p, v), {}, {}}};
      return encode(m);
    };
    const std::vector<Bytes> datagrams{
        update(2, "A", 1, 400ms, {-1, 0, 0}, {2, 0, 0}), update(2, "A", 2, 50ms, {-0.6, 0, 0}, {2.5, 0, 0}),
        update(3, "C", 1, 300ms, {2, 0, 0}, {-1, 0, 0}), update(2, "B", 1, 350ms, {0.5, 0.1, 0}, {0.3, 0, 0}),
        update(3, "C", 2, 10ms, {1.8, 0, 0.2}, {-3, 0, 0})};
    for (const std::size_t i : order) EXPECT_TRUE(lan.inject(self, datagrams[i]).has_value());
    lan.run_until(5s);
    const auto got = beliefs(lan, self, world, lan.session_now(self) - 100ms);
    if (expected.empty()) expected = got;
    EXPECT_EQ(got, expected) << order[0] << order[1] << order[2] << order[3] << order[4];
  } while (std::ranges::next_permutation(order).found);
  EXPECT_EQ(orders, 30);
}

}  // namespace peerd::replication::orders_test

namespace peerd::collision::orders_test {

using namespace test;

// 72 orders of the polygons, each begun at another corner: the same pairs by their own names, the same contact time.
// Not the same normal: of the polygons around a corner that is met, the lowest gives it (collision/README.md).
TEST(Orders, OfPolygons) {
  std::mt19937_64 rng(7);
  const Mesh ball = random_polyhedron(rng, 14);
  Faces faces(1);
  for (const std::int32_t corner : ball.corners) {
    if (corner == Mesh::kEndOfPolygon) {
      faces.emplace_back();
    } else {
      faces.back().push_back(static_cast<std::uint32_t>(corner));
    }
  }
  if (faces.back().empty()) faces.pop_back();
  const std::vector<Eigen::Vector3f> vertices(ball.vertices.begin(), ball.vertices.end());
  std::vector<std::uint32_t> order(faces.size());
  std::iota(order.begin(), order.end(), 0u);

  std::vector<std::pair<std::uint32_t, std::uint32_t>> expected_pairs;
  std::optional<Contact> expected;
  for (int turn = 0; turn < 72; ++turn) {
    Faces turned;
    for (const std::uint32_t f : order) {
      turned.push_back(faces[f]);
      std::ranges::rotate(turned.back(), turned.back().begin() + turn % 3);
    }
    const Mesh mesh = make_mesh(vertices, turned);
    const Body a = body_of(mesh), b = body_of(ball);
    KinematicState at = moving({4, 0.3, 0.2}, {-1, 0.01, 0});
    const KinematicState still;
    const Contact c = first_contact({b, at}, {a, still}, CollisionType::kWitness, 10.0);
    ASSERT_EQ(c.state, ContactState::kContact);
    if (!expected) expected = c;
    EXPECT_EQ(c.time_s, expected->time_s) << turn;

    const Scene scene = scene_of({mesh, ball});  // two Shapes in one place
    SceneQuery query(scene);
    const auto all = query.collide(ObjectId{1}, ObjectId{2}, CollisionType::kAllPairs);
    ASSERT_TRUE(all.has_value());
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const ShapePair& p : all->pairs) pairs.emplace_back(order[p.collider.polygon], p.collidee.polygon);
    std::ranges::sort(pairs);
    if (turn == 0) expected_pairs = pairs;
    EXPECT_EQ(pairs, expected_pairs) << turn;
    std::ranges::shuffle(order, rng);
  }
  EXPECT_GE(expected_pairs.size(), faces.size());
}

}  // namespace peerd::collision::orders_test
