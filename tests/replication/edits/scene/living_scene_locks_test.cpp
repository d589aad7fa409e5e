// Locks of a LivingScene: what they keep from whom, whatever comes in what order.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "core/scene/reader.hpp"
#include "core/vrml/document.hpp"
#include "core/writer/writer.hpp"
#include "replication/edits/scene/living_scene.hpp"

namespace peerd::replication::living_scene_locks_test {

const std::string kHead = "#VRML V2.0 utf8\n";
const std::string kTown = kHead + R"(DEF YARD Transform { children DEF SHED Transform { children [
  DEF CAR Transform { children Shape { appearance Appearance { material DEF PAINT Material { } } geometry Box { } } }
  DEF CLOCK TimeSensor { } DEF WAY PositionInterpolator { } ] } }
DEF FIELD Transform { children DEF COW Transform { } }
DEF SUN TimeSensor { }
)";
constexpr AuthorId kAda{7}, kBob{9}, kCy{11};
const std::string kByAda = "it is locked by author 7";

Scene read(const std::string& text) {
  ReadResult result = read_world(text);
  EXPECT_TRUE(result.scene) << text;
  return std::move(result.scene).value_or(Scene{});
}

std::string text_of(const LivingScene& living) {
  const auto written = write_world(*living.scene());
  EXPECT_TRUE(written);
  std::string text = written ? written->text : "";
  for (const auto& [object, owner] : living.owners()) {
    text += std::to_string(object.packed()) + " is of " + std::to_string(owner.value) + "\n";
  }
  for (const vrml::Node& node : living.scene()->document->nodes) {
    const auto index = static_cast<std::uint32_t>(&node - living.scene()->document->nodes.data());
    const NodeId id = living.scene()->document->ids.id_of(index);
    for (const std::string& key : living.data().keys(id)) text += key + "=" + *living.data().find(id, key) + "\n";
  }
  return text;
}

// A town whose operations have their authors' numbers and stamps one after the other.
class Town {
 public:
  explicit Town(WriterOf writer_of = writer_without_key) : living(file, {}, {}, std::move(writer_of)) {}

  [[nodiscard]] ObjectId object(const std::string& path) const { return file.find(path).value(); }
  [[nodiscard]] NodeId node(const std::string& name) const {
    for (std::uint32_t i = 0; i < file.document->nodes.size(); ++i) {
      if (file.document->nodes[i].def == name) return file.document->ids.id_of(i);
    }
    ADD_FAILURE() << "the town has no " << name;
    return {};
  }
  [[nodiscard]] Operation made(AuthorId author, OperationBody body) {
    stamp_ += std::chrono::milliseconds(10);
    return {{author, ++numbers_[author]}, stamp_, std::move(body)};
  }
  // Why the operation changes nothing; empty: it does what it says.
  std::string outcome(AuthorId author, OperationBody body) { return outcome(made(author, std::move(body))); }
  std::string outcome(const Operation& operation) {
    living.add(operation);
    apply();
    return outcomes.at(operation.id);
  }
  // The same, as its author is told before it makes the operation.
  std::string refusal(AuthorId author, OperationBody body) {
    const auto draft = living.draft(std::move(body), author);
    return draft ? "" : draft.error();
  }
  void apply() {
    while (const auto change = living.apply(SimTime::max(), SimTime::min())) {
      for (const auto& each : change->outcomes) outcomes[each.id] = each.refused;
    }
  }
  std::string undo(AuthorId author, bool redoes = false) {
    const auto next = living.next_undo(author, redoes, SimTime::max());
    return next ? outcome(author, next->undo) : next.error();
  }

  const Scene file = read(kTown);
  LivingScene living;
  std::map<OperationId, std::string> outcomes;

 private:
  SimTime stamp_{};
  std::map<AuthorId, std::uint32_t> numbers_;
};

template <class OfTest>
std::string name_of(const testing::TestParamInfo<OfTest>& of) {
  return of.param.name;
}

struct Case {
  const char* name;
  bool is_kept;  // from all but who has locked the SHED
  std::function<OperationBody(const Town&)> body;
};
class LockKeeps : public testing::TestWithParam<Case> {};

