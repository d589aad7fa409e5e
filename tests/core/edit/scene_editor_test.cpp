#include "core/edit/scene_editor.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "core/writer/scene_difference.hpp"
#include "core/writer/writer.hpp"
#include "tests/core/document_violation.hpp"

namespace peerd::scene_editor_test {
namespace {

constexpr ObjectId kFirstObject{1, 7};
constexpr NodeId kFirstNode{1, 7};

const std::string kHead = "#VRML V2.0 utf8\n";
const std::string kCar =
    "DEF CAR Transform { translation 1 0 0 children [ DEF WHEEL Transform { children Shape { geometry Sphere { } } } "
    "Shape { geometry Box { } } ] }\n";
const std::string kWall = "DEF WALL Transform { translation 9 0 0 children Shape { geometry Box { size 1 4 9 } } }\n";
const std::string kClock =
    "DEF T TimeSensor { loop TRUE } DEF P PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 4 0 0 ] }\n";

Scene read(const std::string& text) {
  ReadResult result = read_world(text);
  EXPECT_TRUE(result.scene) << text << (result.diagnostics.empty() ? "" : render(result, result.diagnostics[0]));
  return std::move(result.scene).value_or(Scene{});
}

// The edited scene is what its own text gives, and what a text with the changes in it gives.
void expect_like(const Scene& edited, const std::string& text) {
  EXPECT_EQ(difference(read(text), edited), "") << text;
  EXPECT_EQ(vrml::document_violation(*edited.document), "");
  const auto written = write_world(edited);
  ASSERT_TRUE(written) << written.error();
  EXPECT_EQ(difference(edited, read(written->text)), "") << written->text;
}

Scene finished(SceneEditor& editor) {
  auto scene = editor.finish();
  EXPECT_TRUE(scene) << scene.error();
  return std::move(scene).value_or(Scene{});
}

TEST(SceneEditor, AddsWhatAFileWouldHave) {
  const Scene world = read(kHead + kWall);
  SceneEditor editor(world);
  const auto added = editor.add(kHead + kCar, {}, {kFirstObject, kFirstNode}, {});
  ASSERT_TRUE(added) << added.error();
  EXPECT_EQ(added->objects, 4u);
  const Scene edited = finished(editor);
  expect_like(edited, kHead + kWall + kCar);
  EXPECT_EQ(edited.path_of(ObjectId(0)), "WALL");
  EXPECT_EQ(edited.path_of(ObjectId(1, 7)), "CAR");
  EXPECT_EQ(edited.path_of(ObjectId(2, 7)), "CAR/WHEEL");
  EXPECT_EQ(edited.find("CAR"), ObjectId(1, 7));
  EXPECT_FALSE(edited.contains(ObjectId(5, 7)));
}

TEST(SceneEditor, SetsFieldsOfNodesOfAllKinds) {
  const Scene world = read(kHead + kCar);
  const auto node_of = [](const Scene& scene, const char* path) {
    return scene.document->ids.id_of(scene.at(*scene.find(path)).node);
  };
  SceneEditor editor(world);
  ASSERT_TRUE(editor.set(node_of(world, "CAR"), "translation", "1 2 3", {}));
  ASSERT_TRUE(editor.set(node_of(world, "CAR/1"), "geometry", "Cone { height 3 }", NodeId(1, 7)));
  const Scene edited = finished(editor);
  const std::string now =
      "DEF CAR Transform { translation 1 2 3 children [ DEF WHEEL Transform { children Shape { geometry Sphere { } } } "
      "Shape { geometry Cone { height 3 } } ] }";
  expect_like(edited, kHead + now);
  EXPECT_EQ(edited.transform(*edited.find("CAR")).translation, Vec3(1, 2, 3));

  SceneEditor again(edited);  // a value that an edit has set outlives the scene that it was set in
  ASSERT_TRUE(again.set(node_of(edited, "CAR"), "scale", "2 2 2", {}));
  ASSERT_TRUE(again.set(NodeId(1, 7), "height", "5", {}));
  const Scene later = finished(again);
  expect_like(later, kHead +
                         "DEF CAR Transform { translation 1 2 3 scale 2 2 2 children [ DEF WHEEL Transform { children "
                         "Shape { geometry Sphere { } } } Shape { geometry Cone { height 5 } } ] }");
}

TEST(SceneEditor, WhatAnInterestNamesStaysWhatItWas) {
  const std::string interests =
      "CollisionInterest { objectPath \"0\" interests [ \"1\", \"WHEEL\" ] collisionType 1 }\n"
      "KeySensor { recipient \"1\" keyValue 65 value 0 0 1 }\n";
  const Scene world = read(kHead + kCar + kWall + interests);
  const ObjectId car = *world.find("CAR"), wall = *world.find("WALL"), wheel = *world.find("WHEEL");
  SceneEditor editor(world);
  ASSERT_TRUE(editor.add(kHead + "DEF WHEEL Group { }", {{}, car}, {kFirstObject, kFirstNode}, {}));
  const Scene edited = finished(editor);
  ASSERT_EQ(edited.interests.size(), 1u);
  EXPECT_EQ(edited.interests[0].colliders.ends.front(), car);
  EXPECT_EQ(edited.interests[0].collidees.ends, (std::vector{wall, wheel}));
  EXPECT_EQ(edited.key_sensors[0].recipient, wall);
  expect_like(edited,
              kHead + "DEF WHEEL Group { }" + kCar + kWall +
                  "CollisionInterest { objectPath \"CAR\" interests [ \"WALL\", \"CAR/WHEEL\" ] collisionType 1 }"
                  "KeySensor { recipient \"WALL\" keyValue 65 value 0 0 1 }");

  SceneEditor without(edited);
  ASSERT_TRUE(without.remove(wall));
  const Scene rest = finished(without);
  ASSERT_EQ(rest.interests.size(), 1u);
  EXPECT_EQ(rest.interests[0].collidees.ends, std::vector{wheel});
  EXPECT_EQ(rest.key_sensors[0].recipient, std::nullopt);

  SceneEditor last(rest);
  ASSERT_TRUE(last.remove(wheel));
  EXPECT_TRUE(finished(last).interests.empty());
}

TEST(SceneEditor, WhatAPatternFindsFollowsTheScene) {
  const std::string crates = "DEF CRATES Group { children [ DEF A Transform { } DEF B Transform { } ] }\n";
  const std::string interest =
      "CollisionInterest { objectPath \"CRATES/*\" interests [ \"WALL\", \"CRATES/*\" ] except [ \"CRATES/B\" ] }\n";
  const Scene world = read(kHead + crates + kWall + interest);
  const ObjectId group = *world.find("CRATES"), a = *world.find("CRATES/A"), wall = *world.find("WALL");
  EXPECT_EQ(world.interests[0].colliders.ends, std::vector{a});
  SceneEditor editor(world);
  ASSERT_TRUE(editor.add(kHead + "DEF C Transform { }", {group, {}}, {kFirstObject, kFirstNode}, {}));
  const Scene edited = finished(editor);
  const ObjectId c = *edited.find("CRATES/C");
  ASSERT_EQ(edited.interests.size(), 1u);
  EXPECT_EQ(edited.interests[0].colliders.ends, (std::vector{a, c}));
  EXPECT_EQ(edited.interests[0].collidees.ends, (std::vector{wall, a, c}));

  SceneEditor without(edited);  // what it names exactly is gone, and what it finds is not there yet again
  for (const ObjectId gone : {wall, a, c}) ASSERT_TRUE(without.remove(gone));
  const Scene rest = finished(without);
  expect_like(rest, kHead + "DEF CRATES Group { children DEF B Transform { } }" +
                        "CollisionInterest { objectPath \"CRATES/*\" interests \"CRATES/*\" except \"CRATES/B\" }");
  ASSERT_EQ(rest.interests.size(), 1u);

  SceneEditor last(rest);
  ASSERT_TRUE(last.remove(group));
  EXPECT_TRUE(finished(last).interests.empty());
}

TEST(SceneEditor, AnInterestIsOfTheTypeThatIsSet) {
  const Scene world = read(kHead + kCar + kWall + "DEF I CollisionInterest { objectPath \"CAR\" interests \"WALL\" }");
  const std::uint32_t node = world.interests[0].node;
  EXPECT_EQ(world.interests[0].type, CollisionType::kBox);
  SceneEditor editor(world);
  ASSERT_TRUE(editor.set(world.document->ids.id_of(node), "collisionType", "2", {}));
  EXPECT_EQ(finished(editor).interests[0].type, CollisionType::kAllPairs);
  SceneEditor wrong(world);
  ASSERT_TRUE(wrong.set(world.document->ids.id_of(node), "collisionType", "3", {}));
  EXPECT_TRUE(wrong.may_fail());
  EXPECT_FALSE(wrong.finish());
}

TEST(SceneEditor, ATextNamesWhatIsAroundIt) {
  const Scene world = read(kHead + kWall);
  const std::string text = kHead + kCar + "CollisionInterest { objectPath \"CAR\" interests \"WALL\" }";
  SceneEditor editor(world);
  EXPECT_FALSE(editor.add(text, {}, {kFirstObject, kFirstNode}, {}));
  const auto around = [&](std::string_view path) { return world.find(path); };
  ASSERT_TRUE(editor.add(text, {}, {kFirstObject, kFirstNode}, {}, around));
  const Scene edited = finished(editor);
  ASSERT_EQ(edited.interests.size(), 1u);
  EXPECT_EQ(edited.interests[0].colliders.ends.front(), ObjectId(1, 7));
  EXPECT_EQ(edited.interests[0].collidees.ends, std::vector{*world.find("WALL")});
  expect_like(edited, kHead + kWall + kCar + "CollisionInterest { objectPath \"CAR\" interests \"WALL\" }");
}

TEST(SceneEditor, RoutesComeAndGoWithTheirNodes) {
  const std::string routes = "ROUTE T.fraction_changed TO P.set_fraction\nROUTE P.value_changed TO CAR.translation\n";
  const Scene world = read(kHead + kCar + kClock);
  const auto& ids = world.document->ids;
  const auto named = [&](std::string_view name) {
    const auto it = std::ranges::find(world.document->nodes, name, &vrml::Node::def);
    return ids.id_of(static_cast<std::uint32_t>(it - world.document->nodes.begin()));
  };
  SceneEditor editor(world);
  ASSERT_TRUE(editor.add_route(named("T"), "fraction_changed", named("P"), "set_fraction"));
  ASSERT_TRUE(editor.add_route(named("P"), "value_changed", named("CAR"), "translation"));
  EXPECT_FALSE(editor.add_route(named("P"), "value_changed", named("CAR"), "rotation"));
  EXPECT_FALSE(editor.add_route(named("P"), "key_changed", named("CAR"), "translation"));
  const Scene edited = finished(editor);
  expect_like(edited, kHead + kCar + kClock + routes);

  SceneEditor without(edited);
  ASSERT_TRUE(without.remove(*edited.find("CAR")));
  expect_like(finished(without), kHead + kClock + "ROUTE T.fraction_changed TO P.set_fraction");

  SceneEditor unrouted(edited);
  ASSERT_TRUE(unrouted.remove_route(named("P"), "value_changed", named("CAR"), "translation"));
  ASSERT_TRUE(unrouted.remove(named("T")));
  EXPECT_FALSE(unrouted.remove_route(named("P"), "value_changed", named("CAR"), "translation"));
  expect_like(finished(unrouted),
              kHead + kCar + "DEF P PositionInterpolator { key [ 0 1 ] keyValue [ 0 0 0, 4 0 0 ] }");
}

TEST(SceneEditor, RefusesAndChangesNothing) {
  const std::string text = kHead + "DEF A Transform { children DEF S Shape { geometry Box { } } }\n" +
                           "DEF B Transform { children USE A }\n" +
                           "DEF C Collision { proxy Shape { geometry Box { } } children Group { } }\n";
  const Scene world = read(text);
  const ObjectId a = *world.find("A"), s = *world.find("A/S"), b = *world.find("B"), c = *world.find("C");
  const NodeId node_b = world.document->ids.id_of(world.at(b).node);
  SceneEditor editor(world);
  const SceneEditor::FirstIds ids{kFirstObject, kFirstNode};
  EXPECT_FALSE(editor.add(kHead + "Group { }", {a, {}}, ids, {}));             // A is in two places
  EXPECT_FALSE(editor.add(kHead + "Group { }", {s, {}}, ids, {}));             // a Shape
  EXPECT_FALSE(editor.add(kHead + "Group {", {}, ids, {}));                    // no VRML
  EXPECT_FALSE(editor.add(kHead + "Group { }", {ObjectId(88), {}}, ids, {}));  // no such parent
  EXPECT_FALSE(editor.add(kHead + "Group { }", {b, c}, ids, {}));              // C does not stand in B
  EXPECT_FALSE(editor.remove(s));                                              // in two places
  EXPECT_FALSE(editor.remove(ObjectId(88)));
  EXPECT_FALSE(editor.remove(*world.find("C/1")));  // the proxy
  EXPECT_FALSE(editor.move(b, {b, {}}));
  EXPECT_FALSE(editor.move(b, {{}, b}));
  EXPECT_FALSE(editor.move(c, {*world.find("C/0"), {}}));  // into itself
  EXPECT_FALSE(editor.set(node_b, "translation", "1 2", {}));
  EXPECT_FALSE(editor.set(node_b, "translation", "1 2 3 } Group {", {}));
  EXPECT_FALSE(editor.set(node_b, "translation", "1 2 3 scale 1 1 1", {}));
  EXPECT_FALSE(editor.set(node_b, "children", "Group { }", {}));
  EXPECT_FALSE(editor.set(node_b, "colour", "1 2 3", {}));
  EXPECT_FALSE(editor.set(NodeId(999), "translation", "1 2 3", {}));
  expect_like(finished(editor), text);
}

// Each prototype has the one before it twice.
std::string doubling(int times) {
  std::string text = kHead + "PROTO P0 [ ] { Group { } }\n";
  for (int i = 1; i <= times; ++i) {
    const std::string before = "P" + std::to_string(i - 1) + " { } ";
    text += "PROTO P" + std::to_string(i) + " [ ] { Group { children [ " + before + before + "] } }\n";
  }
  return text + "P" + std::to_string(times) + " { }\n";
}

TEST(SceneEditor, AddsNoMoreThanALittleBeyondWhatATextSays) {
  const Scene world = read(kHead + kWall);
  SceneEditor editor(world);
  EXPECT_TRUE(editor.add(doubling(9), {}, {kFirstObject, kFirstNode}, {})) << "1,023 nodes, and those of prototypes";
  const auto refused = editor.add(doubling(18), {}, {ObjectId{1, 5000}, NodeId{1, 5000}}, {});
  ASSERT_FALSE(refused) << "524,287 nodes of " << doubling(18).size() << " bytes";
  EXPECT_NE(refused.error().find("nodes"), std::string::npos) << refused.error();
  const std::string extrusion = "Shape { geometry Extrusion { crossSection [ " + [] {
    std::string corners;
    for (int i = 0; i < 300; ++i) corners += std::to_string(i) + " 0 ";
    return corners;
  }() + "] spine [ " + [] {
    std::string spine;
    for (int i = 0; i < 300; ++i) spine += "0 " + std::to_string(i) + " 0 ";
    return spine;
  }() + "] } }\n";
  EXPECT_FALSE(editor.add(kHead + extrusion, {}, {ObjectId{1, 9000}, NodeId{1, 9000}}, {})) << "89,401 polygons";
  EXPECT_TRUE(read_world(kHead + extrusion).scene) << "a world's file may";
}

TEST(SceneEditor, AddsNoTextOfAnotherFormat) {
  const Scene world = read(kHead + kWall);
  SceneEditor editor(world);
  const auto added = editor.add("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", {}, {kFirstObject, kFirstNode}, {});
  ASSERT_FALSE(added);
  EXPECT_NE(added.error().find("VRML"), std::string::npos) << added.error();
}

TEST(SceneEditor, RemovesOneOfSeveralUses) {
  const Scene world =
      read(kHead + "DEF A Transform { children Shape { geometry Box { } } }\nDEF B Transform { children USE A }");
  SceneEditor editor(world);
  ASSERT_TRUE(editor.remove(*world.find("B/A")));
  const Scene edited = finished(editor);
  expect_like(edited,
              kHead + "DEF A Transform { children Shape { geometry Box { } } }\nDEF B Transform { children [ ] }");
  SceneEditor again(edited);  // now it is in one place
  ASSERT_TRUE(again.remove(ObjectId(1)));
  expect_like(finished(again), kHead + "DEF A Transform { children [ ] }\nDEF B Transform { children [ ] }");
}

// A wrong polygon is found when the scene is made anew, where there is no text to point at.
TEST(SceneEditor, SaysWhatIsWrongWithAnEditedFaceSet) {
  const auto mesh = [](const std::string& corners) {
    return kHead +
           "Shape { geometry IndexedFaceSet { coord Coordinate { point [ 0 0 0, 1 0 0, 0 1 0 ] } coordIndex [ " +
           corners + " ] } }";
  };
  const Scene world = read(mesh("0 1 -1 0 1 2 -1"));  // its first polygon has no area: a warning
  const auto& nodes = world.document->nodes;
  const auto faces = std::ranges::find(nodes, "IndexedFaceSet", [](const vrml::Node& node) { return node.type->name; });
  const NodeId id = world.document->ids.id_of(static_cast<std::uint32_t>(faces - nodes.begin()));
  SceneEditor wrong(world);
  ASSERT_TRUE(wrong.set(id, "coordIndex", "[ 0 1 2 -1 2 1 7 -1 ]", {}));
  EXPECT_TRUE(wrong.may_fail());
  const auto refused = wrong.finish();
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().find("coordIndex 7 is out of range"), std::string::npos) << refused.error();
  SceneEditor right(world);
  ASSERT_TRUE(right.set(id, "coordIndex", "[ 0 1 -1 2 1 0 -1 ]", {}));
  expect_like(finished(right), mesh("0 1 -1 2 1 0 -1"));
}

// A tree that knows nothing of documents and instances, and writes itself.
struct PlainNode {
  ObjectId id;
  int x = 0;
  bool is_shape = false;
  std::vector<std::unique_ptr<PlainNode>> children;
};
using PlainNodes = std::vector<std::unique_ptr<PlainNode>>;

std::string text_of(const PlainNode& node) {
  if (node.is_shape) return "Shape { geometry Box { size " + std::to_string(1 + node.x) + " 1 1 } }";
  std::string text = "DEF N" + std::to_string(node.id.packed() % 1000) + " Transform { translation " +
                     std::to_string(node.x) + " 0 0 children [ ";
  for (const auto& child : node.children) text += text_of(*child) + " ";
  return text + "] }";
}

std::string text_of(const PlainNodes& nodes) {
  std::string text = kHead;
  for (const auto& node : nodes) text += text_of(*node) + "\n";
  return text;
}

// A peer's world through any edits, against the plain tree through the same ones.
class RandomEdits : public testing::TestWithParam<std::uint32_t> {
 protected:
  std::uint32_t below(std::size_t n) { return static_cast<std::uint32_t>(random_() % n); }

