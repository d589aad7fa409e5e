// Sends any datagrams to the pose port: objects stay within the range of updates, and every pose is taken or counted as
// refused.
//
// An input has one datagram on each line. The peer's clock is Unix time; it begins at 1,000 s and advances by 5 ms for
// each datagram.
#include <algorithm>
#include <cstdint>
#include <string_view>

#include "core/scene/reader.hpp"
#include "peerd/peer/control/request.hpp"
#include "peerd/peer/feed/pose_message.hpp"
#include "peerd/peer/node/describe.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "replication/wire/codec.hpp"
#include "tests/fuzz/fuzz.hpp"

namespace {

using namespace peerd;
using fuzz::require;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF A Transform { children Shape { geometry Box { } } }
DEF B Transform { translation 9 9 9 children Shape { geometry Box { } } }
)";
constexpr int kLinesMax = 256;  // in one input

SharedWorld make_world() {
  SharedWorld shared;
  shared.world.scene = read_world(kWorld).scene.value();
  shared.model = replication::make_world_model(shared.world.scene);
  return shared;
}

class Driver {
 public:
  Driver() : world_(make_world()) {
    config::PeerSettings settings;
    settings.name = "fuzzed";
    settings.id = 1;
    config::PeerObjects objects;
    for (const char* path : {"A", "B"}) {
      objects.owned.push_back(*world_.world.scene.find(path));
      objects.outside.emplace(path, objects.owned.back());
    }
    config::ReplicationSettings replication;
    replication.policy.models = replication::ModelPolicy{};
    node_ = PeerNode::make(settings, replication, world_, std::move(objects), {});
    now_ -= std::chrono::seconds(2);
    while (now_ < HostTime{std::chrono::seconds(1'000)}) pass();
  }

  void pass() {
    now_ += std::chrono::milliseconds(5);
    node_->on_tick(now_);
    while (auto out = node_->poll_output()) {
      if (const auto* send = std::get_if<replication::Send>(&*out)) {
        require(replication::decode(send->datagram, SimTime{}).has_value());
      }
    }
    while (const auto notice = node_->poll_feed_notice()) {
      const LogLine line = describe(*notice);
      require(line.text.size() < 500);
      require(std::ranges::all_of(line.text, [](char c) { return c >= ' ' && c <= '~'; }));
    }
  }

  void hear(std::string_view datagram) {
    const auto message = feed::parse_pose_message(datagram);
    // The control socket understands the same poses.
    const auto request = control::parse_request(datagram);
    const auto* poses = request ? std::get_if<control::PoseRequest>(&*request) : nullptr;
    require((poses != nullptr) == message.has_value());
    const std::uint64_t before = count("poses_taken") + count("poses_refused");
    const std::uint64_t messages_before = count("pose_messages_refused");
    // For every second datagram Unix time is a nanosecond ahead, by which no named time may overflow.
    host_minus_wall_ = Duration{-1} - host_minus_wall_;
    if (message) {
      (void)node_->on_poses(now_, host_minus_wall_, message->poses);
    } else {
      node_->refuse_poses(message.error());
    }
    require(count("poses_taken") + count("poses_refused") == before + (poses == nullptr ? 0 : poses->poses.size()));
    require(count("pose_messages_refused") == messages_before + (poses == nullptr ? 1 : 0));
    pass();
    for (const ObjectId object : {*world_.world.scene.find("A"), *world_.world.scene.find("B")}) {
      const KinematicState s = node_->peer().truth(object, node_->peer().clock().to_session(now_));
      require(s.position.norm() < 1e12 && s.velocity.norm() < 1e12 && s.acceleration.norm() < 1e12);
      require(s.angular_velocity_body.norm() <= 1.0001e4 && s.orientation.coeffs().allFinite());
    }
  }

 private:
  std::uint64_t count(const char* name) { return node_->log().counters.at(name); }

  SharedWorld world_;
  std::unique_ptr<PeerNode> node_;
  HostTime now_{std::chrono::seconds(1'000)};
  Duration host_minus_wall_{0};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Driver driver;
  fuzz::for_each_line({reinterpret_cast<const char*>(data), size}, kLinesMax,
                      [&](std::string_view line) { driver.hear(line); });
  for (int i = 0; i < 200; ++i) driver.pass();  // until all objects stand
  return 0;
}
