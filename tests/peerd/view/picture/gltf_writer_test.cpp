#include "peerd/view/picture/gltf_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "core/geometry/tessellate.hpp"
#include "core/geometry/triangulation.hpp"
#include "tests/has_members.hpp"
#include "tests/peerd/view/picture/picture_of_text.hpp"

namespace peerd::view::gltf_writer_test {

using nlohmann::json;
using peerd::testing_support::Glb;
using peerd::testing_support::glb_of_text;
using peerd::testing_support::scene_of;
using testing::ElementsAre;

// The triangles that collide, in the world.
std::vector<Glb::Triangle> colliding_triangles(const Scene& scene) {
  std::vector<Glb::Triangle> out;
  Triangulator triangulator;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const ObjectId id = scene.id_of(i);
    if (scene.geometry(id) == nullptr || !scene.at(id).drawn) continue;
    const Mesh mesh = build_mesh(*scene.geometry(id), scene.tessellation);
    const Eigen::Affine3d world = scene.world_from_local(id);
    for (std::size_t p = 0; p < mesh.polygon_count(); ++p) {
      for (const auto& [a, b, c] : triangulator.triangulate(mesh, p)) {
        const auto at = [&](std::uint32_t k) -> Eigen::Vector3d {
          return world * mesh.vertices[static_cast<std::size_t>(mesh.polygon(p)[k])].cast<double>();
        };
        out.push_back(mesh.ccw ? Glb::Triangle{at(a), at(b), at(c)} : Glb::Triangle{at(a), at(c), at(b)});
      }
    }
  }
  return out;
}

// A set of triangles regardless of their order, and of which corner is first.
std::vector<std::vector<double>> sorted(std::vector<Glb::Triangle> all) {
  std::vector<std::vector<double>> out;
  for (Glb::Triangle& t : all) {
    const auto less = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
      return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
    };
    const auto rounded = [](double v) { return std::round(v * 1e4) / 1e4; };
    for (Eigen::Vector3d& p : t) p = p.unaryExpr(rounded);
    std::ranges::rotate(t, std::ranges::min_element(t, less));
    std::vector<double>& flat = out.emplace_back();
    for (const Eigen::Vector3d& p : t) flat.insert(flat.end(), p.begin(), p.end());
  }
  std::ranges::sort(out);
  return out;
}

void expect_same(std::vector<Glb::Triangle> drawn, std::vector<Glb::Triangle> colliding) {
  ASSERT_EQ(drawn.size(), colliding.size());
  const auto a = sorted(std::move(drawn)), b = sorted(std::move(colliding));
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t k = 0; k < 9; ++k) worst = std::max(worst, std::abs(a[i][k] - b[i][k]));
  }
  EXPECT_LT(worst, 3e-4);
}

std::vector<Glb::Triangle> all_triangles(const Glb& glb) {
  std::vector<Glb::Triangle> out;
  for (std::size_t i = 0; i < glb.nodes.size(); ++i) {
    if (glb.nodes[i].parent >= 0) continue;
    const auto below = glb.triangles(static_cast<int>(i));
    out.insert(out.end(), below.begin(), below.end());
  }
  return out;
}

TEST(GltfWriter, ABoxIsItsTwelveTrianglesBelowTheNodeThatStands) {
  const Glb glb = glb_of_text("Transform { translation 1 2 3 children DEF S Shape { geometry Box { size 2 4 6 } } }");
  EXPECT_THAT(glb.problems, ElementsAre());
  EXPECT_EQ(glb.nodes.at(0).json.at("extras").at("static"), true);
  const int shape = glb.find("0/S");
  ASSERT_GE(shape, 0);
  EXPECT_EQ(glb.nodes[static_cast<std::size_t>(shape)].parent, 0);
  EXPECT_EQ(glb.nodes[static_cast<std::size_t>(shape)].json.at("extras").at("id"), "1");
  const auto triangles = glb.triangles(shape);
  ASSERT_EQ(triangles.size(), 12u);
  Eigen::AlignedBox3d box;
  for (const auto& t : triangles) {
    for (const auto& p : t) box.extend(p);
  }
  EXPECT_EQ(box.min(), Vec3(0, 0, 0));
  EXPECT_EQ(box.max(), Vec3(2, 4, 6));
}

