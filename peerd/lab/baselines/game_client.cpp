#include "peerd/lab/baselines/game_client.hpp"

#include <algorithm>
#include <array>

namespace peerd::baselines {
namespace {

using replication::BitReader;

constexpr std::uint64_t kInputsOfBefore = 2;             // inputs that each message repeats
constexpr std::size_t kReceivedMax = 64;                 // snapshots of a block that may be a base
constexpr Duration kShownFor = std::chrono::seconds(1);  // beyond the interpolation
constexpr Duration kAgesOf = std::chrono::seconds(2);
constexpr double kExtrapolated_s = 0.25;
constexpr std::uint32_t kEventsMax = 64;

}  // namespace

GameClient::GameClient(const Setup& setup, std::size_t self, const GameServer& server)
    : Participant(setup, self, server.game().start()),
      server_(server),
      start_(server.game().start()),
      commands_(setup.objects[self].motions, setup.run.peers[self].keys),
      objects_(objects_of_snapshots(setup)),
      received_(blocks_of(objects_)) {
  for (const Pose& at : commands_.begin()) confirmed_.push_back({0, at});
  predict();
}

void GameClient::on_packet(SimTime now, std::span<const std::byte> datagram) {
  BitReader in(datagram);
  SnapshotHead head;
  if (!take(in, head) || head.block >= received_.size()) return count("datagrams_refused");
  std::map<std::uint64_t, Block>& received = received_[head.block];
  const auto base = received.find(head.base);
  if (head.base != 0 && base == received.end()) return count("snapshots_without_base");
  if (!received.empty() && head.number <= received.rbegin()->first) return count("snapshots_late");
  Block states = head.base == 0 ? Block(block_of(objects_, head.block).size()) : base->second;
  if (!take_changes(in, states) || !in.good()) return count("datagrams_refused");
  const SimTime at = server_.game().time_of(static_cast<std::int64_t>(head.tick));
  ages_.emplace_back(now, now - at);
  while (ages_.front().first < now - kAgesOf) ages_.pop_front();
  keep(at, head.block, states);
  received.emplace(head.number, states);
  if (received.size() > snapshots_kept(setup_)) received.erase(received.begin());
  if (head.block == 0) take_events(now, in);
  confirm(head, states);
}

// A snapshot of a block confirms the inputs of the own driven objects in it.
void GameClient::confirm(const SnapshotHead& head, const Block& states) {
  std::size_t k = 0;
  std::uint64_t all_before = head.commands;
  for (const auto& [object, motion] : setup_.objects[self_].motions) {
    const auto index = static_cast<std::size_t>(std::ranges::lower_bound(objects_, object) - objects_.begin());
    Confirmed& confirmed = confirmed_[k++];
    if (index / kBlockObjects == head.block && head.commands >= confirmed.tick) {
      confirmed = {head.commands, state_of(states[index % kBlockObjects]).pose()};
    }
    all_before = std::min(all_before, confirmed.tick);
  }
  unconfirmed_.erase(unconfirmed_.begin(), unconfirmed_.lower_bound(all_before));
  predict();
}

void GameClient::keep(SimTime at, std::size_t block, const Block& states) {
  const std::span<const ObjectId> objects = block_of(objects_, block);
  const Duration kept = kShownFor + from_seconds(setup_.run.baseline.interpolation_ms * 1e-3);
  for (std::size_t i = 0; i < objects.size(); ++i) {
    std::deque<Snapshot>& shown = shown_[objects[i]];
    shown.push_back({at, state_of(states[i])});
    while (shown.size() > 1 && shown[1].at < at - kept) shown.pop_front();
  }
}

void GameClient::take_events(SimTime now, BitReader& in) {
  std::uint32_t events = 0;
  std::uint64_t first = 0;
  if (!replication::take_varint(in, events) || events > kEventsMax) return count("datagrams_refused");
  if (events > 0 && !replication::take_varint(in, first)) return count("datagrams_refused");
  for (std::uint32_t i = 0; i < events; ++i) {
    GameEvent event{first + i, false, {}};
    if (!take(in, start_, event)) return count("datagrams_refused");
    if (event.number <= last_event_) continue;
    last_event_ = event.number;
    note_contact(now, event.shared ? "applied" : "predicted", event.contact);
  }
}

SimTime GameClient::seen_at(SimTime now) const {
  Duration age = Duration::max();
  for (const auto& [arrival, each] : ages_) age = std::min(age, each);
  return ages_.empty() ? start_ : now - age - from_seconds(setup_.run.baseline.interpolation_ms * 1e-3);
}

KinematicState GameClient::seen(ObjectId object, SimTime now) const {
  const auto found = shown_.find(object);
  if (found == shown_.end()) return at_rest(setup_.shared.world.scene.rigid_pose(object));
  const std::deque<Snapshot>& shown = found->second;
  const SimTime at = seen_at(now);
  const auto next = std::ranges::upper_bound(shown, at, {}, &Snapshot::at);
  if (next == shown.begin()) return next->state;
  const Snapshot& last = *(next - 1);
  if (next == shown.end()) return advance(last.state, std::min(to_seconds(at - last.at), kExtrapolated_s));
  const double s = to_seconds(at - last.at) / to_seconds(next->at - last.at);
  KinematicState state = last.state;
  state.position += s * (next->state.position - last.state.position);
  state.orientation = last.state.orientation.slerp(s, next->state.orientation);
  return state;
}

void GameClient::predict() {
  predicted_.clear();
  for (std::size_t i = 0; i < confirmed_.size(); ++i) {
    Pose pose = confirmed_[i].at;
    for (auto input = unconfirmed_.lower_bound(confirmed_[i].tick); input != unconfirmed_.end() && input->first < tick_;
         ++input) {
      pose = advance(driven(pose, input->second.drives[i]), setup_.tick_s()).pose();
    }
    predicted_.push_back(pose);
  }
}

void GameClient::on_tick(SimTime now, std::int64_t tick) {
  const double tick_s = setup_.tick_s();
  if (const auto last = unconfirmed_.find(tick_); last != unconfirmed_.end()) {
    for (std::size_t i = 0; i < predicted_.size(); ++i) {
      if (confirmed_[i].tick > tick_) continue;  // the server's pose is after that input
      predicted_[i] = advance(driven(predicted_[i], last->second.drives[i]), tick_s).pose();
    }
  }
  tick_ = static_cast<std::uint64_t>(tick);
  unconfirmed_.insert_or_assign(tick_, commands_.sample(static_cast<double>(tick) * tick_s, tick_s, predicted_));
  ClientMessage message;
  message.player = static_cast<std::uint32_t>(self_);
  const std::uint64_t first = tick_ - std::min(tick_, kInputsOfBefore);
  for (auto each = unconfirmed_.lower_bound(first); each != unconfirmed_.end(); ++each) {
    if (message.commands.empty()) message.first_tick = each->first;
    message.commands.push_back(each->second);
  }
  message.last_event = last_event_;
  message.seen = seen_at(now);
  for (const auto& received : received_) message.blocks.push_back(received.empty() ? 0 : received.rbegin()->first);
  std::array<std::byte, kMessageMax_bytes> scratch;
  const std::size_t bytes = write(message, start_, scratch);
  send(now, kToServer, std::span(scratch).first(bytes));
  const auto& motions = setup_.objects[self_].motions;
  for (const auto& [object, motion] : motions) note_update(now, object, bytes / motions.size(), "input");
}

void GameClient::record(SimTime now) {
  for (std::size_t i = 0; i < setup_.objects.size(); ++i) {
    for (const ObjectId object : setup_.objects[i].owned) {
      const KinematicState shown = seen(object, now);
      if (i != self_) note_sample(now, object, shown, shown.pose());
      if (i == self_ && !setup_.objects[i].motions.contains(object)) {
        note_sample(now, object, server_.game().state(object), shown.pose());
      }
    }
  }
  record_driven(now);
}

void GameClient::record_driven(SimTime now) {
  const double t_s = to_seconds(now - start_);
  const double into_tick_s = t_s - static_cast<double>(tick_) * setup_.tick_s();
  const auto input = unconfirmed_.find(tick_);
  std::size_t k = 0;
  for (const auto& [object, motion] : setup_.objects[self_].motions) {
    Pose shown = seen(object, now).pose();
    if (setup_.run.baseline.prediction) {
      shown = input == unconfirmed_.end() ? predicted_[k]
                                          : advance(driven(predicted_[k], input->second.drives[k]), into_tick_s).pose();
    }
    note_sample(now, object, motion.sample(t_s), shown);
    ++k;
  }
}

}  // namespace peerd::baselines
