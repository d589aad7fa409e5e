// Peer: what goes out.
#include <algorithm>
#include <cassert>
#include <utility>

#include "replication/peer.hpp"

namespace peerd::replication {
namespace {

// What a datagram's header (version, sender, boot, number) leaves for records.
constexpr std::size_t kRecordsMax_bytes = kDatagramMax_bytes - 28 - kUpdatesHeader_bytes;
// Per hello. 15 echoes of at most 29 bytes, 50 objects of at most 5, kNotesMax notes of at most 31 and a viewpoint of
// at most 97 fit.
constexpr std::size_t kEchoesMax = 15;
constexpr std::size_t kEnslavedMax = 50;
// A state that has not been replaced for so long is one that stays for a while.
constexpr Duration kStandsFor = std::chrono::seconds(1);

}  // namespace

Message Peer::blank() const {
  Message m;
  m.sender = config_.id;
  m.boot = config_.boot;
  return m;
}

// A state that nothing newer has replaced goes out once more with a hello: a lost one would stand wrong until the time
// threshold. With the next one where datagrams do get lost; elsewhere when it has stood for a while, so that where
// updates come fast there is nothing to repeat.
void Peer::repeat_updates(HostTime now) {
  const bool lossy = copies_against(loss(), 2) > 1;
  for (auto& [object, own] : own_) {
    if (!own.to_repeat) continue;
    if (!lossy && clock_.to_session(now) - own.to_repeat->at < kStandsFor) continue;
    const bool due_anyway =
        std::ranges::any_of(updates_due_, [&](const UpdateRecord& u) { return u.object == object; });
    if (due_anyway) continue;  // it goes out for the first time just now
    updates_due_.push_back(*std::exchange(own.to_repeat, std::nullopt));
    ++counters_.updates_repeated;
  }
}

// What the worst of the others says it loses of what this peer sends.
double Peer::loss() const {
  double worst = 0.0;
  for (const auto& [peer, member] : members_.all()) {
    worst = std::max(worst, member.loss_of_ours.value_or(LossMeter{}.loss()));
  }
  return worst;
}

// Where an update's loss would cost more than its bytes: again at once in another datagram, then with the ticks that
// follow, while nothing newer goes.
void Peer::send_copies() {
  const std::uint32_t times = copies_against(loss(), config_.policy.copies);
  if (times == 1) return;
  for (auto& [object, own] : own_) {
    if (!own.to_repeat || own.times_sent >= times) continue;
    ++own.times_sent;
    copies_due_.push_back(*own.to_repeat);
    ++counters_.updates_repeated;
  }
}

// Updates and decisions, as few datagrams as hold them. A decision's copies go out a tick apart.
void Peer::flush_records(bool decisions) {
  Message m = blank();
  std::size_t used_bytes = 0;
  const auto make_room = [&](std::size_t size_bytes) {
    if (used_bytes > 0 && used_bytes + size_bytes > kRecordsMax_bytes) {
      send(m);
      m = blank();
      used_bytes = 0;
    }
    used_bytes += size_bytes;
  };
  for (const UpdateRecord& update : std::exchange(updates_due_, {})) {
    make_room(encoded_size_bytes(update, m.updates.empty() ? update.at : m.updates.front().at));
    m.updates.push_back(update);
  }
  for (DecisionLog::Entry& entry : decisions_.entries()) {
    if (!decisions) break;
    if (entry.copies == 0) continue;
    make_room(encoded_size_bytes(entry.record));
    m.decisions.push_back(entry.record);
    --entry.copies;
  }
  if (used_bytes > 0) send(m);
  if (copies_due_.empty()) return;
  updates_due_ = std::exchange(copies_due_, {});
  flush_records(false);
}

void Peer::send_hello(HostTime now, bool leaving) {
  Message m = blank();
  m.has_hello = true;
  m.leaving = leaving;
  m.hello = {config_.name,
             config_.world_hash,
             now,
             clock_.synchronised(),
             clock_.session_minus_host(),
             sessions_,
             {},
             {},
             start_,
             world_zero_,
             own_latency(),
             config_.decisions.viewpoint,
             notes()};
  // Lists too long for one datagram take turns, hello by hello.
  const auto turns = [&](std::size_t size, std::size_t most, auto take) {
    for (std::size_t i = 0; i < std::min(size, most); ++i) take((hellos_ * most + i) % size);
  };
  std::vector<ClockEcho> echoes;
  for (const auto& [peer, member] : members_.all()) {
    if (member.hello_tx) echoes.push_back({peer, *member.hello_tx, *member.hello_rx, member.received.loss()});
  }
  turns(echoes.size(), kEchoesMax, [&](std::size_t i) { m.hello.echoes.push_back(echoes[i]); });
  std::vector<ObjectId> enslaved;
  for (const auto& [object, own] : own_) enslaved.push_back(object);
  turns(enslaved.size(), kEnslavedMax, [&](std::size_t i) { m.hello.enslaved.push_back(enslaved[i]); });
  ++hellos_;
  send(m);
}

void Peer::send(Message& message) {
  message.number = ++datagram_number_;
  Bytes datagram = encode(message);
  assert(datagram.size() <= kDatagramMax_bytes);
  ++counters_.datagrams_out;
  counters_.bytes_out += datagram.size();
  outputs_.push_back(Send{kWholeScene, std::move(datagram)});
}

}  // namespace peerd::replication
