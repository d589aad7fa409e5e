#include "peerd/lab/recorded/foxglove_messages.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace peerd::recorded::foxglove_messages_test {

using nlohmann::json;
using testing::ElementsAre;

TEST(FoxgloveMessages, TransformsSayTheirFramesAndTimes) {
  const json message = json::parse(frame_transforms(12.25, {{"world", "a/CAR", {Vec3(1, 2, 3), Quat::Identity()}}}));
  const json& transform = message.at("transforms").at(0);
  EXPECT_EQ(transform.at("timestamp"), (json{{"sec", 12}, {"nsec", 250'000'000}}));
  EXPECT_EQ(transform.at("parent_frame_id"), "world");
  EXPECT_EQ(transform.at("child_frame_id"), "a/CAR");
  EXPECT_EQ(transform.at("translation"), (json{{"x", 1.0}, {"y", 2.0}, {"z", 3.0}}));
  EXPECT_EQ(transform.at("rotation").at("w"), 1.0);
}

view::ScenePicture scene_of(const std::vector<std::string>& movers) {
  view::ScenePicture scene;
  for (std::size_t i = 0; i < movers.size(); ++i) {
    scene.nodes.push_back({.id = ObjectId{static_cast<std::uint32_t>(i + 1)}, .pose = {}, .owner = kNobody});
    scene.node_paths.push_back(movers[i]);
  }
  scene.nodes.push_back({.id = {}, .pose = {}, .owner = kNobody});
  scene.node_paths.emplace_back("");
  const view::DrawnGeometry triangle{.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, .corners = {0, 1, 2}};
  scene.geometries.push_back(triangle);
  scene.materials.push_back({.diffuse = {0.5F, 0.25F, 1}, .transparency = 0.25F});
  scene.meshes.push_back({0, 0});
  view::DrawnShape shape;
  shape.node = 0;
  shape.node_from_shape.translation() = Vec3(0, 0, 7);
  scene.shapes.push_back(shape);
  return scene;
}

TEST(FoxgloveMessages, AnEntityGoesWithTheFrameOfItsNode) {
  std::vector<std::string> before;
  const json message = json::parse(scene_update(0.0, scene_of({"CAR"}), "a/", "world", before));
  const json& car = message.at("entities").at(0);
  EXPECT_EQ(car.at("frame_id"), "a/CAR");
  EXPECT_EQ(car.at("frame_locked"), true);
  const json& triangles = car.at("triangles").at(0);
  EXPECT_EQ(triangles.at("points").at(1), (json{{"x", 1.0}, {"y", 0.0}, {"z", 7.0}}));
  EXPECT_EQ(triangles.at("indices"), (json{0, 1, 2}));
  EXPECT_EQ(triangles.at("color"), (json{{"r", 0.5}, {"g", 0.25}, {"b", 1.0}, {"a", 0.75}}));
  EXPECT_EQ(message.at("entities").at(1).at("frame_id"), "world") << "what stands";
}

TEST(FoxgloveMessages, OfAnLodTheFirstLevelIsShownAndNoText) {
  view::ScenePicture scene = scene_of({"CAR"});
  for (const std::uint32_t number : {0U, 1U}) {
    scene.groups.push_back({.number = number, .count = 2});
  }
  scene.shapes.push_back(scene.shapes.front());
  scene.shapes[0].group = 0;
  scene.shapes[1].group = 1;
  view::DrawnShape& text = scene.shapes.emplace_back();
  text.mesh = view::DrawnShape::kNoMesh;
  std::vector<std::string> before;
  const json message = json::parse(scene_update(0.0, scene, "a/", "world", before));
  EXPECT_EQ(message.at("entities").at(0).at("triangles").size(), 1U);
}

TEST(FoxgloveMessages, WhatASceneHasNoMoreIsDeleted) {
  std::vector<std::string> before;
  (void)scene_update(0.0, scene_of({"CAR", "BOX"}), "a/", "world", before);
  const json message = json::parse(scene_update(1.0, scene_of({"CAR"}), "a/", "world", before));
  ASSERT_EQ(message.at("deletions").size(), 1u);
  EXPECT_EQ(message.at("deletions").at(0).at("id"), "a/BOX");
  EXPECT_THAT(before, ElementsAre("a/CAR", "a/(what stands)"));
}

TEST(FoxgloveMessages, AContactIsAnArrowAlongItsNormal) {
  const json message =
      json::parse(contact_mark(2.0, {"1", "decided, by peer 3", Vec3(1, 0, 0), Vec3(0, 1, 0)}, "world"));
  const json& arrow = message.at("entities").at(0).at("arrows").at(0);
  const json& q = arrow.at("pose").at("orientation");
  const Vec3 along = Quat(q.at("w"), q.at("x"), q.at("y"), q.at("z")) * Vec3::UnitX();
  EXPECT_NEAR((along - Vec3::UnitY()).norm(), 0.0, 1e-9);
  EXPECT_EQ(message.at("entities").at(0).at("texts").at(0).at("text"), "decided, by peer 3");
  EXPECT_EQ(message.at("entities").at(0).at("lifetime").at("sec"), 3);
}

TEST(FoxgloveMessages, SchemasAreJsonSchemasOfTheirNames) {
  EXPECT_EQ(json::parse(frame_transforms_schema()).at("title"), "foxglove.FrameTransforms");
  EXPECT_EQ(json::parse(scene_update_schema()).at("title"), "foxglove.SceneUpdate");
}

}  // namespace peerd::recorded::foxglove_messages_test
