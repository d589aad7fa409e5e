// The size and the time of pictures of large worlds. The times are printed and not judged.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <ctime>
#include <string>
#include <utility>

#include "peerd/view/picture/gltf_writer.hpp"
#include "peerd/view/picture/live_picture.hpp"
#include "peerd/view/picture/scene_picture.hpp"
#include "tests/peerd/view/picture/picture_of_text.hpp"
#include "tests/peerd/view/picture/two_peers.hpp"

namespace peerd::view::picture_scale_test {

using peerd::testing_support::Glb;
using peerd::testing_support::read_glb;
using peerd::testing_support::scene_of;
using peerd::testing_support::TwoPeers;

// The time of the processor that this program has used since.
class Watch {
 public:
  [[nodiscard]] double ms() const { return 1e3 * static_cast<double>(std::clock() - since_) / CLOCKS_PER_SEC; }

 private:
  std::clock_t since_ = std::clock();
};

std::string boxes(int count, const char* name) {
  std::string text = "DEF S Shape { appearance Appearance { material Material { } } geometry Box { } }\n";
  for (int i = 0; i < count; ++i) {
    text += std::string("DEF ") + name + std::to_string(i) + " Transform { translation " +
            std::to_string(3 * (i % 300)) + " 0 " + std::to_string(3 * (i / 300)) +
            " velocityVector 0 0.5 0 children USE S }\n";
  }
  return text;
}

TEST(PictureScale, AFileOfAHundredThousandNodes) {
  const Scene scene = scene_of(boxes(100'000, "N"));
  const Watch input_watch;
  const PictureInput input = input_at(scene, 1.0, "w");
  const double input_ms = input_watch.ms();
  const Watch picture_watch;
  const ScenePicture drawn = picture_of(input);
  const double picture_ms = picture_watch.ms();
  const Watch write_watch;
  const auto written = write_glb(drawn);
  const double write_ms = write_watch.ms();
  ASSERT_TRUE(written);
  std::printf("scene.glb of 100,000 moving nodes: input %.0f ms, picture %.0f ms, file %.0f ms, %.1f MB\n", input_ms,
              picture_ms, write_ms, static_cast<double>(written->size()) / 1e6);
  const Glb glb = read_glb(*written);
  EXPECT_TRUE(glb.problems.empty());
  EXPECT_EQ(glb.nodes.size(), 100'000u + 1 + 100'001);
  EXPECT_EQ(glb.meshes.size(), 1u);
  EXPECT_EQ(glb.nodes[99'999].world.translation(), Vec3(3 * (99'999 % 300), 0.5, 3 * (99'999 / 300)));
}

void add_peer(config::RunSettings& run, std::uint32_t id, const char* owns) {
  config::PeerSettings& peer = run.peers.emplace_back();
  peer.id = id;
  peer.name = "peer" + std::to_string(id);
  peer.owns.emplace_back(owns);
}

// Lanes of 9 m: in each a box of peer 1 and one of peer 2 fly against each other, and back from the walls.
std::string lanes(int count) {
  std::string text = R"(
DEF CRATE Shape { geometry Box { } }
DEF WALL Shape { geometry Box { size 0.2 2.5 2.5 } }
)";
  for (int i = 0; i < count; ++i) {
    const std::string number = std::to_string(i), y = std::to_string(4 * (i % 20)), z = std::to_string(4 * (i / 20));
    const auto box = [&](const char* name, const char* x, const char* speed) {
      text += std::string("DEF ") + name + number + " Transform { translation " + x + ' ' + y + ' ' + z +
              " velocityVector " + speed + " 0 0 collisionResponse CollisionResponse { } children USE CRATE }\n";
    };
    box("A", "-2", "1.1");
    box("B", "2", "-0.9");
    text += "DEF W" + number + " Group { children [ Transform { translation -4.5 " + y + ' ' + z +
            " children USE WALL } Transform { translation 4.5 " + y + ' ' + z + " children USE WALL } ] }\n";
    for (const auto& [collider, other] : {std::pair("A", "B"), std::pair("B", "A")}) {
      text += std::string("CollisionInterest { objectPath \"") + collider + number + "\" interests [ \"" + other +
              number + "\" \"W" + number + "\" ] collisionType 1 }\n";
    }
  }
  return text;
}

void run_frames(int count) {
  config::RunSettings run;
  add_peer(run, 1, "N*");
  TwoPeers peers(boxes(count, "N"), run, /*keeps_log=*/false);
  const Watch tick_watch;
  peers.run_until(0.5);
  const double ticks_ms = tick_watch.ms();
  PeerNode& node = *peers.nodes[0];
  LivePicture picture("w", {});
  ASSERT_TRUE(picture.follow(node));
  PoseStream stream;
  double refresh_ms = 0.0, frame_ms = 0.0;
  std::size_t bytes = 0;
  constexpr int kFrames = 20;
  for (int i = 0; i < kFrames; ++i) {
    peers.run_until(0.5 + 0.05 * (i + 1));
    const Watch watch;
    EXPECT_FALSE(picture.follow(node));
    picture.refresh(node, peers.now, set_of(PoseKind::kShown));
    refresh_ms += watch.ms();
    const Watch stream_watch;
    const auto frame = stream.next(picture.poses());
    frame_ms += stream_watch.ms();
    bytes += frame.size();
    std::uint32_t rows = 0;
    std::memcpy(&rows, frame.data() + 4, 4);
    EXPECT_EQ(rows, static_cast<std::uint32_t>(count)) << "all of them move";
  }
  const auto rows = picture.poses().rows(PoseKind::kShown);
  for (const PoseRow& row : rows) {
    EXPECT_NEAR(row.position[1], 0.5 * picture.poses().times().since_start_s, 0.02);
  }
  std::printf(
      "%d moving boxes: %.2f ms a frame for all clients and %.2f ms for each, %.1f bytes a box and frame (0.5 s "
      "of the peer before: %.0f ms)\n",
      count, refresh_ms / kFrames, frame_ms / kFrames,
      static_cast<double>(bytes) / kFrames / static_cast<double>(count), ticks_ms);
}

// A viewer at 20 frames a second, of a peer whose objects meet those of another one here and there.
TEST(PictureScale, FramesOfLanes) {
  constexpr int kLanes = 250;
  config::RunSettings run;
  add_peer(run, 1, "A*");
  add_peer(run, 2, "B*");
  TwoPeers peers(lanes(kLanes), run, /*keeps_log=*/false);
  peers.run_until(0.0);
  PeerNode& node = *peers.nodes[0];
  LivePicture picture("w", {});
  (void)picture.follow(node);
  PoseStream stream;
  double whole_ms = 0.0, frames_ms = 0.0;
  for (int i = 1; i <= 80; ++i) {
    const Watch watch;
    peers.run_until(0.05 * i);
    whole_ms += watch.ms();
    const Watch frame_watch;
    EXPECT_FALSE(picture.follow(node));
    picture.refresh(node, peers.now, set_of(PoseKind::kShown));
    (void)stream.next(picture.poses());
    frames_ms += frame_watch.ms();
    ASSERT_EQ(picture.poses().rows(PoseKind::kShown).size(), 2u * kLanes);
  }
  EXPECT_GT(peers.contacts, 2 * kLanes);
  std::printf("%d lanes for 4 s: both peers %.0f ms, %d contacts, the frames of one %.0f ms\n", kLanes, whole_ms,
              peers.contacts, frames_ms);
}

TEST(PictureScale, FramesOfFiveHundredBoxes) { run_frames(500); }
TEST(PictureScale, FramesOfTenThousandBoxes) { run_frames(10'000); }

}  // namespace peerd::view::picture_scale_test
