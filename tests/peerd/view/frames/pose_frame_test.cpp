#include "peerd/view/frames/pose_frame.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <numbers>

#include "peerd/view/picture/live_picture.hpp"
#include "tests/allocation_counter.hpp"
#include "tests/peerd/view/picture/two_peers.hpp"

namespace peerd::view::pose_frame_test {

using peerd::testing_support::TwoPeers;

// A frame as docs/reference/gateway.md has it, read byte by byte.
struct Row {
  std::uint32_t node = 0, owner = 0;
  std::uint16_t kind = 0, flags = 0;
  float threshold_m = 0;
  Vec3 position;
  Eigen::Vector4f xyzw;
};
struct Frame {
  std::uint32_t magic = 0, count = 0, revision = 0, row_bytes = 0;
  double session_s = 0, world_s = 0, since_start_s = 0;
  std::vector<Row> rows;

  [[nodiscard]] const Row* find(std::uint32_t node, PoseKind kind = PoseKind::kShown) const {
    for (const Row& row : rows) {
      if (row.node == node && row.kind == static_cast<std::uint16_t>(kind)) return &row;
    }
    return nullptr;
  }
};

template <class T>
T number_at(std::span<const std::byte> bytes, std::size_t at) {
  std::uint64_t bits = 0;
  for (std::size_t k = 0; k < sizeof(T); ++k)
    bits |= std::uint64_t{std::to_integer<std::uint8_t>(bytes[at + k])} << (8 * k);
  T value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

Frame read_frame(std::span<const std::byte> bytes) {
  Frame f{.magic = number_at<std::uint32_t>(bytes, 0),
          .count = number_at<std::uint32_t>(bytes, 4),
          .revision = number_at<std::uint32_t>(bytes, 32),
          .row_bytes = number_at<std::uint32_t>(bytes, 36),
          .session_s = number_at<double>(bytes, 8),
          .world_s = number_at<double>(bytes, 16),
          .since_start_s = number_at<double>(bytes, 24)};
  EXPECT_EQ(bytes.size(), 40 + std::size_t{56} * f.count);
  for (std::size_t at = 40; at < bytes.size(); at += 56) {
    Row& row = f.rows.emplace_back();
    row.node = number_at<std::uint32_t>(bytes, at);
    row.owner = number_at<std::uint32_t>(bytes, at + 4);
    row.kind = number_at<std::uint16_t>(bytes, at + 8);
    row.flags = number_at<std::uint16_t>(bytes, at + 10);
    row.threshold_m = number_at<float>(bytes, at + 12);
    for (std::size_t k = 0; k < 3; ++k) row.position[static_cast<int>(k)] = number_at<double>(bytes, at + 16 + 8 * k);
    for (std::size_t k = 0; k < 4; ++k) row.xyzw[static_cast<int>(k)] = number_at<float>(bytes, at + 40 + 4 * k);
  }
  return f;
}

// A carries a wheel that the file turns; B is the other peer's; MILL is the file's own; BALL answers contacts.
const std::string kWorld = R"(
DEF T TimeSensor { cycleInterval 4 loop TRUE }
DEF TURN OrientationInterpolator { key [0 0.5 1] keyValue [0 0 1 0, 0 0 1 3.14159265, 0 0 1 6.2831853] }
DEF A Transform { translation 0 0 0 children [
  Shape { geometry Box { size 1 1 1 } }
  DEF WHEEL Transform { translation 2 0 0 children Shape { geometry Sphere { radius 0.1 } } } ] }
DEF B Transform { translation 0 0 20 children Shape { geometry Box { size 1 1 1 } } }
DEF MILL Transform { translation 0 50 0 children Shape { geometry Box { } } }
DEF BALL Transform { translation 4 0 0 velocityVector -0.5 0 0 collisionResponse CollisionResponse { responseType 2 }
  children Shape { geometry Sphere { radius 0.5 } } }
DEF FLOOR Shape { geometry Box { size 0.1 0.1 0.1 } }
CollisionInterest { objectPath "A" interests ["BALL"] collisionType 1 }
CollisionInterest { objectPath "BALL" interests ["A" "B"] collisionType 1 }
CollisionInterest { objectPath "B" interests ["A"] collisionType 1 }
ROUTE T.fraction_changed TO TURN.set_fraction
ROUTE TURN.value_changed TO WHEEL.set_rotation
ROUTE TURN.value_changed TO MILL.set_rotation
)";

config::RunSettings two_peers() {
  config::RunSettings run;
  run.replication.convergence = {replication::ConvergenceMethod::kLinear, std::chrono::milliseconds(200)};
  testing_support::add_movers(run, {.x = "sin(3*t)"}, {.x = "2*sin(2*t)", .z = "20-2*t"});
  return run;
}

// All rows that a client has by now.
class Client {
 public:
  explicit Client(const PoseStream::Watch& watch) { stream_.watch(watch); }
  Frame take(const PoseTable& table) {
    Frame frame = read_frame(stream_.next(table));
    for (const Row& row : frame.rows) {
      const auto key = std::pair(row.node, row.kind);
      rows_[key] = row;
    }
    return frame;
  }
  [[nodiscard]] const Row& at(std::uint32_t node, PoseKind kind = PoseKind::kShown) const {
    return rows_.at({node, static_cast<std::uint16_t>(kind)});
  }
  PoseStream& stream() { return stream_; }