TEST(GltfWriter, AnEmptyWorldIsAGoodFile) {
  const Glb glb = glb_of_text("WorldInfo { title \"nothing\" }");
  EXPECT_THAT(glb.problems, ElementsAre());
  EXPECT_EQ(glb.nodes.size(), 1u);
  EXPECT_TRUE(glb.binary.empty());
}

// A mover has a node of its own at its pose, with its Shapes in its frame, however it is scaled from above.
TEST(GltfWriter, WhatMovesHasANodeOfItsOwnAtItsRigidPose) {
  const Glb glb = glb_of_text(R"(
DEF OUTER Transform { translation 0 1 0 scale 2 2 2 children [
  DEF CAR Transform { enslaved TRUE translation 3 0 0 rotation 0 1 0 1.5707963 children [
    DEF BODY Shape { geometry Box { } } ] }
  DEF WALL Shape { geometry Box { } } ] })");
  EXPECT_THAT(glb.problems, ElementsAre());
  const json& car = glb.nodes.at(0).json;
  EXPECT_THAT(car.at("extras"), HasMembers(R"({"path": "OUTER/CAR", "def": "CAR", "id": "1", "owner": 0})"));
  EXPECT_FALSE(car.contains("scale"));
  EXPECT_EQ(glb.nodes[0].world.translation(), Vec3(6, 1, 0));
  EXPECT_EQ(glb.nodes[static_cast<std::size_t>(glb.find("OUTER/CAR/BODY"))].parent, 0);
  EXPECT_EQ(glb.nodes[static_cast<std::size_t>(glb.find("OUTER/WALL"))].parent, 1);
  EXPECT_EQ(glb.triangles(0).size(), 12u);
  EXPECT_EQ(glb.triangles(1).size(), 12u);
}

// Scales of any kind, in any nesting, lead where the collisions have them; no node of glTF can shear.
TEST(GltfWriter, DrawnTrianglesAreWhereThoseAreThatCollide) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    std::mt19937_64 random(seed);
    const auto number = [&](double lo, double hi) {
      const double part = static_cast<double>(random() >> 11) * 0x1p-53;
      return std::to_string(lo + part * (hi - lo));
    };
    const std::vector<std::string> forms{
        "Box { size 1 2 3 }",
        "Sphere { radius 0.7 }",
        "Cone { }",
        "Cylinder { top FALSE }",
        "ElevationGrid { xDimension 3 zDimension 3 height [0 1 0 1 2 1 0 1 0] creaseAngle 1 }",
        "Extrusion { creaseAngle 0.5 spine [0 0 0, 0 1 0, 1 2 0] }",
        "IndexedFaceSet { ccw FALSE coord Coordinate { point [0 0 0, 2 0 0, 2 2 0, 1 0.5 0, 0 2 0] } "
        "coordIndex [0 1 2 3 4 -1] }"};
    std::string text;
    int open = 0;
    for (int i = 0; i < 12; ++i) {
      text += "Transform { " + std::string(random() % 3 == 0 ? "enslaved TRUE " : "") + "translation " + number(-3, 3) +
              " " + number(-3, 3) + " " + number(-3, 3) + " rotation " + number(-1, 1) + " " + number(-1, 1) + " 0.5 " +
              number(-3, 3) + " scale " + number(0.3, 2) + " " + number(0.3, 2) + " " +
              number(random() % 4 == 0 ? -2 : 0.3, 2) + " scaleOrientation 1 0.3 0 " + number(-2, 2) + " center " +
              number(-1, 1) + " 0 1 children [ Shape { geometry " + forms[random() % forms.size()] + " }\n";
      ++open;
      while (open > 0 && random() % 2 == 0) {
        text += "] }\n";
        --open;
      }
    }
    for (; open > 0; --open) text += "] }\n";
    const Glb glb = glb_of_text(text);
    SCOPED_TRACE("seed " + std::to_string(seed));
    EXPECT_THAT(glb.problems, ElementsAre());
    expect_same(all_triangles(glb), colliding_triangles(scene_of(text)));
  }
}

