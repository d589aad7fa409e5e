#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "peerd/peer/node/peer_node.hpp"
#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::testing_support {

// One peer alone, "a", which owns some objects of a world of its own; a formula drives DRIVEN.
class LonePeer {
 public:
  LonePeer(const char* vrml, const std::vector<std::string>& owns) {
    folder.write("w.wrl", vrml);
    shared = must(share_world(folder / "w.wrl"));
    settings.name = "a";
    settings.id = 1;
    settings.owns.assign(owns.begin(), owns.end());
    std::get<motion::MotionFormula>(settings.motion["DRIVEN"].kind).x = "t";
  }

  PeerNode& make(std::vector<config::ScriptedKey> keys = {}) {
    settings.keys = std::move(keys);
    config::RunSettings settled;
    settled.peers = {settings};
    node = PeerNode::make(settings, {}, *shared, std::move(config::resolve(settled, shared->world.scene)->front()), {});
    return *node;
  }
  // Runs until that time after the start.
  void run(double until_s) {
    for (; !node->start() || since_start_s() < until_s; now += std::chrono::milliseconds(5)) {
      node->on_tick(now);
      while (node->poll_output()) {
      }
    }
  }
  [[nodiscard]] double since_start_s() const {
    return to_seconds(node->peer().clock().to_session(now) - *node->start());
  }
  [[nodiscard]] KinematicState truth(const char* path) const {
    return node->peer().truth(*shared->world.scene.find(path), node->peer().clock().to_session(now));
  }

  ScratchFolder folder;
  std::unique_ptr<const SharedWorld> shared;
  config::PeerSettings settings;
  std::unique_ptr<PeerNode> node;
  HostTime now{std::chrono::seconds(1000)};
};

}  // namespace peerd::testing_support
