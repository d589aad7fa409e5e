// Peer: what goes out.
#include <algorithm>
#include <cassert>
#include <unordered_set>
#include <utility>

#include "replication/wire/hello_lists.hpp"
#include "replication/peer.hpp"
#include "replication/wire/wire_limits.hpp"

namespace peerd::replication {
namespace {

// What a datagram's header (version, sender, number, the boot's low bits) leaves for records.
constexpr std::size_t kRecordsMax_bytes = kDatagramMax_bytes - 19 - kUpdatesHeader_bytes - kDecisionsHeader_bytes;
// Per introduction. 15 echoes of at most 33 bytes, 50 objects of 216 in all, kNotesMax notes of at most 20, a viewpoint
// of at most 97, a name of 64 and kSubscriptionsWithHello regions of at most 7, and 11 for them all, fit.
constexpr std::size_t kOwnedMax = 50;
// With one hello in so many a peer says who it is, to whom it may concern; and with so many in a row that something
// new, more of them where the loss asks for it.
constexpr std::size_t kIntroductionEvery = 8;
constexpr std::uint32_t kIntroductionRepeats = 3, kIntroductionRepeatsMax = 6;
// Without receipts: a state that has not been replaced for so long is one that stays for a while.
constexpr Duration kUnreplacedFor = std::chrono::seconds(1);
// So often at most goes a state out again with hellos; enough for three in ten lost (0.3^6 = 0.0007).
constexpr std::uint32_t kWithHellosMax = 5;
// A Gone: three varints; the first also takes the list's tag and length.
constexpr std::size_t kHandoverMax_bytes = 15 + 4;
// At most, of what somebody may know nothing without: enough for one in five lost (0.2^4 = 0.0016).
constexpr std::uint32_t kCopiesToArrive = 4;

// Lists too long for one datagram take turns: of `size` entries at most `most`, from the `first` one on, going round.
template <class Take>
void take_turns(std::size_t first, std::size_t size, std::size_t most, Take take) {
  for (std::size_t i = 0; i < std::min(size, most); ++i) take((first + i) % size);
}

}  // namespace

Message Peer::blank() const {
  Message m;
  m.sender = config_.id;
  m.incarnation = config_.incarnation;
  return m;
}

// Within which somebody's hello says whether what goes out now has come there, if neither gets lost.
Duration Peer::answered_within() const {
  return 2 * longest_latency() +
         static_cast<std::int64_t>(hellos_to_name(members_.all().size())) * config_.settled_hello_period;
}

// A state that nothing newer has replaced goes out again with hellos, or a lost one would stand wrong until the time
// threshold: with the next one where datagrams do get lost, and whenever somebody's hello says that the last one did;
// where no hello says anything in time, as often as the loss asks for.
void Peer::repeat_updates(HostTime now) {
  if (over_byte_budget_) return;
  const bool lossy = copies_against(loss(), 2) > 1;
  const bool acknowledged = !grid_.cuts();  // regions have none
  const std::uint32_t most = acknowledged ? kWithHellosMax : 1;
  const Duration patience = acknowledged ? answered_within() : kUnreplacedFor;
  const SimTime t = clock_.to_session(now);
  std::unordered_set<ObjectId> due_anyway;  // they go out for the first time just now
  for (const EncodedUpdate& u : updates_due_) due_anyway.insert(u.record().object);
  for (auto& [object, own] : own_objects_) {
    if (!own.to_repeat || own.times_with_hello >= most || is_acknowledged_by_all(own)) continue;
    const bool lost = !own.sent_in.empty() && std::ranges::any_of(members_.all(), [&](const auto& entry) {
      const auto& [peer, member] = entry;
      return !own.acknowledged_by.contains(peer) && member.acknowledgement && member.acknowledgement->surely_lost(own.sent_in.back());
    });
    const bool first = own.times_with_hello == 0;
    const bool overdue =
        first ? lossy || t - *own.last_sent >= patience
              : now - own.with_hello_at >= patience && own.sent_in.size() < copies_against(loss(), 1 + kWithHellosMax);
    if (!lost && !overdue) continue;
    if (due_anyway.contains(object)) continue;
    if (t + longest_latency() - own.to_repeat->at > kUpdateAgeMax) {
      own.resend = true;  // nobody would take what is so old: the next tick tells how it goes by now
      schedule_check(object);
      continue;
    }
    ++own.times_with_hello;
    own.with_hello_at = now;
    updates_due_.emplace_back(*own.to_repeat, own.to_repeat->at);
    ++counters_.updates_repeated;
  }
}

// Before something newer is told of it.
void Peer::note_unacknowledged(OwnObject& own, SimTime t) {
  if (t - *own.last_sent < answered_within()) return;
  for (const auto& [peer, member] : members_.all()) {
    if (!own.acknowledged_by.contains(peer)) own.unacknowledged_by.insert(peer);
  }
}

// Its last update.
bool Peer::is_acknowledged_by_all(const OwnObject& own) const { return own.acknowledged_by.size() == members_.all().size(); }

// What the worst of the others says it loses of what this peer sends.
double Peer::loss() const {
  double worst = 0.0;
  for (const auto& [peer, member] : members_.all()) {
    if (!member.unreachable) worst = std::max(worst, member.loss_to_peer.value_or(LossMeter{}.loss()));
  }
  return worst;
}

// .. and this peer of what comes from that one; `others`: on average of what comes from all. Where regions keep most of
// a far peer's datagrams away, hellos alone would take long to tell a good link: what comes from the others tells too.
double Peer::loss_of(const Member& member, double others) const {
  const LossMeter meter = member.received_in_all();
  return grid_.cuts() ? meter.loss(others) : meter.loss();
}

// Where an update's loss would cost more than its bytes: again at once in another datagram, then with the ticks that
// follow, while nothing newer goes.
void Peer::send_copies() {
  if (over_byte_budget_) return;
  const double loss_now = loss();
  const std::uint32_t usual = copies_against(loss_now, config_.policy.copies);
  const std::uint32_t to_arrive = copies_against(loss_now, std::max(config_.policy.copies, kCopiesToArrive));
  if (to_arrive > copies_wanted_) {  // what has gone out often enough so far may not have any more
    for (auto& [object, own] : own_objects_) copy_later(object, own);
  }
  copies_wanted_ = to_arrive;
  std::ranges::sort(copying_);
  auto kept = copying_.begin();
  for (const ObjectId object : copying_) {
    const auto at = own_objects_.find(object);
    if (at == own_objects_.end()) continue;  // another peer's by now
    OwnObject& own = at->second;
    const std::uint32_t times = own.copy_until_received ? to_arrive : usual;
    if (own.to_repeat && own.times_sent < times) {
      ++own.times_sent;
      copies_due_.emplace_back(*own.to_repeat, own.to_repeat->at);
      ++counters_.updates_repeated;
    }
    own.copying = own.to_repeat && own.times_sent < times;
    if (own.copying) *kept++ = object;
  }
  copying_.erase(kept, copying_.end());
}

// With the next send_copies(), as often as the loss then asks for.
void Peer::copy_later(ObjectId object, OwnObject& own) {
  if (!std::exchange(own.copying, true)) copying_.push_back(object);
}

// Updates, decisions and what has gone, as few datagrams as hold them, each region's by themselves. Copies of decisions
// and of what has gone go out a tick apart.
void Peer::flush_records(bool decisions) {
  if (grid_.cuts()) {
    std::map<RegionId, Batch> due;
    if (decisions) due[kWholeScene];
    for (const EncodedUpdate& u : updates_due_) {
      due[grid_.region_of(u.record().model.state.position)].updates.push_back(u);
    }
    if (decisions) sort_handovers(due);
    for (auto& [region, records] : due) {
      flush_region(region, records.handovers, records.updates, decisions && region == kWholeScene);
    }
  } else {
    flush_region(kWholeScene, {}, updates_due_, decisions);
  }
  updates_due_.clear();
  if (copies_due_.empty()) return;
  std::swap(updates_due_, copies_due_);
  flush_records(false);
}

void Peer::flush_region(RegionId region, std::span<const Handover> handovers, std::span<EncodedUpdate> updates, bool decisions) {
  Message m = blank();
  std::size_t used_bytes = 0, first = 0, next = 0;  // of the updates, m goes with [first, next)
  const auto send_all = [&] { send(m, region, updates.subspan(first, next - first)); };
  const auto make_room = [&](std::size_t size_bytes) {
    if (used_bytes > 0 && used_bytes + size_bytes > kRecordsMax_bytes) {
      send_all();
      m = blank();
      first = next;
      used_bytes = 0;
    }
    used_bytes += size_bytes;
  };
  for (const Handover& g : handovers) {
    make_room(kHandoverMax_bytes);
    m.handovers.push_back(g);
  }
  for (; next < updates.size(); ++next) {
    EncodedUpdate& update = updates[next];
    update.count_from(updates[first].record().at);
    make_room(update.bytes().size());
    update.count_from(updates[first].record().at);  // itself, where it comes first in another datagram
  }
  for (DecisionLog::Entry& entry : decisions_.entries()) {
    if (!decisions) break;
    if (entry.copies == 0) continue;
    make_room(encoded_size_bytes(entry.record));
    m.decisions.push_back(entry.record);
    --entry.copies;
  }
  if (used_bytes > 0) send_all();
}

void Peer::reintroduce() {
  const std::uint32_t times = std::max(kIntroductionRepeats, copies_against(loss(), kIntroductionRepeatsMax));
  introductions_due_ = times * (1 + own_objects_.size() / kOwnedMax);
}

// Whoever is new here, or has news, or is not known to somebody who may hear it, says who it is.
bool Peer::must_introduce() const {
  return !clock_.synchronised() || introductions_due_ > 0 || std::ranges::any_of(members_.all(), [](const auto& entry) {
    return !entry.second.echoes_us && !entry.second.unreachable;
  });
}

// Nobody waits for what this peer's next hello says: all have a session, know each other and each other's clocks, what
// is sent arrives, and no contact is open that this peer has found or may be the one to decide.
bool Peer::settled(HostTime now) const {
  const auto awaits_our_decision = [](const auto& entry) { return entry.second.awaits_our_decision || !entry.second.synchronised; };
  return replica_ && now >= settling_until_ && !must_introduce() && copies_against(loss(), 2) == 1 && deferred_contacts_.empty() &&
         std::ranges::none_of(members_.all(), awaits_our_decision);
}

Introduction Peer::introduction() {
  Introduction i{config_.name, config_.world_hash, {}, start_, world_zero_, config_.decisions.viewpoint};
  std::vector<ObjectId> owned;
  for (const auto& [object, own] : own_objects_) owned.push_back(object);
  take_turns(introductions_ * kOwnedMax, owned.size(), kOwnedMax,
             [&](std::size_t k) { i.owned.push_back(owned[k]); });
  std::ranges::sort(i.owned);
  ++introductions_;
  if (introductions_due_ > 0) --introductions_due_;
  return i;
}

void Peer::send_hello(HostTime now, bool leaving) {
  Message m = blank();
  m.leaving = leaving;
  Hello& hello = m.hello.emplace();
  if (const auto error = clock_.error_bound(now); error && *error <= kClockErrorMax) {
    hello.session_tx = clock_.to_session(now);
    if (follows_ != config_.id) hello.clock_error = *error;
    hello.os_clock = os_clock_note(now);
  }
  hello.sessions = sessions_;
  hello.latency = own_latency();
  hello.notes = contact_notes_to_send();
  // Who has no session yet waits for its echoes: where they take turns every other hello begins with the next one of
  // those.
  const auto is_new = [](const auto& entry) { return !entry.second.synchronised; };
  const bool newcomers = std::ranges::any_of(members_.all(), is_new);
  // Who was lost and finds no echo, though it was its turn, knows that it was.
  const std::size_t turn = hellos_to_name(members_.all().size()), unnamed = turn > 1 && newcomers ? 2 * turn : turn;
  std::vector<std::pair<PeerId, const Member*>> echoable;
  std::vector<std::size_t> echoable_new;
  for (const auto& [peer, member] : members_.all()) {
    const auto received = member.received.find(kWholeScene);
    if (const auto lost = lost_peers_.find(peer); lost != lost_peers_.end()) {
      if (lost->second++ < unnamed) continue;
      lost_peers_.erase(lost);
    }
    if (member.hello == 0 || now - member.hello_rx > kHeldMax) continue;
    if (received == member.received.end()) continue;
    if (!member.synchronised) echoable_new.push_back(echoable.size());
    echoable.emplace_back(peer, &member);
  }
  const bool for_new = !echoable_new.empty() && hellos_ % 2 == 1;
  const std::size_t first = for_new ? echoable_new[hellos_ / 2 % echoable_new.size()] : kEchoesStep * echo_turns_++;
  const double others = members_.mean_loss();
  take_turns(first, echoable.size(), kEchoesMax, [&](std::size_t i) {
    const auto& [peer, member] = echoable[i];
    const LossMeter& meter = member->received.at(kWholeScene);
    hello.echoes.push_back({peer, member->hello, now - member->hello_rx, meter.received(), loss_of(*member, others)});
  });
  if (must_introduce() || hellos_ % kIntroductionEvery == 0) hello.introduction = introduction();
  if (!leaving) m.subscriptions = take_subscriptions(kSubscriptionsWithHello, true);
  ++hellos_;
  send(m);
  while (!sent_hellos_.empty() && now - sent_hellos_.front().at > kHeldMax) sent_hellos_.pop_front();
  sent_hellos_.push_back({m.number, now});
}

// That this peer is here, and nothing else.
void Peer::send_keepalive() {
  Message m = blank();
  send(m);
}

void Peer::send(Message& message, RegionId region, std::span<const EncodedUpdate> updates) {
  message.number = ++datagram_numbers_[region];
  Bytes datagram;
  if (!spare_.empty()) {
    datagram = std::move(spare_.back());
    spare_.pop_back();
  }
  codec_.encode(message, updates, datagram);
  assert(datagram.size() <= kDatagramMax_bytes);
  ++counters_.datagrams_out;
  counters_.bytes_out += datagram.size();
  Counters::Traffic& traffic = counters_.regions[region];
  ++traffic.datagrams_out;
  traffic.bytes_out += datagram.size();
  bytes_.spend(datagram.size(), !updates.empty());
  outputs_.push_back(Send{region, std::move(datagram)});
  for (const EncodedUpdate& u : updates) {
    if (region != kWholeScene) break;
    const auto own = own_objects_.find(u.record().object);
    if (own != own_objects_.end() && own->second.sequence == u.record().sequence) own->second.sent_in.push_back(message.number);
  }
  for (const DecisionRecord& d : message.decisions) {
    decisions_.find(d.contact, config_.id, d.collider, d.collidee)->sent_in.push_back(message.number);
  }
}

}  // namespace peerd::replication