TEST(GltfWriter, ColoursBecomeLinear) {
  const Glb glb = glb_of_text(R"(
Shape { appearance Appearance { material Material { diffuseColor 1 0.5 0 emissiveColor 0 0 0.5 shininess 0.25 transparency 0.5 } }
        geometry IndexedFaceSet { solid FALSE coord Coordinate { point [0 0 0, 1 0 0, 0 1 0] } coordIndex [0 1 2] } })");
  EXPECT_THAT(glb.problems, ElementsAre());
  const json& material = glb.json.at("materials").at(0);
  const json& base = material.at("pbrMetallicRoughness").at("baseColorFactor");
  EXPECT_EQ(base.at(0), 1.0);
  EXPECT_NEAR(base.at(1).get<double>(), 0.2140411, 1e-6) << "IEC 61966-2-1 of 0.5";
  EXPECT_EQ(base.at(2), 0.0);
  EXPECT_EQ(base.at(3), 0.5);
  EXPECT_NEAR(material.at("emissiveFactor").at(2).get<double>(), 0.2140411, 1e-6);
  EXPECT_THAT(material, HasMembers(R"(
    {"pbrMetallicRoughness": {"roughnessFactor": 0.75, "metallicFactor": 0}, "alphaMode": "BLEND",
    "doubleSided": true})"));
  EXPECT_FALSE(material.contains("extensions"));
}

TEST(GltfWriter, WithoutAMaterialNothingIsLit) {
  const Glb glb = glb_of_text("Shape { geometry Box { } }");
  EXPECT_THAT(glb.problems, ElementsAre());
  const json& material = glb.json.at("materials").at(0);
  EXPECT_TRUE(material.at("extensions").contains("KHR_materials_unlit"));
  EXPECT_THAT(material.at("pbrMetallicRoughness").at("baseColorFactor"), ElementsAre(1, 1, 1, 1));
  EXPECT_FALSE(material.contains("doubleSided"));
}

TEST(GltfWriter, LightsShineFromWhereTheyStand) {
  const Glb glb = glb_of_text(R"(
Transform { translation 0 5 0 rotation 1 0 0 -1.5707963 children [
  SpotLight { location 0 0 1 cutOffAngle 0.5 intensity 0.5 radius 20 attenuation 1 0.5 0 } ] }
PointLight { on FALSE }
DirectionalLight { direction 1 0 0 color 0.5 1 1 })");
  EXPECT_THAT(glb.problems, ElementsAre());
  const json& lights = glb.json.at("extensions").at("KHR_lights_punctual").at("lights");
  ASSERT_EQ(lights.size(), 2u);
  EXPECT_EQ(lights.at(0).at("type"), "spot");
  EXPECT_EQ(lights.at(0).at("range"), 20.0);
  EXPECT_NEAR(lights.at(0).at("intensity").get<double>(), 0.5 * std::numbers::pi, 1e-6);
  EXPECT_NEAR(lights.at(0).at("spot").at("outerConeAngle").get<double>(), 0.5, 1e-6);
  const Glb::Node& spot = glb.nodes.at(1);
  EXPECT_TRUE(spot.world.translation().isApprox(Vec3(0, 6, 0), 1e-6)) << spot.world.translation();
  EXPECT_TRUE((spot.world.linear() * -Vec3::UnitZ()).isApprox(-Vec3::UnitY(), 1e-6)) << "it looks down";
  EXPECT_THAT(spot.json.at("extras").at("light").at("attenuation"), ElementsAre(1.0, 0.5, 0.0));
  EXPECT_TRUE((glb.nodes.at(2).world.linear() * -Vec3::UnitZ()).isApprox(Vec3::UnitX(), 1e-6));
}

TEST(GltfWriter, ExtrasSayWhatGltfDoesNotKnow) {
  const Glb glb = glb_of_text(R"(
Viewpoint { position 1 2 3 description "first" fieldOfView 0.6 }
DEF CAR Transform { enslaved TRUE translation 10 0 0 children [
  Transform { translation 0 1 0 children Viewpoint { position 0 0 1 description "seat" } } ] }
Background { skyColor [0 0 0.5, 1 1 1] skyAngle 1.5 groundColor 0.2 0.1 0 topUrl "sky.png" }
Background { }
Fog { color 0.5 0.5 0.5 visibilityRange 30 fogType "EXPONENTIAL" }
NavigationInfo { type "FLY" speed 4 headlight FALSE avatarSize [0.3 1.7 0.5] })");
  EXPECT_THAT(glb.problems, ElementsAre());
  const json& extras = glb.extras();
  EXPECT_EQ(extras.at("world"), "test");
  EXPECT_EQ(extras.at("revision"), 1);
  ASSERT_EQ(extras.at("viewpoints").size(), 2u);
  EXPECT_EQ(extras.at("viewpoints").at(0).at("description"), "first");
  EXPECT_THAT(extras.at("viewpoints").at(0).at("position_m"), ElementsAre(1.0, 2.0, 3.0));
  EXPECT_FALSE(extras.at("viewpoints").at(0).contains("node"));
  EXPECT_EQ(extras.at("viewpoints").at(1).at("node"), 0) << "it goes with the car";
  EXPECT_THAT(extras.at("viewpoints").at(1).at("position_m"), ElementsAre(0.0, 1.0, 1.0)) << "in the car's frame";
  EXPECT_EQ(extras.at("background").at("sky_color").size(), 2u);
  EXPECT_EQ(extras.at("background").at("sky_color").at(0).at(2), 0.5) << "as the file has it";
  EXPECT_EQ(extras.at("background").at("sky_angle").at(0), 1.5);
  EXPECT_EQ(extras.at("background").at("ground_color").size(), 1u);
  EXPECT_EQ(extras.at("fog").at("type"), "EXPONENTIAL");
  EXPECT_EQ(extras.at("fog").at("visibility_range_m"), 30.0);
  EXPECT_THAT(extras.at("navigation").at("type"), ElementsAre("FLY"));
  EXPECT_EQ(extras.at("navigation").at("headlight"), false);
  std::vector<std::string> left_out;
  for (const json& each : extras.at("undrawn")) {
    left_out.push_back(each.at("what").get<std::string>() + ": " + each.at("why").get<std::string>());
  }
  EXPECT_THAT(left_out, ElementsAre("Background: its pictures", "Background: nothing binds it: another one is first"));
}

TEST(GltfWriter, TextThatIsNotUtf8IsReplaced) {
  const Glb glb = glb_of_text("Viewpoint { description \"caf\xE9 \\\"au lait\\\"\" }");
  EXPECT_THAT(glb.problems, ElementsAre());
  EXPECT_EQ(glb.extras().at("viewpoints").at(0).at("description"), "caf\xEF\xBF\xBD \"au lait\"");
}

TEST(GltfWriter, ManyVerticesNeedWideIndices) {
  std::string points, corners;
  for (int i = 0; i < 22000; ++i) {
    const std::string x = std::to_string(i);
    points += x + " 0 0, " + x + " 1 0, " + x + " 0 1,\n";
    corners += std::to_string(3 * i) + " " + std::to_string(3 * i + 1) + " " + std::to_string(3 * i + 2) + " -1\n";
  }
  const Glb glb = glb_of_text("Shape { geometry IndexedFaceSet { coord Coordinate { point [" + points +
                              "] } coordIndex [" + corners + "] } }");
  EXPECT_THAT(glb.problems, ElementsAre());
  ASSERT_EQ(glb.meshes.size(), 1u);
  EXPECT_EQ(glb.meshes[0].positions.size(), 66000u);
  EXPECT_EQ(glb.meshes[0].corners.size(), 66000u);
  EXPECT_EQ(glb.meshes[0].corners.back(), 65999u);
}

// Four numbers a row: depth, and the words that are the type, the name in the path and the DEF name.
TEST(GltfWriter, HasTheTreeOfAllNodes) {
  const Glb glb = glb_of_text("DEF T TimeSensor { } DEF CAR Transform { children Group { } }");
  const json& tree = glb.extras().at("tree");
  EXPECT_THAT(tree.at("words"), ElementsAre("TimeSensor", "0", "T", "Transform", "CAR", "Group", ""));
  EXPECT_THAT(tree.at("rows"), ElementsAre(0, 0, 1, 2, 0, 3, 4, 4, 1, 5, 1, 6));
  EXPECT_EQ(tree.at("left_out"), 0);
}

}  // namespace peerd::view::gltf_writer_test