TEST_P(LockKeeps, OthersAndNotItsWriter) {
  const auto& [name, is_kept, body] = GetParam();
  for (const AuthorId author : {kAda, kBob}) {
    Town town;
    EXPECT_EQ(town.outcome(kAda, LockObject{town.object("YARD/SHED")}), "");
    const std::string before = text_of(town.living), expected = is_kept && author == kBob ? kByAda : "";
    const Locks locks = town.living.locks();
    EXPECT_EQ(town.refusal(author, body(town)), expected);
    EXPECT_EQ(town.outcome(author, body(town)), expected) << "as from a member who asks nobody";
    if (expected.empty()) continue;
    EXPECT_EQ(text_of(town.living), before);
    EXPECT_EQ(town.living.locks(), locks);
    EXPECT_EQ(town.outcome(kBob, LockObject{town.object("YARD/SHED"), true}), "");
    EXPECT_EQ(town.outcome(author, body(town)), "");
  }
}

ObjectId shed(const Town& t) { return t.object("YARD/SHED"); }
ObjectId car(const Town& t) { return t.object("YARD/SHED/CAR"); }
AddNodes adding(std::optional<ObjectId> parent, std::uint32_t first = 0) {
  return {parent, {}, kHead + "Transform { }\n", first, first, {}};
}

MoveObject moving(ObjectId object, std::optional<ObjectId> into) { return {object, into, {}}; }
SetField setting(NodeId node, const char* field, const char* value) { return {node, field, value, 0}; }
SetData datum(NodeId node) { return {node, "k", "v"}; }
ChangeRoute route(NodeId from, NodeId to, const char* out, const char* in) { return {from, to, out, in}; }
GiveObject giving(ObjectId object) { return {object, PeerId{3}, kNobody, {}}; }
RequestObject requesting(ObjectId object) { return {object, PeerId{1}, PeerId{2}}; }
PlaceObject placing(ObjectId object) { return {object, PeerId{3}, {}, {{1, 2, 3}, {}}}; }
SendMessage message() { return {PeerId{2}, "chat", "hello"}; }

const std::vector<Case> kCases{
    Case{"AddBelow", true, [](const Town& t) { return adding(shed(t)); }},
    Case{"AddDeepBelow", true, [](const Town& t) { return adding(car(t)); }},
    Case{"AddAbove", false, [](const Town& t) { return adding(t.object("YARD")); }},
    Case{"AddElsewhere", false, [](const Town&) { return adding({}); }},
    Case{"RemoveIt", true, [](const Town& t) { return RemoveObject{shed(t)}; }},
    Case{"RemoveBelow", true, [](const Town& t) { return RemoveObject{car(t)}; }},
    Case{"RemoveAbove", true, [](const Town& t) { return RemoveObject{t.object("YARD")}; }},
    Case{"RemoveElsewhere", false, [](const Town& t) { return RemoveObject{t.object("FIELD/COW")}; }},
    Case{"RemoveNodeBelow", true, [](const Town& t) { return RemoveNode{t.node("CLOCK")}; }},
    Case{"RemoveNodeElsewhere", false, [](const Town& t) { return RemoveNode{t.node("SUN")}; }},
    Case{"MoveIt", true, [](const Town& t) { return moving(shed(t), {}); }},
    Case{"MoveOut", true, [](const Town& t) { return moving(car(t), t.object("FIELD")); }},
    Case{"MoveIn", true, [](const Town& t) { return moving(t.object("FIELD"), shed(t)); }},
    Case{"MoveWithin", true, [](const Town& t) { return moving(car(t), shed(t)); }},
    Case{"MoveAround", false, [](const Town& t) { return moving(t.object("YARD"), t.object("FIELD")); }},
    Case{"SetIt", true, [](const Town& t) { return setting(t.node("SHED"), "translation", "1 0 0"); }},
    Case{"SetDeepBelow", true, [](const Town& t) { return setting(t.node("PAINT"), "shininess", "1"); }},
    Case{"SetAbove", false, [](const Town& t) { return setting(t.node("YARD"), "translation", "1 0 0"); }},
    Case{"RouteFrom", true, [](const Town& t) { return route(t.node("CLOCK"), t.node("SUN"), "isActive", "enabled"); }},
    Case{"RouteTo", true,
         [](const Town& t) { return route(t.node("SUN"), t.node("WAY"), "fraction_changed", "set_fraction"); }},
    Case{"DataOfIt", true, [](const Town& t) { return datum(t.node("SHED")); }},
    Case{"DataBelow", true, [](const Town& t) { return datum(t.node("CAR")); }},
    Case{"DataElsewhere", false, [](const Town& t) { return datum(t.node("COW")); }},
    Case{"Give", true, [](const Town& t) { return giving(car(t)); }},
    Case{"GiveAbove", false, [](const Town& t) { return giving(t.object("YARD")); }},
    Case{"Request", true, [](const Town& t) { return requesting(car(t)); }},
    Case{"Place", true, [](const Town& t) { return placing(car(t)); }},
    Case{"LockBelow", true, [](const Town& t) { return LockObject{car(t)}; }},
    Case{"LockAbove", true, [](const Town& t) { return LockObject{t.object("YARD")}; }},
    Case{"LockElsewhere", false, [](const Town& t) { return LockObject{t.object("FIELD")}; }},
    Case{"Message", false, [](const Town&) { return message(); }}};

