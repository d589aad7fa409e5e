#include "core/formats/gltf/animations.hpp"

#include <gmock/gmock.h>
#include "core/motion/predefined_motion.hpp"
#include "tests/core/formats/gltf/gltf_fixture.hpp"

namespace peerd::formats::gltf::animations_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(GltfAnimations, AnimationsMoveNodesAsTheirInterpolatorsDo) {
  GltfMaker maker;
  const int points = maker.points(kTriangle);
  const int times = maker.accessor<float>({0, 1, 3}, "SCALAR", 5126, 3);
  const int places = maker.points({0, 0, 0, 2, 0, 0, 2, 4, 0});
  const int turns = maker.accessor<float>({0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 1}, "VEC4", 5126, 3);
  const auto sampler = [&](int output, const char* how) {
    return "{\"input\":" + std::to_string(times) + ",\"output\":" + std::to_string(output) + ",\"interpolation\":\"" +
           how + "\"}";
  };
  const auto channel = [](int number, const char* path) {
    return "{\"sampler\":" + std::to_string(number) + ",\"target\":{\"node\":0,\"path\":\"" + path + "\"}}";
  };
  const ReadResult result =
      read_file("a.gltf", maker.gltf(one_node(triangle_mesh(points, -1)) + ",\"animations\":[{\"samplers\":[" +
                                     sampler(places, "LINEAR") + "," + sampler(turns, "STEP") + "," +
                                     sampler(places, "CUBICSPLINE") + "],\"channels\":[" + channel(0, "translation") +
                                     "," + channel(1, "rotation") + "," + channel(2, "scale") + "]}]"));
  EXPECT_THAT(warnings_of(result),
              ElementsAre(HasSubstr("animations/0/channels/2: the 'scale' of nodes/0 stands still")));
  ASSERT_TRUE(result.scene);
  PredefinedMotion motion(*result.scene);
  const ObjectId only = result.scene->find("only").value();
  EXPECT_LT((motion.rigid_pose(only, 0.5).position - Vec3(1, 0, 0)).norm(), 1e-6);
  EXPECT_LT((motion.rigid_pose(only, 2.0).position - Vec3(2, 2, 0)).norm(), 1e-6);
  EXPECT_LT((motion.rigid_pose(only, 3.5).position - Vec3(1, 0, 0)).norm(), 1e-6);  // it repeats
  EXPECT_NEAR(motion.rigid_pose(only, 0.9).orientation.w(), 1.0, 1e-6);
  EXPECT_NEAR(std::abs(motion.rigid_pose(only, 1.1).orientation.z()), 1.0, 1e-6);
}

// A world of nodes that each have a channel of a sampler with the same keys; `animations` times as many.
ReadResult with_channels(int nodes, int animations, std::size_t keys) {
  GltfMaker maker;
  const int points = maker.points(kTriangle);
  std::vector<float> seconds(keys);
  for (std::size_t i = 0; i < keys; ++i) seconds[i] = static_cast<float>(i);
  const int times = maker.accessor(seconds, "SCALAR", 5126, keys), places = maker.points(std::vector<float>(3 * keys));
  std::string list, moved;
  for (int i = 0; i < nodes; ++i) list += (i == 0 ? "" : ",") + std::string("{\"mesh\":0}");
  for (int a = 0; a < animations; ++a) {
    std::string channels;
    for (int i = a; i < nodes; i += animations) {
      channels += (i == a ? "" : ",") +
                  ("{\"sampler\":0,\"target\":{\"path\":\"translation\",\"node\":" + std::to_string(i) + "}}");
    }
    moved +=
        (a == 0 ? "" : ",") + ("{\"channels\":[" + channels + "],\"samplers\":[{\"input\":" + std::to_string(times) +
                               ",\"output\":" + std::to_string(places) + "}]}");
  }
  return read_file("a.gltf",
                   maker.gltf(triangle_mesh(points, -1) + ",\"nodes\":[" + list + "],\"animations\":[" + moved + "]"));
}

TEST(GltfAnimations, AChannelWithoutANodeMovesNothing) {
  GltfMaker maker;
  const int points = maker.points(kTriangle), times = maker.accessor<float>({0, 1}, "SCALAR", 5126, 2);
  const int places = maker.points({0, 0, 0, 1, 0, 0});
  const ReadResult result = read_file(
      "a.gltf", maker.gltf(one_node(triangle_mesh(points, -1)) +
                           ",\"animations\":[{\"channels\":[{\"sampler\":0,\"target\":{\"path\":\"translation\"}}],"
                           "\"samplers\":[{\"input\":" +
                           std::to_string(times) + ",\"output\":" + std::to_string(places) + "}]}]"));
  EXPECT_TRUE(result.scene);
  EXPECT_THAT(warnings_of(result), ElementsAre(HasSubstr("animations/0/channels/0: it moves nothing")));
}

TEST(GltfAnimations, APoseDoesNotKeepALaterAnimationFromMoving) {
  GltfMaker maker;
  const int points = maker.points(kTriangle), zero = maker.accessor<float>({0}, "SCALAR", 5126, 1);
  const int times = maker.accessor<float>({0, 1}, "SCALAR", 5126, 2);
  const int one = maker.points({0, 0, 0}), two = maker.points({0, 0, 0, 1, 0, 0});
  const auto animation = [](int input, int output) {
    return "{\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":\"translation\"}}],\"samplers\":[{"
           "\"input\":" +
           std::to_string(input) + ",\"output\":" + std::to_string(output) + "}]}";
  };
  const ReadResult result =
      read_file("a.gltf", maker.gltf(one_node(triangle_mesh(points, -1)) + ",\"animations\":[" + animation(zero, one) +
                                     "," + animation(times, two) + "," + animation(times, two) + "]"));
  ASSERT_TRUE(result.scene);
  EXPECT_EQ(vrml::nodes_of_type(*result.scene->document, "PositionInterpolator").size(), 1U);
  EXPECT_THAT(warnings_of(result),
              ElementsAre(HasSubstr("animations/0: it stands still"),
                          HasSubstr("animations/2: the 'translation' of nodes/0 stands still: an earlier")));
}

TEST(GltfAnimations, ChannelsOfOneSamplerShareAnInterpolator) {
  const ReadResult result = with_channels(100, 1, 3000);
  ASSERT_TRUE(result.scene);
  EXPECT_EQ(vrml::nodes_of_type(*result.scene->document, "PositionInterpolator").size(), 1U);
  EXPECT_EQ(result.scene->document->routes.size(), 101U);
}

TEST(GltfAnimations, AnimationsOfTheSameKeysCostNoMoreThanTheFileAllows) {
  EXPECT_THAT(error_of(with_channels(1000, 1000, 3000)), HasSubstr("more values than a file of this size"));
}

}  // namespace
}  // namespace peerd::formats::gltf::animations_test
