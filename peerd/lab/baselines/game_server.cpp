#include "peerd/lab/baselines/game_server.hpp"

#include <algorithm>
#include <array>

#include "peerd/peer/motion/motion_path.hpp"

namespace peerd::baselines {
namespace {

using replication::BitWriter;

constexpr std::uint64_t kPendingMax = 256;     // inputs of a client that wait
constexpr std::size_t kEventsOfDatagram = 40;  // of some 25 bytes

}  // namespace

std::vector<ObjectId> objects_of_snapshots(const Setup& setup) {
  std::vector<ObjectId> all;
  for (const config::PeerObjects& objects : setup.objects)
    all.insert(all.end(), objects.owned.begin(), objects.owned.end());
  for (const replication::ModelNode& node : setup.shared.model->nodes) {
    if (setup.shared.model->response_of(node.object) != nullptr) all.push_back(node.object);
  }
  std::ranges::sort(all);
  all.erase(std::ranges::unique(all).begin(), all.end());
  return all;
}

std::size_t blocks_of(const std::vector<ObjectId>& objects) {
  return std::max<std::size_t>(1, (objects.size() + kBlockObjects - 1) / kBlockObjects);
}

std::span<const ObjectId> block_of(const std::vector<ObjectId>& objects, std::size_t block) {
  const std::size_t begin = block * kBlockObjects;
  return std::span(objects).subspan(begin, std::min(kBlockObjects, objects.size() - begin));
}

GameServer::GameServer(const Setup& setup, std::unique_ptr<Game> game)
    : Participant(setup, setup.run.peers.size() - 1, game->start()),
      game_(std::move(game)),
      rewinding_(*setup.shared.model),
      objects_(objects_of_snapshots(setup)) {
  for (std::size_t i = 0; i < self_; ++i) {
    Client& client = clients_.emplace_back();
    for (const auto& [object, motion] : setup.objects[i].motions) {
      client.at.push_back(motion.pose(0.0));
      poses_[object] = client.at.back();
    }
    driven_.push_back(client.at.size());
    client.seen = game_->start();
    client.acknowledged.assign(blocks_of(objects_), 0);
    client.last_number.assign(blocks_of(objects_), 0);
    client.sent.resize(blocks_of(objects_));
  }
}

void GameServer::on_packet(SimTime now, std::span<const std::byte> datagram) {
  (void)now;
  auto message = read_client_message(datagram, game_->start(), driven_, blocks_of(objects_));
  if (!message) return count("datagrams_refused");
  Client& client = clients_[message->player];
  for (std::size_t i = 0; i < message->commands.size(); ++i) {
    const std::uint64_t tick = message->first_tick + i;
    if (tick >= client.done && client.pending.size() < kPendingMax) {
      client.pending.try_emplace(tick, std::move(message->commands[i]));
    }
  }
  client.seen = std::max(client.seen, message->seen);
  client.last_event = std::max(client.last_event, message->last_event);
  for (std::size_t b = 0; b < client.acknowledged.size(); ++b) {
    if (!client.sent[b].contains(message->blocks[b])) continue;
    client.acknowledged[b] = std::max(client.acknowledged[b], message->blocks[b]);
    client.sent[b].erase(client.sent[b].begin(), client.sent[b].lower_bound(client.acknowledged[b]));
  }
}

// The player's driven objects move as far as the inputs that have come say, in the time of one tick.
void GameServer::carry_out(std::size_t player, SimTime now, std::vector<replication::OwnSample>& samples) {
  Client& client = clients_[player];
  const double tick_s = setup_.tick_s();
  const std::vector<Pose> before = client.at;
  for (const auto& [tick, command] : client.pending) {
    std::size_t i = 0;
    for (const auto& [object, motion] : setup_.objects[player].motions) {
      const KinematicState state = driven(client.at[i], command.drives[i]);
      if (setup_.run.baseline.lag_compensation) {
        const SimTime at = game_->start() + from_seconds(static_cast<double>(tick) * tick_s);
        for (const auto& contact : rewinding_.contacts(object, state, at, tick_s, client.seen)) {
          add_event(now, contact, true);
        }
      }
      client.at[i++] = advance(state, tick_s).pose();
    }
    count("inputs_lost", tick - client.done);
    client.done = tick + 1;
  }
  std::size_t i = 0;
  for (const auto& [object, motion] : setup_.objects[player].motions) {
    KinematicState state = at_rest(before[i]);
    state.velocity = (client.at[i].position - before[i].position) / tick_s;
    state.angular_velocity_body = motion::turn_between(before[i].orientation, client.at[i].orientation) / tick_s;
    samples.push_back({object, state});
    poses_[object] = client.at[i++];
  }
}

void GameServer::add_event(SimTime now, const replication::ContactEvent& contact, bool seen_late) {
  const std::size_t a = setup_.owner_of(contact.collider), b = setup_.owner_of(contact.collidee);
  const bool shared = a < self_ && b < self_ && a != b;
  // Rewinding decides how two players' driven objects meet.
  const bool both_driven = poses_.contains(contact.collider) && poses_.contains(contact.collidee);
  if (shared && both_driven && setup_.run.baseline.lag_compensation && !seen_late) return;
  events_.push_back({++last_event_, shared, contact});
  note_contact(now, shared ? "decided" : std::min(a, b) < self_ ? "owner" : "scene", contact);
}

void GameServer::note_contacts(SimTime now) {
  for (const replication::ContactSeen& seen : game_->take_contacts()) add_event(now, seen.contact, false);
  std::uint64_t all_have = last_event_;
  for (const Client& client : clients_) all_have = std::min(all_have, client.last_event);
  while (!events_.empty() && events_.front().number <= all_have) events_.pop_front();
}

void GameServer::on_tick(SimTime now, std::int64_t tick) {
  std::vector<replication::OwnSample> samples;
  std::vector<std::pair<std::size_t, KeyEvent>> keys;
  for (std::size_t player = 0; player < clients_.size(); ++player) {
    for (const auto& [at, command] : clients_[player].pending) {
      for (const KeyEvent& key : command.keys) keys.emplace_back(player, key);
    }
    carry_out(player, now, samples);
    clients_[player].pending.clear();
  }
  for (const auto& [object, pose] : poses_) rewinding_.note(object, now, pose);
  game_->run_tick(samples);
  for (const auto& [player, key] : keys) {
    if (!game_->press(player, key)) count("keys_without_effect");
  }
  note_contacts(now);
  count("ticks");
  const std::int64_t snapshot = tick * setup_.run.baseline.snapshots_hz / setup_.run.replication.tick_hz;
  if (snapshot == last_snapshot_) return;
  last_snapshot_ = snapshot;
  send_snapshots(now, tick);
}

Block GameServer::block_now(std::size_t block) const {
  Block now;
  for (const ObjectId object : block_of(objects_, block)) {
    KinematicState state = game_->state(object);
    if (const auto pose = poses_.find(object); pose != poses_.end()) {
      state.position = pose->second.position;
      state.orientation = pose->second.orientation;
    }
    now.push_back(snapshot_of(state));
  }
  return now;
}

void GameServer::send_snapshots(SimTime now, std::int64_t tick) {
  std::array<std::byte, kMessageMax_bytes> scratch;
  for (std::size_t block = 0; block < blocks_of(objects_); ++block) {
    const Block state = block_now(block);
    for (std::size_t i = 0; i < clients_.size(); ++i) {
      Client& client = clients_[i];
      const auto base = client.sent[block].find(client.acknowledged[block]);
      const bool has_base = base != client.sent[block].end();
      BitWriter out(scratch);
      put(out, SnapshotHead{static_cast<std::uint64_t>(tick), client.done, static_cast<std::uint32_t>(block),
                            ++client.last_number[block], has_base ? base->first : 0});
      const auto changed = put_changes(out, has_base ? base->second : Block(state.size()), state);
      if (block == 0) {
        std::vector<const GameEvent*> events;
        for (const GameEvent& event : events_) {
          if (event.number > client.last_event && events.size() < kEventsOfDatagram) events.push_back(&event);
        }
        replication::put_varint(out, events.size());
        if (!events.empty()) replication::put_varint(out, events.front()->number);
        for (const GameEvent* event : events) put(out, game_->start(), *event);
      }
      const std::size_t bytes = out.finish();
      send(now, to_client(i), std::span(scratch).first(bytes));
      for (const std::uint32_t k : changed) {
        note_update(now, block_of(objects_, block)[k], bytes / changed.size(), "snapshot");
      }
      client.sent[block].emplace(client.last_number[block], state);
      if (client.sent[block].size() > snapshots_kept(setup_)) client.sent[block].erase(client.sent[block].begin());
    }
  }
}

}  // namespace peerd::baselines