INSTANTIATE_TEST_SUITE_P(Table, LockKeeps, testing::ValuesIn(kCases), name_of<Case>);

TEST(LivingSceneLocks, SayWhatCannotBeLocked) {
  Town town;
  EXPECT_EQ(town.outcome(kAda, LockObject{car(town), true}), "it is not locked");
  EXPECT_EQ(town.outcome(kAda, LockObject{ObjectId{77}}), "it is not in the scene any more");
  EXPECT_EQ(town.outcome(kAda, LockObject{car(town)}), "");
  EXPECT_EQ(town.outcome(kAda, LockObject{car(town)}), "it is locked already");
  EXPECT_EQ(town.outcome(kAda, LockObject{shed(town)}), "") << "what is in it is its own";
  EXPECT_EQ(town.living.lock_around(car(town)), car(town));
  EXPECT_EQ(town.living.lock_around(shed(town)), shed(town));
  EXPECT_EQ(town.living.lock_around(town.object("YARD")), std::nullopt);
  EXPECT_EQ(town.outcome(kAda, RemoveObject{shed(town)}), "");
  EXPECT_TRUE(town.living.locks().empty()) << "it is gone with what was locked";
  EXPECT_EQ(town.undo(kAda), "");
  EXPECT_EQ(town.living.locks().size(), 2u);
  EXPECT_EQ(town.outcome(kBob, RemoveObject{shed(town)}), kByAda);
}

TEST(LivingSceneLocks, AreNotManyAtOnce) {
  Town town;
  std::uint32_t next = 0;
  for (; next < kLocksMax; ++next) {
    EXPECT_EQ(town.outcome(kAda, adding({}, next)), "");
    EXPECT_EQ(town.outcome(kAda, LockObject{ObjectId{next, kAda.value}}), "");
  }
  EXPECT_EQ(town.outcome(kBob, LockObject{car(town)}), "no more than 256 objects are locked at once");
  EXPECT_EQ(town.outcome(kBob, LockObject{ObjectId{3, kAda.value}, true}), "");
  EXPECT_EQ(town.outcome(kBob, LockObject{car(town)}), "");
}

TEST(LivingSceneLocks, AreOfAUserAndNotOfOneOfItsPeers) {
  Town town([](AuthorId author) {
    return author == kCy ? Writer{.user = "bob", .name = "bob"} : Writer{.user = "ada", .name = "ada"};
  });
  EXPECT_EQ(town.outcome(kAda, LockObject{car(town)}), "");
  EXPECT_EQ(town.outcome(kBob, SetData{town.node("CAR"), "k", "v"}), "") << "another peer of that user";
  EXPECT_EQ(town.outcome(kCy, SetData{town.node("CAR"), "k", "v"}), "it is locked by ada");
  EXPECT_EQ(town.living.why_locked(car(town), kCy), "it is locked by ada");
  EXPECT_EQ(town.living.why_locked(car(town), kBob), "");
  EXPECT_EQ(town.living.why_locked(town.object("FIELD"), kCy), "");
}

// ---- administrators ----

// All know that Ada is an administrator, and later that Cy is one.
class Administrators {
 public:
  [[nodiscard]] WriterOf writer_of() {
    return [this](AuthorId author) {
      const bool is_one = all.contains(author);
      return Writer{.user = std::to_string(author.value), .may_lock = is_one, .overrules = is_one};
    };
  }
  std::set<AuthorId> all{kAda};
};

