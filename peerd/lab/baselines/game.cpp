#include "peerd/lab/baselines/game.hpp"

#include <algorithm>
#include <cassert>

namespace peerd::baselines {
namespace {

constexpr HostTime kGameBegins{std::chrono::seconds(1'000)};
constexpr Duration kFoundsWithin = std::chrono::seconds(60);

replication::PeerConfig lone_peer(const config::RunSettings& run, const SharedWorld& shared,
                                  std::span<const config::PeerObjects> objects) {
  replication::PeerConfig config;
  config.id = PeerId{1};
  config.name = "game";
  config.world_hash = run.replication.session_hash(shared.world.hash);
  config.tick_hz = run.replication.tick_hz;
  config.wait_for_start = true;
  config.detection = run.replication.collision.make_detection(run.replication.tick_hz);
  for (const config::PeerObjects& of_peer : objects) {
    for (const auto* const owned : {&of_peer.owned, &of_peer.owned_by_founder}) {
      for (const ObjectId object : *owned) {
        const auto launch = of_peer.launches.find(object);
        config.owned.push_back({object, of_peer.motions.contains(object),
                                launch == of_peer.launches.end() ? replication::Launch{} : launch->second});
      }
    }
  }
  return config;
}

}  // namespace

Game::Game(const config::RunSettings& run, const SharedWorld& shared, std::span<const config::PeerObjects> objects)
    : shared_(shared),
      ticks_(run.replication.tick_hz),
      peer_(std::make_unique<replication::Peer>(lone_peer(run, shared, objects), *shared.model)) {
  for (std::size_t player = 0; player < objects.size(); ++player) {
    key_sensors_.emplace_back(shared.world.scene);
    for (const ObjectId object : objects[player].owned) {
      if (!objects[player].motions.contains(object)) moved_by_[object] = player;
    }
  }
  // A lone peer founds its session after a while. Until the start, driven objects stand where the file has them.
  HostTime now = kGameBegins;
  while (!peer_->clock().synchronised()) {
    now = std::max(now + Duration{1}, peer_->next_deadline());
    assert(now < kGameBegins + kFoundsWithin);
    peer_->on_tick(now, {});
    drain();
  }
  start_ = std::chrono::ceil<std::chrono::seconds>(peer_->clock().to_session(now) + std::chrono::seconds(1));
  first_tick_ = ticks_.number_at(start_);
  peer_->start_motions(now, start_);
  now_ = start_;
}

void Game::run_tick(std::span<const replication::OwnSample> driven) {
  now_ = time_of(next_tick_++);
  const HostTime host = peer_->clock().to_host(now_);
  while (peer_->next_deadline() < host) {
    peer_->on_tick(peer_->next_deadline(), next_tick_ == 1 ? std::span<const replication::OwnSample>{} : driven);
    drain();
  }
  peer_->on_tick(host, driven);
  drain();
}

bool Game::press(std::size_t player, const KeyEvent& key) {
  const HostTime host = peer_->clock().to_host(now_);
  bool changes = false;
  for (const std::size_t hit : key_sensors_[player].press(key).hits) {
    const KeySensor& sensor = shared_.world.scene.key_sensors[hit];
    const auto mover = sensor.recipient ? moved_by_.find(*sensor.recipient) : moved_by_.end();
    if (mover == moved_by_.end() || mover->second != player) continue;
    const Vec3 velocity = peer_->to_world(now_, *sensor.recipient, sensor.value);
    changes |= peer_->change_velocity(host, *sensor.recipient, velocity, sensor.absolute);
  }
  drain();
  return changes;
}

void Game::drain() {
  while (auto out = peer_->poll_output()) {
    if (auto* contact = std::get_if<replication::ContactSeen>(&*out)) contacts_.push_back(std::move(*contact));
    if (const auto* retracted = std::get_if<replication::ContactsRetracted>(&*out)) {
      std::erase_if(contacts_, [&](const replication::ContactSeen& c) {
        return retracted->retracts(c.contact.at, c.contact.collider, c.contact.collidee);
      });
    }
  }
}

std::vector<replication::ContactSeen> Game::take_contacts() {
  std::ranges::stable_sort(contacts_, {}, [](const replication::ContactSeen& c) { return c.contact.at; });
  return std::exchange(contacts_, {});
}

}  // namespace peerd::baselines
