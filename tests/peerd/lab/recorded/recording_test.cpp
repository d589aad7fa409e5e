#include "peerd/lab/recorded/recording.hpp"

#include <gtest/gtest.h>

namespace peerd::recorded::recording_test {

TEST(Recording, CountsTheMemoryOfAllItsParts) {
  RecordedView view{.peer = PeerId{1}, .name = "a", .scenes = {}, .stretches = {}, .events = {}, .errors = {}};
  const auto grows_by = [&](auto change) {
    const std::size_t before = size_bytes(view);
    change();
    return size_bytes(view) - before;
  };
  EXPECT_GE(grows_by([&] { view.scenes.push_back({.glb = std::string(1000, 'x'), .why_not = ""}); }), 1000u);
  EXPECT_GE(grows_by([&] { view.scenes[0].nodes.push_back({ObjectId{1}, std::string(500, 'p')}); }), 500u);
  EXPECT_GE(grows_by([&] { view.stretches.push_back({.frames = std::string(2000, 'x')}); }), 2000u);
  EXPECT_GE(grows_by([&] { view.events.push_back({0.0, std::string(300, 'e')}); }), 300u);
  EXPECT_EQ(grows_by([&] { view.errors.mean_m.resize(10); }), 40u);
  EXPECT_GE(grows_by([&] { view.errors.of_object[ObjectId{1}].resize(100); }), 400u);
  Recording recording;
  recording.views = {view, view};
  EXPECT_EQ(size_bytes(recording), 2 * size_bytes(view));
}

}  // namespace peerd::recorded::recording_test