  std::unique_ptr<PlainNode> plain(int height) {
    auto node = std::make_unique<PlainNode>();
    node->id = ObjectId(next_++, 5);
    node->x = static_cast<int>(below(100));
    node->is_shape = height > 0 && below(3) == 0;
    if (node->is_shape) return node;
    for (std::uint32_t n = height < 3 ? below(3) : 0; n > 0; --n) node->children.push_back(plain(height + 1));
    return node;
  }

  void collect(PlainNodes& nodes, PlainNode* parent) {
    for (auto& node : nodes) {
      all_.push_back({node.get(), parent, &nodes});
      collect(node->children, node.get());
    }
  }

  struct Entry {
    PlainNode* node = nullptr;
    PlainNode* parent = nullptr;  // null: it is at the top level
    PlainNodes* siblings = nullptr;
  };
  Entry* any(bool shapes) {
    all_.clear();
    collect(tree_, nullptr);
    std::vector<Entry*> fit;
    for (Entry& entry : all_) {
      if (shapes || !entry.node->is_shape) fit.push_back(&entry);
    }
    return fit.empty() ? nullptr : fit[below(fit.size())];
  }

  // The place of what comes to stand in `siblings` in front of the one at `at`, or behind all.
  static ScenePlace place(const PlainNode* parent, const PlainNodes& siblings, std::size_t at) {
    ScenePlace out;
    if (parent != nullptr) out.parent = parent->id;
    if (at < siblings.size()) out.before = siblings[at]->id;
    return out;
  }

