#include "peerd/lab/baselines/lockstep.hpp"

#include <algorithm>
#include <array>

namespace peerd::baselines {
namespace {

using replication::BitReader;
using replication::BitWriter;

constexpr std::size_t kDatagramMax_bytes = 1200;
constexpr std::size_t kScratch_bytes = 1 << 16;
constexpr std::int64_t kInputsRepeated = 1;  // ticks that each datagram repeats
constexpr std::uint32_t kTicksMax = 256;

std::size_t size_of(const Command& command) {
  std::array<std::byte, kScratch_bytes> scratch;
  BitWriter out(scratch);
  put(out, command);
  return out.finish();
}

}  // namespace

LockstepPlayer::LockstepPlayer(const Setup& setup, std::size_t self, std::unique_ptr<Game> game)
    : Participant(setup, self, game->start()),
      game_(std::move(game)),
      commands_(setup.objects[self].motions, setup.run.peers[self].keys),
      driven_at_(commands_.begin()),
      players_(setup.run.peers.size()) {
  for (std::size_t i = 0; i < players_.size(); ++i) {
    for (const auto& [object, motion] : setup.objects[i].motions) players_[i].at.push_back(motion.pose(0.0));
  }
}

// A datagram: the sender, the first tick, how many, their inputs; then of each player the first tick that the sender
// lacks and wants again, plus one, or 0.
void LockstepPlayer::send_inputs(SimTime now, std::int64_t tick) {
  Inputs& own = players_[self_];
  std::int64_t first = std::max<std::int64_t>(0, tick - kInputsRepeated);
  for (Inputs& player : players_) {
    if (player.wanted != kNothing) first = std::min(first, player.wanted);
    player.wanted = kNothing;
  }
  first = std::max(first, own.by_tick.begin()->first);
  std::array<std::byte, kScratch_bytes> scratch;
  while (first <= tick) {
    BitWriter out(scratch);
    std::size_t bytes = 16 + 3 * players_.size();
    std::int64_t end = first;
    do {
      bytes += size_of(own.by_tick.at(end));
      ++end;
    } while (end <= tick && end - first < kTicksMax && bytes + size_of(own.by_tick.at(end)) <= kDatagramMax_bytes);
    replication::put_varint(out, self_);
    replication::put_varint(out, static_cast<std::uint64_t>(first));
    replication::put_varint(out, static_cast<std::uint64_t>(end - first));
    for (std::int64_t t = first; t < end; ++t) put(out, own.by_tick.at(t));
    for (const Inputs& player : players_) {
      replication::put_varint(out, player.gap ? static_cast<std::uint64_t>(player.next) + 1 : 0);
    }
    send(now, kAll, std::span(scratch).first(out.finish()));
    first = end;
  }
  const auto& motions = setup_.objects[self_].motions;
  for (const auto& [object, motion] : motions)
    note_update(now, object, size_of(own.by_tick.at(tick)) / motions.size(), "input");
}

void LockstepPlayer::on_packet(SimTime now, std::span<const std::byte> datagram) {
  (void)now;
  BitReader in(datagram);
  std::uint32_t sender = 0, count_of_ticks = 0;
  std::uint64_t first = 0;
  const bool has_head = replication::take_varint(in, sender) && replication::take_varint(in, first) &&
                        replication::take_varint(in, count_of_ticks);
  if (!has_head || !is_player(sender) || sender == self_ || count_of_ticks > kTicksMax)
    return count("datagrams_refused");
  Inputs& from = players_[sender];
  for (std::uint32_t i = 0; i < count_of_ticks; ++i) {
    Command command;
    if (!take(in, setup_.objects[sender].motions.size(), command)) return count("datagrams_refused");
    const auto tick = static_cast<std::int64_t>(first + i);
    if (tick >= from.next) from.by_tick.try_emplace(tick, std::move(command));
  }
  while (from.by_tick.contains(from.next)) ++from.next;
  from.gap = !from.by_tick.empty() && from.by_tick.rbegin()->first >= from.next;
  for (std::size_t i = 0; i < players_.size(); ++i) {
    std::uint64_t wanted = 0;
    if (!replication::take_varint(in, wanted)) return count("datagrams_refused");
    if (i == self_ && wanted > 0) from.wanted = static_cast<std::int64_t>(wanted) - 1;
  }
}

void LockstepPlayer::on_tick(SimTime now, std::int64_t tick) {
  const double tick_s = setup_.tick_s();
  Command command = commands_.sample(static_cast<double>(tick) * tick_s, tick_s, driven_at_);
  for (std::size_t i = 0; i < driven_at_.size(); ++i) {
    driven_at_[i] = advance(driven(driven_at_[i], command.drives[i]), tick_s).pose();
  }
  Inputs& own = players_[self_];
  own.by_tick.emplace(tick, std::move(command));
  own.next = tick + 1;
  send_inputs(now, tick);
  run_ready_ticks(now, tick);
}

void LockstepPlayer::run_ready_ticks(SimTime now, std::int64_t until) {
  while (game_->ticks() <= until &&
         std::ranges::all_of(players_, [&](const Inputs& p) { return p.next > game_->ticks(); })) {
    const std::int64_t tick = game_->ticks();
    std::vector<replication::OwnSample> samples;
    for (std::size_t i = 0; i < players_.size(); ++i) {
      Inputs& player = players_[i];
      const Command& command = player.by_tick.at(tick);
      std::size_t k = 0;
      for (const auto& [object, motion] : setup_.objects[i].motions) {
        const KinematicState state = driven(player.at[k], command.drives[k]);
        samples.push_back({object, state});
        player.at[k++] = advance(state, setup_.tick_s()).pose();
      }
    }
    game_->run_tick(samples);
    for (std::size_t i = 0; i < players_.size(); ++i) {
      for (const KeyEvent& key : players_[i].by_tick.at(tick).keys) {
        if (!game_->press(i, key) && i == self_) count("keys_without_effect");
      }
      // Others may still ask for own inputs of the past.
      if (i != self_) players_[i].by_tick.erase(players_[i].by_tick.begin(), players_[i].by_tick.upper_bound(tick));
    }
    count("ticks");
    count("ticks_waited", static_cast<std::uint64_t>(until - tick));
    for (const replication::ContactSeen& seen : game_->take_contacts()) {
      const std::size_t a = setup_.owner_of(seen.contact.collider), b = setup_.owner_of(seen.contact.collidee);
      const bool is_shared = is_player(a) && is_player(b) && a != b;
      const bool is_mine = std::min(a, b) == self_;
      note_contact(now,
                   is_shared                   ? (is_mine ? "decided" : "applied")
                   : is_mine                   ? "owner"
                   : is_player(std::min(a, b)) ? "predicted"
                                               : "scene",
                   seen.contact);
    }
  }
  Inputs& own = players_[self_];
  constexpr std::int64_t kKept = 65'536;  // ticks that somebody may still ask for
  own.by_tick.erase(own.by_tick.begin(), own.by_tick.lower_bound(game_->ticks() - kKept));
}

// Doom shows the last tick as it is.
void LockstepPlayer::record(SimTime now) {
  const double t_s = to_seconds(now - game_->start());
  for (std::size_t i = 0; i < players_.size(); ++i) {
    for (const ObjectId object : setup_.objects[i].owned) {
      const KinematicState state = game_->state(object);
      const auto motion = setup_.objects[i].motions.find(object);
      const bool is_own_driven = i == self_ && motion != setup_.objects[i].motions.end();
      note_sample(now, object, is_own_driven ? motion->second.sample(t_s) : state, state.pose());
    }
  }
}

}  // namespace peerd::baselines