TEST(LivingSceneLocks, OfAdministratorsKeepAllOthersFromIt) {
  Administrators administrators;
  administrators.all.insert(kCy);
  Town town(administrators.writer_of());
  EXPECT_EQ(town.outcome(kBob, LockObject{car(town)}), "administrators alone lock and unlock");
  EXPECT_EQ(town.outcome(kAda, LockObject{car(town)}), "");
  EXPECT_EQ(town.outcome(kBob, LockObject{car(town), true}), "administrators alone lock and unlock");
  EXPECT_EQ(town.outcome(kBob, SetData{town.node("CAR"), "k", "v"}), kByAda);
  EXPECT_EQ(town.outcome(kCy, SetData{town.node("CAR"), "k", "v"}), "") << "another administrator";
  EXPECT_EQ(town.outcome(kCy, LockObject{car(town), true}), "");
  EXPECT_EQ(town.outcome(kBob, SetData{town.node("CAR"), "k", "w"}), "");
}

TEST(LivingSceneLocks, WhoBecomesKnownAsAnAdministratorHasBeenOneBefore) {
  Administrators known, late;
  known.all.insert(kCy);
  Town first(known.writer_of()), second(late.writer_of());
  std::vector<Operation> all;
  all.push_back(first.made(kAda, LockObject{car(first)}));
  all.push_back(first.made(kBob, SetData{first.node("CAR"), "k", "bob"}));
  all.push_back(first.made(kCy, SetData{first.node("CAR"), "l", "cy"}));
  all.push_back(first.made(kCy, LockObject{car(first), true}));
  all.push_back(first.made(kBob, SetData{first.node("CAR"), "m", "bob"}));
  for (const Operation& each : all) {
    (void)first.outcome(each);
    (void)second.outcome(each);
  }
  EXPECT_NE(text_of(second.living), text_of(first.living));
  EXPECT_EQ(second.outcomes.at(all[2].id), kByAda);
  second.living.follow_writers();
  EXPECT_FALSE(second.living.apply(SimTime::max(), SimTime::min())) << "nothing is new";
  late.all.insert(kCy);
  second.living.follow_writers();
  EXPECT_EQ(second.refusal(kBob, SetData{second.node("CAR"), "n", "bob"}), "");
  second.apply();
  EXPECT_EQ(text_of(second.living), text_of(first.living));
  EXPECT_EQ(second.outcomes, first.outcomes);
  EXPECT_TRUE(second.living.locks().empty());
}

// ---- undo ----

TEST(LivingSceneLocks, AreUndoneByTheirAuthorsAlone) {
  Town town;
  EXPECT_EQ(town.outcome(kAda, LockObject{car(town)}), "");
  const Operation refused = town.made(kBob, SetData{town.node("CAR"), "k", "v"});
  EXPECT_EQ(town.outcome(refused), kByAda);
  EXPECT_EQ(town.undo(kBob), "others have changed since what it had changed") << "its own is not in force";
  EXPECT_EQ(town.undo(kAda), "");
  EXPECT_TRUE(town.living.locks().empty());
  EXPECT_EQ(town.outcomes.at(refused.id), "") << "as if it had never been locked";
  // To lock it again from then on would make void what others have done since.
  EXPECT_EQ(town.undo(kAda, true), "this peer has undone nothing since its last edit");
  const auto lock = SimTime{} + std::chrono::milliseconds(10);
  EXPECT_EQ(town.outcome(kAda, UndoOperation{1, lock, true}), "its author has made no such edit");
  const Operation again = town.made(kAda, LockObject{car(town)});
  EXPECT_EQ(town.outcome(again), "");
  const Operation unlock = town.made(kAda, LockObject{car(town), true});
  EXPECT_EQ(town.outcome(unlock), "");
  EXPECT_EQ(town.outcome(kAda, UndoOperation{unlock.id.number, unlock.stamp}), "its author has made no such edit");
  EXPECT_TRUE(town.living.locks().empty());
}

struct UndoCase {
  const char* name;
  std::function<OperationBody(const Town&)> body;  // that Bob makes, and undoes
};
class LockKeepsFromUndo : public testing::TestWithParam<UndoCase> {};

