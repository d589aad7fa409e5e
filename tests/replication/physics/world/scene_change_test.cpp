// A world goes on with an edited scene: as the file that has the edit would from then on, whether the edit is known in
// time or later.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <random>

#include "core/edit/scene_editor.hpp"
#include "core/vrml/document.hpp"
#include "replication/physics/world/motion_world.hpp"
#include "tests/replication/peer/worlds.hpp"

namespace peerd::replication::scene_change_test {

using namespace test;
using testing::ElementsAre;
using testing::IsEmpty;

using Edit = std::function<void(SceneEditor&)>;

const std::string kHead = "#VRML V2.0 utf8\n";

std::unique_ptr<const WorldModel> edited_model(const WorldModel& model, const Edit& edit) {
  SceneEditor editor(*model.scene);
  edit(editor);
  auto scene = editor.finish();
  EXPECT_TRUE(scene) << scene.error();
  return edited(model, std::make_shared<const Scene>(std::move(scene).value()));
}

Edit adds(const std::string& text, std::uint32_t first = 0) {
  return [=](SceneEditor& editor) {
    const auto added = editor.add(kHead + text, {}, {ObjectId(first, 7), NodeId(first, 7)}, {});
    EXPECT_TRUE(added) << added.error();
  };
}
Edit removes(ObjectId id) {
  return [=](SceneEditor& editor) { EXPECT_TRUE(editor.remove(id)); };
}
Edit sets(const Scene& scene, ObjectId id, const std::string& field, const std::string& value) {
  const NodeId node = scene.document->ids.id_of(scene.at(id).node);
  return [=](SceneEditor& editor) {
    const auto set = editor.set(node, field, value, NodeId(900, 7));
    EXPECT_TRUE(set) << set.error();
  };
}

struct Lived {
  std::vector<SimTime> contacts;
  KinematicState ball;
};

// BALL moves from 0 s on; the edit takes effect at `at`, and is known at `known`.
Lived live(const World& w, const KinematicState& ball, const Edit& edit, Duration at, Duration known, Duration until) {
  MotionWorld world(*w.model, sim(0s));
  const ObjectId id = w["BALL"];
  world.declare(id, Role::kPredicted);
  world.set_base(id, sim(0s), ball);
  std::vector<ContactEvent> contacts;
  world.advance(sim(known));
  (void)standing(world, contacts);
  const auto next = edited_model(*w.model, edit);
  (void)world.change_scene(
      *next, {sim(at), [&](ObjectId object) { return object == id; }, [](ObjectId) { return Role::kScene; }});
  for (Duration t = known; t < until; t += 16ms) world.advance(sim(t));
  world.advance(sim(until));
  return {standing(world, contacts), world.at(id, sim(until))};
}

const std::string kBall = box("BALL", "0.5 0.5 0.5", "0 0 0", kBounces);
const std::string kLeft = box("LEFT", "1 50 50", "-3.75 0 0");
const std::string kRight = box("RIGHT", "1 50 50", "3.75 0 0");

// The parameter is when the edit is known that takes effect at 1 s.
class SceneChange : public testing::TestWithParam<Duration> {
 protected:
  static Lived lived_with(const World& w, const Edit& edit, const KinematicState& ball = moving({0, 0, 0}, {2, 0, 0})) {
    return live(w, ball, edit, 1s, GetParam(), 4s);
  }
};

TEST_P(SceneChange, WhatIsAddedIsMet) {
  const World w(kBall + kLeft + interest("BALL", "\"LEFT\""));
  const Edit wall = [&](SceneEditor& editor) {
    const auto added = editor.add(kHead + kRight + interest("BALL", "\"RIGHT\""), {}, {ObjectId(0, 7), NodeId(0, 7)},
                                  {}, [&](std::string_view path) { return w.scene.find(path); });
    EXPECT_TRUE(added) << added.error();
  };
  const Lived lived = lived_with(w, wall);
  EXPECT_THAT(lived.contacts, ElementsAre(sim(1500ms)));
  EXPECT_EQ(lived.ball.position, Vec3(-2, 0, 0));
}

TEST_P(SceneChange, WhatIsRemovedIsNot) {
  const World w(corridor());
  const Lived lived = lived_with(w, removes(w["RIGHT"]));
  EXPECT_THAT(lived.contacts, IsEmpty());
  EXPECT_EQ(lived.ball.position, Vec3(8, 0, 0));
}

// It has been met before: that stands.
TEST_P(SceneChange, WhatWasMetBeforeStands) {
  const World w(corridor());
  const Lived lived = lived_with(w, removes(w["RIGHT"]), moving({0, 0, 0}, {20, 0, 0}));
  EXPECT_THAT(lived.contacts, ElementsAre(sim(150ms), sim(450ms), sim(750ms), sim(1050ms)));
  EXPECT_NEAR(lived.ball.position.x(), -3 + 20 * 2.95, 1e-9);
}

TEST_P(SceneChange, WhatIsMovedIsMetElsewhere) {
  const World w(corridor());
  const Lived lived = lived_with(w, sets(w.scene, w["RIGHT"], "translation", "4.75 0 0"));
  EXPECT_THAT(lived.contacts, ElementsAre(sim(2s)));
  EXPECT_EQ(lived.ball.position, Vec3(0, 0, 0));
}

TEST_P(SceneChange, WhatIsScaledIsMetEarlier) {
  const World w(corridor());
  const Lived lived = lived_with(w, sets(w.scene, w["RIGHT"], "scale", "2 1 1"));
  EXPECT_THAT(lived.contacts, ElementsAre(sim(1250ms), sim(4s)));
}

TEST_P(SceneChange, WhatAnswersNoMoreGoesThrough) {
  const World w(corridor());
  const Lived lived = lived_with(w, sets(w.scene, w["BALL"], "collisionResponse", "NULL"));
  ASSERT_EQ(lived.contacts.size(), 2u);  // the faces of the wall; between them it touches none
  EXPECT_EQ(lived.contacts[0], sim(1500ms));
  EXPECT_NEAR(to_seconds(lived.contacts[1] - sim(2s)), 0.0, 1e-6);
  EXPECT_EQ(lived.ball.position, Vec3(8, 0, 0));
}

// An edit of something else changes nothing, to the last bit.
TEST_P(SceneChange, WhatIsElsewhereDoesNotMatter) {
  const World w(corridor());
  const KinematicState ball = moving({0, 0, 0}, {2.3, 0.1, -0.2});
  const Lived lived = lived_with(w, adds(box("FAR", "1 1 1", "90 0 0")), ball);
  MotionWorld world(*w.model, sim(0s));
  world.declare(w["BALL"], Role::kPredicted);
  world.set_base(w["BALL"], sim(0s), ball);
  world.advance(sim(4s));
  EXPECT_EQ(lived.contacts, standing(world));
  EXPECT_TRUE(same_bits(lived.ball, world.at(w["BALL"], sim(4s))));
}

INSTANTIATE_TEST_SUITE_P(Known, SceneChange, testing::Values(1s, 1400ms, 1700ms, 2900ms),
                         [](const auto& each) { return "At" + std::to_string(each.param / 1ms) + "ms"; });

// A ball that lies on a floor falls when the floor goes.
TEST(SceneChangeOnce, WhatLayOnItFalls) {
  auto&& [w, world] = Started(
      box("BALL", "0.5 0.5 0.5", "0 1 0", " collisionResponse CollisionResponse { responseType 2 restitution 0.2 } ") +
      box("FLOOR", "9 1 9", "0 0 0") + interest("BALL", "\"FLOOR\""));
  const ObjectId ball = w["BALL"];
  world.declare(ball, Role::kPredicted);
  world.set_base(ball, sim(0s), moving({0, 1, 0}, Vec3::Zero(), {0, -9.81, 0}));
  world.advance(sim(3s));
  ASSERT_TRUE(world.is_at_rest_from(ball, sim(3s)));
  const auto next = edited_model(*w.model, removes(w["FLOOR"]));
  (void)world.change_scene(
      *next, {sim(3s), [&](ObjectId object) { return object == ball; }, [](ObjectId) { return Role::kScene; }});
  world.advance(sim(4s));
  EXPECT_NEAR(world.at(ball, sim(4s)).velocity.y(), -9.81, 1e-9);
}

// A pair that waits for one of its two to move (motion_world.hpp) is watched where an edit moves one of them; what it
// leaves where it is costs nothing as before.
TEST(SceneChangeOnce, EndsTheWaitOfWhatItMoves) {
  const World w(box("A", "1 1 1", "0 0 0", kBounces) + box("B", "1 1 1", "10 0 0") + box("C", "1 1 1", "0 0 20") +
                interest("A", "\"B\" \"C\""));
  MotionWorld world(*w.model, sim(0s), MotionWorld::Watched::kNone);
  world.watch_by([](const CollisionPair&) { return true; });
  world.declare(w["A"], Role::kPredicted);
  world.advance(sim(1s));
  const auto next = edited_model(*w.model, sets(w.scene, w["B"], "translation", "5 0 0"));
  (void)world.change_scene(*next, {sim(1s), [](ObjectId) { return false; }, [](ObjectId) { return Role::kScene; }});
  EXPECT_EQ(world.known_pairs().size(), 1u);
  EXPECT_EQ(world.objects(), std::vector{w["B"]}) << "nobody has asked for the other ones";
  world.set_base(w["A"], sim(1s), moving({0, 0, 0}, {2, 0, 0}));
  std::vector<ContactEvent> contacts;
  world.advance(sim(2900ms));
  EXPECT_TRUE(standing(world, contacts).empty());
  world.advance(sim(3100ms));
  EXPECT_EQ(standing(world, contacts).size(), 1u);
}

// An edit of the past moves a wall to where BALL has come by since then, which stands elsewhere now. It is known in
// time, or late.
TEST(SceneChangeOnce, FindsWhatCameBySinceThen) {
  const World w(box("BALL", "1 1 1", "0 0 0", kBounces) + box("WALL", "1 9 9", "10 50 0") +
                interest("BALL", "\"WALL\""));
  const ObjectId ball = w["BALL"];
  const auto next = edited_model(*w.model, sets(w.scene, w["WALL"], "translation", "10 0 0"));
  const auto met = [&](Duration known) {
    MotionWorld world(*w.model, sim(0s));
    world.replay_bases();
    world.declare(ball, Role::kPredicted);
    world.set_base(ball, sim(0s), moving({0, 0, 0}, {10, 0, 0}));
    std::vector<ContactEvent> contacts;
    for (Duration t{0}; t <= 4s; t += 50ms) {
      if (t == 2s) world.set_base(ball, sim(2s), moving({20, 0, 0}));
      world.advance(sim(t));
      if (t != known) continue;
      (void)world.change_scene(
          *next, {sim(500ms), [&](ObjectId object) { return object == ball; }, [](ObjectId) { return Role::kScene; }});
    }
    return standing(world, contacts);
  };
  const std::vector<SimTime> in_time = met(500ms);
  ASSERT_FALSE(in_time.empty());
  EXPECT_NEAR(to_seconds(in_time.front() - sim(0s)), 0.9, 1e-6);
  EXPECT_EQ(met(3s), in_time);
}

// Bodies that an edit leaves as they are are shared, so that it costs no more than what it changes.
TEST(SceneChangeOnce, SharesTheBodiesThatStay) {
  const World w(corridor());
  const auto next = edited_model(*w.model, sets(w.scene, w["RIGHT"], "scale", "2 1 1"));
  EXPECT_EQ(next->body(w["LEFT"])->surface, w.model->body(w["LEFT"])->surface);
  EXPECT_EQ(next->body(w["BALL"])->surface, w.model->body(w["BALL"])->surface);
  EXPECT_NE(next->body(w["RIGHT"])->surface, w.model->body(w["RIGHT"])->surface);
}

// Random edits, known at once or late: the same contacts and states, to the last bit.
TEST(SceneChangeOnce, LateKnowledgeGivesTheSame) {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    std::mt19937 random(seed);
    const auto draw = [&](double from, double to) { return std::uniform_real_distribution(from, to)(random); };
    const auto number = [&](double from, double to) { return std::to_string(draw(from, to)); };
    const World w(corridor());
    const KinematicState ball = moving({draw(-1, 1), 0, 0}, {draw(-9, 9), draw(-1, 1), draw(-1, 1)});
    const ObjectId wall = draw(0, 1) < 0.5 ? w["LEFT"] : w["RIGHT"];
    const Edit edits[] = {removes(wall), sets(w.scene, wall, "scale", number(0.5, 2) + " 1 1"),
                          sets(w.scene, wall, "rotation", "0 0 1 " + number(-0.3, 0.3)),
                          sets(w.scene, wall, "translation", number(4, 6) + " 0 0"),
                          adds(box("NEW", "1 1 1", number(-2, 2) + " 2 0"))};
    const Edit& edit = edits[random() % 5];
    const Duration at = seconds(draw(0.5, 2));
    const Lived in_time = live(w, ball, edit, at, at, 4s), late = live(w, ball, edit, at, at + seconds(draw(0, 2)), 4s);
    EXPECT_EQ(in_time.contacts, late.contacts) << "seed " << seed;
    EXPECT_TRUE(same_bits(in_time.ball, late.ball)) << "seed " << seed;
  }
}

}  // namespace peerd::replication::scene_change_test
