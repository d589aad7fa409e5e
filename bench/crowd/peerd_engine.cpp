#include <algorithm>
#include <chrono>
#include <deque>
#include <stdexcept>
#include <utility>
#include <variant>

#include "bench/crowd/engine.hpp"
#include "core/scene/path_resolver.hpp"
#include "core/scene/reader.hpp"
#include "replication/peer/peer.hpp"

namespace peerd::bench {
namespace {

using namespace replication;

// Motions begin when all peers have joined; the scene begins there.
constexpr Duration kJoined = std::chrono::seconds(3);

class Peers : public CrowdEngine {
 public:
  Peers(const CrowdScene& scene, std::size_t count) : gravity_(scene.kind == CrowdKind::kPile ? -kGravity_m_s2 : 0.0) {
    ReadResult read = read_world(world_text(scene));
    if (!read.scene || !read.diagnostics.empty()) throw std::runtime_error("the generated world has problems");
    scene_ = std::move(*read.scene);
    vrml::PathResolver paths(scene_);
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
      objects_.push_back(paths.find((scene.bodies[i].moves ? "B" : "S") + std::to_string(i)).value());
    }
    model_ = make_world_model(scene_, objects_);
    for (std::size_t k = 0; k < count; ++k) {
      PeerConfig config;
      config.id = PeerId{static_cast<std::uint32_t>(k + 1)};
      config.world_hash = 1;
      for (std::size_t i = 0; i < objects_.size(); ++i) {
        if (!scene.bodies[i].moves || i % count != k) continue;
        Launch launch;
        launch.after = kJoined;
        launch.acceleration = Vec3(0, gravity_, 0);
        config.owned.push_back({objects_[i], false, launch});
      }
      peers_.push_back(std::make_unique<Peer>(std::move(config), *model_));
    }
    ticked_.resize(count);
    for (int steps = 0; steps < 1200; ++steps) {
      step();
      const bool begun = std::ranges::all_of(peers_, [](const auto& peer) { return peer->counters().ticks > 0; });
      if (begun && peers_[0]->truth(objects_[0], ticked_[0]).position != scene.bodies[0].place) return;
    }
    throw std::runtime_error("nothing has begun to move");
  }

  void step() override {
    const HostTime end = now_ + std::chrono::nanoseconds(16'666'667);
    for (;;) {
      HostTime next = end;
      for (const auto& peer : peers_) next = std::min(next, std::max(now_, peer->next_deadline()));
      if (!flights_.empty()) next = std::min(next, std::max(now_, flights_.front().at));
      if (next >= end) break;
      now_ = next;
      for (; !flights_.empty() && flights_.front().at <= now_; flights_.pop_front()) deliver(flights_.front());
      for (std::size_t k = 0; k < peers_.size(); ++k) {
        if (peers_[k]->next_deadline() > now_) continue;
        if (const auto due = peers_[k]->due_tick(now_)) ticked_[k] = *due;
        peers_[k]->on_tick(now_, {});
        drain(k);
      }
    }
    now_ = end;
  }

  void poses(std::vector<CrowdPose>& bodies) override {
    bodies.clear();
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      const std::size_t owner = i % peers_.size();
      const KinematicState state = peers_[owner]->truth(objects_[i], ticked_[owner]);
      bodies.push_back({state.position, state.velocity});
    }
  }

  std::uint64_t contacts() override { return contacts_; }

 private:
  struct Flight {
    HostTime at;
    std::size_t from;
    std::vector<std::byte> datagram;
  };

  void deliver(const Flight& flight) {
    for (std::size_t k = 0; k < peers_.size(); ++k) {
      if (k == flight.from) continue;
      (void)peers_[k]->on_packet(now_, kWholeScene, flight.datagram);
      drain(k);
    }
  }
  void drain(std::size_t k) {
    while (auto out = peers_[k]->poll_output()) {
      if (auto* const send = std::get_if<Send>(&*out)) {
        if (peers_.size() > 1) flights_.push_back({now_, k, std::move(send->datagram)});
      } else if (const auto* const contact = std::get_if<ContactSeen>(&*out)) {
        contacts_ += contact->kind == ContactKind::kOwner || contact->kind == ContactKind::kDecided;
      }
    }
  }

  double gravity_;
  Scene scene_;
  std::unique_ptr<const WorldModel> model_;
  std::vector<ObjectId> objects_;
  std::vector<std::unique_ptr<Peer>> peers_;
  std::vector<SimTime> ticked_;  // of each peer, the last tick
  std::deque<Flight> flights_;
  HostTime now_{};
  std::uint64_t contacts_ = 0;
};

}  // namespace

std::unique_ptr<CrowdEngine> peerd_engine(const CrowdScene& scene) { return std::make_unique<Peers>(scene, 1); }

}  // namespace peerd::bench