  void add(SceneEditor& editor) {
    Entry* const in = below(4) == 0 ? nullptr : any(false);
    PlainNode* const parent = in == nullptr ? nullptr : in->node;
    PlainNodes& siblings = parent == nullptr ? tree_ : parent->children;
    const std::size_t at = below(siblings.size() + 1);
    const ObjectId first(next_, 5);
    auto node = plain(0);
    const auto added =
        editor.add(kHead + text_of(*node), place(parent, siblings, at), {first, NodeId(first.number * 4, 5)}, {});
    ASSERT_TRUE(added) << added.error();
    ASSERT_EQ(added->objects, next_ - first.number);
    siblings.insert(siblings.begin() + static_cast<std::ptrdiff_t>(at), std::move(node));
  }

  void remove(SceneEditor& editor) {
    Entry* const entry = any(true);
    if (entry == nullptr) return;
    ASSERT_TRUE(editor.remove(entry->node->id));
    std::erase_if(*entry->siblings, [&](const auto& node) { return node.get() == entry->node; });
  }

  void move(SceneEditor& editor) {
    Entry* const entry = any(true);
    if (entry == nullptr) return;
    const Entry moved = *entry;
    Entry* const in = below(4) == 0 ? nullptr : any(false);
    PlainNode* const parent = in == nullptr ? nullptr : in->node;
    const auto is_inside = [&](const auto& self, const PlainNode& top) -> bool {
      return &top == parent || std::ranges::any_of(top.children, [&](const auto& c) { return self(self, *c); });
    };
    PlainNodes& siblings = parent == nullptr ? tree_ : parent->children;
    const std::size_t at = below(siblings.size() + 1);
    const ScenePlace to = place(parent, siblings, at);
    const bool possible = to.before != moved.node->id && !is_inside(is_inside, *moved.node);
    ASSERT_EQ(editor.move(moved.node->id, to).has_value(), possible);
    if (!possible) return;
    const auto from = std::ranges::find_if(*moved.siblings, [&](const auto& n) { return n.get() == moved.node; });
    auto node = std::move(*from);
    moved.siblings->erase(from);
    const auto before = std::ranges::find_if(siblings, [&](const auto& n) { return to.before == n->id; });
    siblings.insert(before, std::move(node));
  }

