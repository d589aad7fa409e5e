#pragma once
#include <deque>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "peerd/peer/node/peer_node.hpp"
#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::testing_support {

// Peers 1 and 2, "one" and "two", which move A and B: x and z by time [m].
struct Way {
  std::string x = "0", z = "0";
};
inline void add_movers(config::RunSettings& run, const Way& a, const Way& b) {
  for (const std::uint32_t id : {1U, 2U}) {
    config::PeerSettings& peer =
        run.peers.emplace_back(config::PeerSettings{.name = id == 1 ? "one" : "two", .id = id});
    peer.owns.emplace_back(id == 1 ? "A" : "B");
    const motion::MotionFormula formula{.x = id == 1 ? a.x : b.x, .z = id == 1 ? a.z : b.z};
    peer.motion[id == 1 ? "A" : "B"].kind = formula;
  }
}

// Two peers, 1 and 2, of one world on a link of 30 ms that loses each fifth datagram. Time goes by milliseconds.
class TwoPeers {
 public:
  struct Sent {
    HostTime at;
    PeerId by;
    replication::Bytes bytes;
    friend bool operator==(const Sent&, const Sent&) = default;
  };

  // `settings`: of both peers, by what they own and how it moves.
  TwoPeers(const std::string& vrml, const config::RunSettings& run, bool keeps_log = true) {
    folder.write("w.wrl", "#VRML V2.0 utf8\n" + vrml);
    shared = must(share_world(folder / "w.wrl", {}, std::vector{run}));
    auto objects = must(config::resolve(run, shared->world.scene));
    for (std::size_t i = 0; i < run.peers.size(); ++i) {
      PeerNode::Options options;
      options.keep_log = keeps_log;
      for (const auto& each : run.peers) options.wait_for.push_back({PeerId{each.id}, each.name});
      nodes.push_back(
          PeerNode::make(run.peers[i], run.replication, *shared, std::move(objects[i]), std::move(options)));
    }
  }

  void step() {
    now += std::chrono::milliseconds(1);
    while (!on_the_way.empty() && on_the_way.front().at <= now) {
      const auto [at, by, bytes] = std::move(on_the_way.front());
      on_the_way.pop_front();
      for (auto& node : nodes) {
        if (node->peer().id() != by) node->on_packet(now, region_, bytes);
      }
      drain();
    }
    for (auto& node : nodes) {
      if (node->next_deadline() <= now) node->on_tick(now);
    }
    drain();
  }
  [[nodiscard]] double since_start_s(std::size_t node = 0) const {
    const auto start = nodes[node]->start();
    return start ? to_seconds(nodes[node]->peer().clock().to_session(now) - *start) : -1.0;
  }
  void run_until(double since_start) {
    for (int i = 0; since_start_s() < since_start; ++i) {
      if (i == 100'000) throw std::runtime_error("the motions do not begin");
      step();
    }
  }
  [[nodiscard]] ObjectId find(const char* path) const { return *shared->world.scene.find(path); }

  ScratchFolder folder;
  std::unique_ptr<const SharedWorld> shared;
  std::vector<std::unique_ptr<PeerNode>> nodes;
  HostTime now{std::chrono::seconds(1000)};
  std::vector<Sent> sent;
  // The peers' other outputs, by kind, but for predicted contacts: a guess may be made, and taken back, for a frame.
  std::vector<std::string> seen;
  int contacts = 0;  // among these

 private:
  void drain() {
    for (auto& node : nodes) {
      while (auto out = node->poll_output()) {
        if (const auto* send = std::get_if<replication::Send>(&*out)) {
          sent.push_back({now, node->peer().id(), send->datagram});
          if (sent.size() % 5 != 0) {
            on_the_way.push_back({now + std::chrono::milliseconds(30), node->peer().id(), send->datagram});
          }
        } else {
          const auto* const contact = std::get_if<replication::ContactSeen>(&*out);
          if (contact != nullptr && contact->kind != replication::ContactKind::kPredicted) ++contacts;
          const bool is_guess = std::holds_alternative<replication::ContactsRetracted>(*out) ||
                                (contact != nullptr && contact->kind == replication::ContactKind::kPredicted);
          if (is_guess) continue;
          seen.push_back(std::to_string(node->peer().id().value) + " " + std::to_string(out->index()));
        }
      }
    }
  }
  RegionId region_{0};
  std::deque<Sent> on_the_way;
};

}  // namespace peerd::testing_support
