#pragma once
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>
#include <variant>

#include "core/scene/reader.hpp"
#include "peerd/peer/node/peer_node.hpp"
#include "replication/wire/codec.hpp"
#include "tests/fuzz/require.hpp"

namespace peerd::fuzz {

// Calls take(line) with each line of an input, up to `most` of them.
template <class Take>
void for_each_line(const std::uint8_t* data, std::size_t size, int most, const Take& take) {
  std::string_view rest(reinterpret_cast<const char*>(data), size);
  for (int i = 0; i < most && !rest.empty(); ++i) {
    const std::size_t end = std::min(rest.find('\n'), rest.size());
    take(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
}

// A peer of its own world, in fake time that begins at 1,000 s.
class DrivenPeer {
 public:
  explicit DrivenPeer(std::string_view world) {
    world_.world.scene = read_world(world).scene.value();
    world_.model = replication::make_world_model(world_.world.scene);
  }
  [[nodiscard]] ObjectId object(std::string_view path) const { return *world_.world.scene.find(path); }

  void make(config::PeerObjects objects, const config::ReplicationSettings& replication = {}) {
    config::PeerSettings settings;
    settings.name = "fuzzed";
    settings.id = 1;
    node_ = PeerNode::make(settings, replication, world_, std::move(objects), {});
  }
  // Lets 5 ms pass. Whatever the peer sends is a message.
  void pass() {
    now_ += std::chrono::milliseconds(5);
    node_->on_tick(now_);
    while (auto out = node_->poll_output()) {
      if (const auto* send = std::get_if<replication::Send>(&*out)) {
        require(replication::decode(send->datagram, SimTime{}).has_value());
      }
    }
  }
  void pass_until_it_runs() {
    while (!node_->start() || node_->peer().clock().to_session(now_) < *node_->start()) pass();
  }

 protected:
  SharedWorld world_;
  std::unique_ptr<PeerNode> node_;
  HostTime now_{std::chrono::seconds(1'000)};
};

}  // namespace peerd::fuzz