 private:
  PoseStream stream_;
  std::map<std::pair<std::uint32_t, std::uint16_t>, Row> rows_;
};

constexpr PoseKinds kAll = set_of(PoseKind::kShown) | set_of(PoseKind::kTruth) | set_of(PoseKind::kGhost);

TEST(PoseFrame, BeforeASessionThereAreNoRowsAndNoTimes) {
  TwoPeers peers(kWorld, two_peers());
  LivePicture picture("w", {});
  EXPECT_TRUE(picture.follow(*peers.nodes[0]));
  picture.refresh(*peers.nodes[0], peers.now, kAll);
  PoseStream stream;
  const Frame frame = read_frame(stream.next(picture.poses()));
  EXPECT_EQ(frame.magic, 0x31464450u);
  EXPECT_EQ(frame.count, 0u);
  EXPECT_EQ(frame.row_bytes, 56u);
  EXPECT_EQ(frame.revision, 1u);
  EXPECT_TRUE(std::isnan(frame.session_s) && std::isnan(frame.world_s) && std::isnan(frame.since_start_s));
}

TEST(PoseFrame, SaysWhereThePeerHasEverything) {
  TwoPeers peers(kWorld, two_peers());
  peers.run_until(1.5);
  PeerNode& node = *peers.nodes[0];
  LivePicture picture("w", {});
  ASSERT_TRUE(picture.follow(node));
  const PictureInput input = picture.input(node, peers.now);
  std::map<std::string, std::uint32_t> number;
  for (std::uint32_t i = 0; i < input.movers.size(); ++i) number[input.scene.path_of(input.movers[i].id)] = i;
  ASSERT_EQ(number.size(), 5u);
  picture.refresh(node, peers.now, kAll);
  Client client({kAll, std::nullopt});
  const Frame frame = client.take(picture.poses());
  EXPECT_EQ(frame.count, 5u + 1 + 2) << "all are shown, A has a truth, A and B have ghosts";
  const SimTime t = node.peer().clock().to_session(peers.now);
  EXPECT_NEAR(frame.session_s, to_seconds(t.time_since_epoch()), 0.02);
  EXPECT_NEAR(frame.since_start_s, 1.5, 0.02);

  const double s = frame.since_start_s;
  const Row& a = client.at(number["A"]);
  EXPECT_EQ(a.owner, 1u);
  EXPECT_EQ(a.flags, kOwn | kDriven);
  EXPECT_NEAR(a.position.x(), std::sin(3 * s), 0.05);
  EXPECT_GT(a.threshold_m, 0.0F);
  EXPECT_NEAR(client.at(number["A"], PoseKind::kTruth).position.x(), a.position.x(), 1e-12);
  EXPECT_NEAR(client.at(number["A"], PoseKind::kGhost).position.x(), a.position.x(), 0.6) << "the threshold is 0.5 m";

  const Row& b = client.at(number["B"]);
  EXPECT_EQ(b.owner, 2u);
  EXPECT_EQ(b.flags, 0);
  EXPECT_TRUE(std::isnan(b.threshold_m));
  EXPECT_NEAR(b.position.z(), 20 - 2 * s, 0.7);
  EXPECT_FALSE(frame.find(number["B"], PoseKind::kTruth)) << "the truth of others is not known";

  // The wheel is at A's side, turned by the file at world time.
  const Row& wheel = client.at(number["A/WHEEL"]);
  EXPECT_EQ(wheel.owner, 0u);
  EXPECT_NEAR(wheel.position.x(), a.position.x() + 2.0, 1e-9);
  const double angle = std::fmod(frame.world_s, 4.0) / 4.0 * 2.0 * std::numbers::pi;
  EXPECT_NEAR(std::abs(wheel.xyzw[3]), std::abs(std::cos(angle / 2.0)), 1e-3);
  EXPECT_NEAR(std::abs(client.at(number["MILL"]).xyzw[3]), std::abs(std::cos(angle / 2.0)), 1e-3);
  EXPECT_NEAR(client.at(number["BALL"]).position.x(), 4.0 - 0.5 * s, 0.05);
}

TEST(PoseFrame, HasOnlyWhatHasChanged) {
  TwoPeers peers(kWorld, two_peers());
  peers.run_until(1.0);
  PeerNode& node = *peers.nodes[0];
  LivePicture picture("w", {});
  ASSERT_TRUE(picture.follow(node));
  Client client({kAll, std::nullopt});
  picture.refresh(node, peers.now, kAll);
  const Frame first = client.take(picture.poses());
  EXPECT_EQ(client.take(picture.poses()).count, 0u) << "nothing since";
  peers.run_until(1.1);
  picture.refresh(node, peers.now, kAll);
  const Frame later = client.take(picture.poses());
  EXPECT_GT(later.count, 0u);
  for (const Row& row : later.rows) {
    const Row* const before = first.find(row.node, static_cast<PoseKind>(row.kind));
    ASSERT_NE(before, nullptr);
    EXPECT_TRUE(before->position != row.position || before->xyzw != row.xyzw || before->flags != row.flags ||
                before->threshold_m != row.threshold_m);
  }
  client.stream().watch({set_of(PoseKind::kShown), std::nullopt});
  EXPECT_EQ(client.take(picture.poses()).count, 5u) << "another watch begins with all";
}

TEST(PoseFrame, NearLeavesOutWhatIsFarAway) {
  TwoPeers peers(kWorld, two_peers());
  peers.run_until(1.0);
  LivePicture picture("w", {});
  ASSERT_TRUE(picture.follow(*peers.nodes[0]));
  picture.refresh(*peers.nodes[0], peers.now, kAll);
  Client client({set_of(PoseKind::kShown), PoseStream::Near{Vec3(0, 50, 0), 1.0}});
  const Frame frame = client.take(picture.poses());
  ASSERT_EQ(frame.count, 1u);
  EXPECT_EQ(frame.rows[0].position, Vec3(0, 50, 0)) << "the mill";
}

// The same run, with a viewer at both peers and without: what goes over the network is the same, byte for byte, and so
// is what the peers report.
TEST(PoseFrame, NobodyElseNoticesAViewer) {
  const auto run = [](bool viewed, bool keeps_log) {
    auto peers = std::make_unique<TwoPeers>(kWorld, two_peers(), keeps_log);
    std::vector<std::unique_ptr<LivePicture>> pictures;
    for (int i = 0; i < 2; ++i) pictures.push_back(std::make_unique<LivePicture>("w", ImageLoader{}));
    Client client({kAll, std::nullopt});
    std::size_t rows = 0;
    for (int ms = 0; peers->since_start_s() < 8.0; ++ms) {
      if (ms > 30'000) throw std::runtime_error("the motions do not begin");
      if (viewed && ms % 7 == 3) {
        for (std::size_t i = 0; i < 2; ++i) {
          pictures[i]->follow(*peers->nodes[i]);
          pictures[i]->refresh(*peers->nodes[i], peers->now, kAll);
        }
        rows += client.take(pictures[0]->poses()).count;
        if (ms % 700 == 3) (void)pictures[1]->pick(*peers->nodes[1], peers->now, Vec3(0, 0, 30), -Vec3::UnitZ());
      }
      peers->step();
    }
    EXPECT_EQ(rows > 1000, viewed);
    return peers;
  };
  for (const bool keeps_log : {false, true}) {
    const auto without = run(false, keeps_log), with = run(true, keeps_log);
    EXPECT_GT(without->sent.size(), 100u);
    EXPECT_TRUE(without->sent == with->sent);
    EXPECT_EQ(without->seen, with->seen);
    EXPECT_GT(without->contacts, 0);
  }
}

TEST(PoseFrame, FramesNeedNoMemoryOnceTheyHaveBeenAsLarge) {
  if (PEERD_COUNTS_ALLOCATIONS == 0) GTEST_SKIP() << "a sanitizer counts";
  TwoPeers peers(kWorld, two_peers(), /*keeps_log=*/false);
  peers.run_until(1.0);
  PeerNode& node = *peers.nodes[0];
  LivePicture picture("w", {});
  ASSERT_TRUE(picture.follow(node));
  PoseStream stream;
  stream.watch({kAll, std::nullopt});
  long made = 0;
  std::uint32_t rows = 0;
  for (int frame = 0; frame < 200; ++frame) {
    for (int ms = 0; ms < 3; ++ms) peers.step();
    const bool counts = frame >= 100;
    const long before = allocations();
    picture.follow(node);
    picture.refresh(node, peers.now, kAll);
    const auto bytes = stream.next(picture.poses());
    if (counts) made += allocations() - before;
    rows += read_frame(bytes).count;
  }
  EXPECT_GT(rows, 200u);
  EXPECT_EQ(made, 0);
}

}  // namespace peerd::view::pose_frame_test