  std::mt19937 random_{GetParam()};
  std::uint32_t next_ = 1;
  PlainNodes tree_;
  std::vector<Entry> all_;
};

TEST_P(RandomEdits, GiveWhatTheirTextGives) {
  Scene scene = read(kHead);
  for (int round = 0; round < 12; ++round) {
    SceneEditor editor(scene);
    for (std::uint32_t n = 1 + below(4); n > 0; --n) {
      switch (below(4)) {
        case 0:
          remove(editor);
          break;
        case 1:
          move(editor);
          break;
        default:
          add(editor);
      }
      if (HasFatalFailure()) return;
    }
    Scene edited = finished(editor);
    expect_like(edited, text_of(tree_));
    all_.clear();
    collect(tree_, nullptr);
    ASSERT_EQ(edited.instances.size(), all_.size());
    for (const Entry& entry : all_) {
      ASSERT_TRUE(edited.contains(entry.node->id));
      const bool at_top = entry.parent == nullptr;
      EXPECT_EQ(edited.parent_of(entry.node->id), at_top ? std::nullopt : std::optional(entry.parent->id));
      const double x = entry.node->is_shape ? 0.0 : entry.node->x;
      EXPECT_EQ(edited.transform(entry.node->id).translation.x(), x);
    }
    scene = std::move(edited);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomEdits, testing::Range(0u, 40u));

}  // namespace
}  // namespace peerd::scene_editor_test