TEST_P(LockKeepsFromUndo, WhatWasDoneBefore) {
  for (const bool redoes : {false, true}) {
    Town town;
    const Operation edit = town.made(kBob, GetParam().body(town));
    ASSERT_EQ(town.outcome(edit), "");
    if (redoes) {
      ASSERT_EQ(town.undo(kBob), "");
    }
    ASSERT_EQ(town.outcome(kAda, LockObject{shed(town)}), "");
    const std::string before = text_of(town.living);
    EXPECT_EQ(town.undo(kBob, redoes), kByAda) << "refused at once";
    const Operation undo = town.made(kBob, UndoOperation{edit.id.number, edit.stamp, redoes});
    EXPECT_EQ(town.outcome(undo), kByAda) << "as from a member who asks nobody";
    EXPECT_EQ(text_of(town.living), before);
    EXPECT_EQ(town.undo(kBob, redoes), kByAda) << "the other one counts as none";
    ASSERT_EQ(town.outcome(kAda, LockObject{shed(town), true}), "");
    EXPECT_EQ(text_of(town.living), before);
    EXPECT_EQ(town.undo(kBob, redoes), "");
    EXPECT_NE(text_of(town.living), before);
  }
}

const std::vector<UndoCase> kUndoCases{
    UndoCase{"Add", [](const Town& t) { return adding(car(t)); }},
    UndoCase{"Remove", [](const Town& t) { return RemoveObject{car(t)}; }},
    UndoCase{"RemoveNode", [](const Town& t) { return RemoveNode{t.node("CLOCK")}; }},
    UndoCase{"MoveOut", [](const Town& t) { return moving(car(t), t.object("FIELD")); }},
    UndoCase{"MoveIn", [](const Town& t) { return moving(t.object("FIELD"), shed(t)); }},
    UndoCase{"Set", [](const Town& t) { return setting(t.node("PAINT"), "shininess", "1"); }},
    UndoCase{"Route",
             [](const Town& t) { return route(t.node("SUN"), t.node("WAY"), "fraction_changed", "set_fraction"); }},
    UndoCase{"Data", [](const Town& t) { return datum(t.node("CAR")); }}};

INSTANTIATE_TEST_SUITE_P(Table, LockKeepsFromUndo, testing::ValuesIn(kUndoCases), name_of<UndoCase>);

// What others have added stands in what is locked by now: its author can't take it away.
TEST(LivingSceneLocks, KeepWhatTheirWriterHasMovedIn) {
  Town town;
  const Operation add = town.made(kBob, adding({}));
  ASSERT_EQ(town.outcome(add), "");
  ASSERT_EQ(town.outcome(kAda, LockObject{shed(town)}), "");
  EXPECT_EQ(town.outcome(kBob, UndoOperation{add.id.number, add.stamp}), "") << "it stands elsewhere";
  EXPECT_EQ(town.outcome(kBob, UndoOperation{add.id.number, add.stamp, true}), "");
  ASSERT_EQ(town.outcome(kAda, MoveObject{ObjectId{0, kBob.value}, car(town), {}}), "");
  EXPECT_EQ(town.undo(kBob), kByAda);
  EXPECT_EQ(town.outcome(kBob, UndoOperation{add.id.number, add.stamp}), kByAda);
  EXPECT_TRUE(town.living.scene()->contains(ObjectId{0, kBob.value}));
}

// ---- any operations, in any order ----

class AnyWriters {
 public:
  explicit AnyWriters(std::uint64_t seed) : random_(seed) {}

  void make(int count) {
    for (int k = 0; k < count; ++k) {
      const std::size_t i = draw(3);
      stamp_ += std::chrono::milliseconds(draw(4));  // those of two authors may be equal
      logs[i].push_back({{kAuthors[i], static_cast<std::uint32_t>(logs[i].size() + 1)}, stamp_, body(i)});
      all.push_back(logs[i].back());
    }
  }
  std::uint64_t draw(std::uint64_t n) { return random_() % n; }

  static constexpr AuthorId kAuthors[3]{kAda, kBob, kCy};
  std::vector<Operation> all;
  std::vector<Operation> logs[3];

