// Sends any datagrams to the pose port: objects stay within the range of updates, and every pose is taken or counted as
// refused.
//
// An input has one datagram on each line. The peer's clock is Unix time; it begins at 1,000 s and advances by 5 ms for
// each datagram.
#include <algorithm>
#include <cstdint>
#include <string_view>

#include "peerd/peer/control/request.hpp"
#include "peerd/peer/feed/pose_message.hpp"
#include "peerd/peer/node/describe.hpp"
#include "tests/fuzz/driven_peer.hpp"
#include "tests/fuzz/require.hpp"

namespace {

using namespace peerd;
using fuzz::require;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF A Transform { children Shape { geometry Box { } } }
DEF B Transform { translation 9 9 9 children Shape { geometry Box { } } }
)";
constexpr int kLinesMax = 256;  // in one input

class Driver : public fuzz::DrivenPeer {
 public:
  Driver() : DrivenPeer(kWorld) {
    config::PeerObjects objects;
    for (const char* path : {"A", "B"}) {
      objects.owned.push_back(object(path));
      objects.outside.emplace(path, objects.owned.back());
    }
    config::ReplicationSettings replication;
    replication.policy.models = replication::ModelPolicy{};
    make(std::move(objects), replication);
    now_ -= std::chrono::seconds(2);
    while (now_ < HostTime{std::chrono::seconds(1'000)}) go_on();
  }

  void go_on() {
    pass();
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
    go_on();
    for (const char* path : {"A", "B"}) {
      const KinematicState s = node_->peer().truth(object(path), node_->peer().clock().to_session(now_));
      require(s.position.norm() < 1e12 && s.velocity.norm() < 1e12 && s.acceleration.norm() < 1e12);
      require(s.angular_velocity_body.norm() <= 1.0001e4 && s.orientation.coeffs().allFinite());
    }
  }

 private:
  std::uint64_t count(const char* name) { return node_->log().counters.at(name); }

  Duration host_minus_wall_{0};
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Driver driver;
  fuzz::for_each_line(data, size, kLinesMax, [&](std::string_view line) { driver.hear(line); });
  for (int i = 0; i < 200; ++i) driver.go_on();  // until all objects stand
  return 0;
}