 private:
  OperationBody body(std::size_t i) {
    const auto object = [&] {
      const std::uint64_t n = draw(8);
      return n < 5 ? ObjectId{static_cast<std::uint32_t>(n)}
                   : ObjectId{static_cast<std::uint32_t>(draw(6)), kAuthors[draw(3)].value};
    };
    const NodeId node{static_cast<std::uint32_t>(draw(9))};
    switch (draw(11)) {
      case 0:
        return draw(3) == 0 ? OperationBody(RemoveObject{object()}) : OperationBody(RemoveNode{node});
      case 1:
        return MoveObject{object(), object(), {}};
      case 2:
        return adding(object(), next_[i]++);
      case 3:
        return SetData{node, "k", std::to_string(draw(100))};
      case 4:
        return GiveObject{object(), PeerId{static_cast<std::uint32_t>(1 + draw(3))}, kNobody, {}};
      case 5:
      case 6:
        return LockObject{object()};
      case 7:
        return LockObject{object(), true};
      case 8:
      case 9:
        if (!logs[i].empty()) {
          const Operation& target = logs[i][logs[i].size() - 1 - draw(std::min<std::size_t>(logs[i].size(), 9))];
          return UndoOperation{target.id.number, target.stamp, draw(4) == 0};
        }
        [[fallthrough]];
      default:
        return SetField{node, "translation", std::to_string(draw(100)) + " 0 0", 0};
    }
  }

  std::mt19937_64 random_;
  SimTime stamp_{};
  std::uint32_t next_[3] = {};
};

TEST(LivingSceneLocks, AreTheSameInAnyOrder) {
  std::map<std::string, std::size_t> reasons;
  std::size_t undos_kept = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(seed);
    AnyWriters writers(seed);
    writers.make(80);
    Town in_order, at_once, any_order;
    for (const Operation& o : writers.all) {
      (void)in_order.outcome(o);
      at_once.living.add(o);
    }
    at_once.apply();
    std::size_t taken[3] = {};
    for (std::size_t k = 0; k < writers.all.size();) {
      const std::size_t i = writers.draw(3);
      if (taken[i] == writers.logs[i].size()) continue;
      any_order.living.add(writers.logs[i][taken[i]++]);
      ++k;
      if (writers.draw(3) == 0) any_order.apply();
      if (writers.draw(9) == 0) (void)any_order.living.next_undo(kBob, writers.draw(2) == 0, SimTime::max());
      if (writers.draw(9) == 0) (void)any_order.refusal(kBob, adding({}, 1000));
    }
    any_order.apply();
    const std::string expected = text_of(in_order.living);
    EXPECT_EQ(text_of(at_once.living), expected);
    EXPECT_EQ(text_of(any_order.living), expected);
    EXPECT_EQ(at_once.living.locks(), in_order.living.locks());
    EXPECT_EQ(any_order.living.locks(), in_order.living.locks());
    // A scene that never had what is undone, nor the undos that count.
    Town without;
    std::set<OperationId> undone;
    for (const Operation& o : writers.all) {
      const auto* const undo = std::get_if<UndoOperation>(&o.body);
      if (undo == nullptr) continue;
      const std::string& why = any_order.outcomes.at(o.id);
      EXPECT_EQ(why.empty(), at_once.outcomes.at(o.id).empty());
      if (!why.empty() && why != "its author has made no such edit") ++undos_kept;
      if (!why.empty()) continue;
      if (undo->redoes) {
        undone.erase({o.id.author, undo->number});
      } else {
        undone.insert({o.id.author, undo->number});
      }
    }
    for (const Operation& o : writers.all) {
      if (!std::holds_alternative<UndoOperation>(o.body) && !undone.contains(o.id)) without.living.add(o);
    }
    without.apply();
    EXPECT_EQ(text_of(without.living), expected);
    for (const auto& [id, why] : without.outcomes) {
      ++reasons[why];
      EXPECT_EQ(any_order.outcomes.at(id), why);
      EXPECT_EQ(at_once.outcomes.at(id), why);
    }
    if (HasFailure()) FAIL() << "seed " << seed;
  }
  EXPECT_GT(undos_kept, 100u);
  for (const char* const why : {"", "it is locked by author 7", "it is locked by author 9", "it is locked already"}) {
    EXPECT_GT(reasons[why], 100u) << why;
  }
}

}  // namespace peerd::replication::living_scene_locks_test
