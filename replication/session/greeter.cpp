#include "replication/session/greeter.hpp"

#include <algorithm>
#include <cassert>
#include <tuple>
#include <utility>

#include "core/mixed_bits.hpp"
#include "replication/wire/hello_lists.hpp"

namespace peerd::replication {
namespace {

// Hellos come faster until this peer has a session, so that joining takes tenths of a second.
constexpr Duration kJoiningHelloPeriod = std::chrono::milliseconds(100);
// A peer that joins measures its clock and its loss with hellos: for so long they are not rare.
constexpr Duration kSettling = std::chrono::seconds(4);
// One hello in so many has an introduction; and so many hellos in a row have one whenever something in it is new, more
// of them where the loss asks for it.
constexpr std::size_t kIntroductionEvery = 8;
constexpr std::uint32_t kIntroductionRepeats = 3, kIntroductionRepeatsMax = 6;
// The most own objects in an introduction. 13 echoes of at most 33 bytes, these objects, kNotesMax notes of at most 30,
// a viewpoint of at most 102, a name of 64 and kSubscriptionsWithHello regions of at most 7, and 11 for them all, fit
// into a datagram. The 9 bytes of owned_as_founder are there instead of one of the regions.
constexpr std::size_t kOwnedMax = 50, kOwnedMax_bytes = 131;
static_assert(kOwnedMax <= 64, "each has a bit in owned_as_founder");
// The most lost peers that are remembered: more than one network carries.
constexpr std::size_t kLostPeersMax = 4096;
// The peer that leads a large session says hello to all so often, and as often as joining peers do while one of them
// waits for its echo: each far hello is echoed once.
constexpr Duration kLeadersFarPeriod = std::chrono::milliseconds(500);
// So many far hellos go soon after each other when a session becomes large, or this peer ceases to lead, so that nobody
// takes this peer for lost because its other hellos do not come any more.
constexpr std::size_t kFarAtOnce = 3;

// Lists too long for one datagram take turns: of `size` entries at most `most`, from the `first` one on, going round.
template <class Take>
void take_turns(std::size_t first, std::size_t size, std::size_t most, Take take) {
  for (std::size_t i = 0; i < std::min(size, most); ++i) take((first + i) % size);
}

}  // namespace

Greeter::Greeter(const PeerConfig& config, const Membership& members) : config_(config), members_(members) {}

void Greeter::greet_anew(HostTime now) {
  next_hello_ = now;
  settle_from(now);
}

void Greeter::settle_from(HostTime now) { settling_until_ = now + kSettling; }

void Greeter::hurry() {
  assert(next_hello_);
  next_hello_ = std::min(*next_hello_, last_hello_ + config_.hello_period);
}

void Greeter::schedule_next(HostTime now, bool synchronised) {
  last_hello_ = now;
  next_hello_ = now + (synchronised ? config_.settled_hello_period : kJoiningHelloPeriod);
}

bool Greeter::needs_keepalive(HostTime now, std::uint32_t last_number) const {
  assert(last_number >= last_sent_number_);
  return last_number == last_sent_number_ && now - last_sent_at_ >= config_.hello_period;
}

void Greeter::note_sent(HostTime now, std::uint32_t last_number) {
  if (last_number == last_sent_number_) return;
  last_sent_number_ = last_number;
  last_sent_at_ = now;
}

HostTime Greeter::next_deadline() const {
  return next_hello_ ? std::min(*next_hello_, last_sent_at_ + config_.hello_period) : HostTime::min();
}

void Greeter::on_session_entered(std::size_t own_objects) {
  ++sessions_;
  reintroduce(own_objects);
}

void Greeter::reintroduce(std::size_t own_objects) {
  const std::uint32_t times =
      std::max(kIntroductionRepeats, copies_against(members_.worst_loss_to_peers(), kIntroductionRepeatsMax));
  introductions_due_ = times * (1 + own_objects / kOwnedMax);
  assert(introductions_due_ > 0);
}

bool Greeter::must_introduce(bool synchronised) const {
  return !synchronised || introductions_due_ > 0 || std::ranges::any_of(members_.all(), [&](const auto& entry) {
    const Member& member = entry.second;
    if (members_.is_large() && (!member.is_near || member.hello == 0)) return false;  // its far hellos know this peer
    return !member.echo.echoes_us && !member.echo.unreachable;
  });
}

void Greeter::on_size_changed(HostTime now, std::uint32_t last_number) {
  last_sent_number_ = last_number;
  last_sent_at_ = now;
  far_at_once_ = members_.is_large() ? kFarAtOnce : 0;
  last_far_ = HostTime::min();
  greet_anew(now);
}

Duration Greeter::far_interval(HostTime now, bool leads) const {
  if (leads) return members_.has_joining(now) ? kJoiningHelloPeriod : kLeadersFarPeriod;
  const Duration mean = std::max<Duration>(config_.settled_hello_period, members_.mean_far_interval());
  // Between half of it and one and a half, by bits that no other peer has.
  const std::uint64_t bits = mixed_bits(mixed_bits(config_.incarnation ^ config_.id.value) + far_hellos_);
  const double share = 0.5 + static_cast<double>(bits >> 11) * 0x1.0p-53;
  return from_seconds(to_seconds(mean) * share);
}

bool Greeter::is_far_due(HostTime now, bool leads) {
  if (!members_.is_large()) return false;
  // Nobody may wait for the next one as for that of a leader.
  if (std::exchange(led_, leads) && !leads) far_at_once_ = kFarAtOnce;
  if (last_far_ == HostTime::min()) return true;
  const Duration interval = far_at_once_ > 0 ? config_.hello_period : far_interval(now, leads);
  return now - last_far_ >= interval;
}

Duration Greeter::schedule_next_far(HostTime now, bool leads) {
  assert(members_.is_large());
  last_far_ = now;
  ++far_hellos_;
  if (far_at_once_ > 0) --far_at_once_;
  if (leads) return kLeadersFarPeriod;
  // More peers may have come by then.
  return 2 * std::max<Duration>(config_.settled_hello_period, members_.mean_far_interval());
}

void Greeter::fill_far_echoes(Hello& hello, HostTime now, Membership& members) {
  struct Candidate {
    bool synchronised;
    HostTime echoed_at;
    PeerId peer;
    FarHello* hello;
  };
  std::vector<Candidate> waiting;
  assert(hello.echoes.empty());
  members.for_each([&](PeerId peer, OtherPeer& other) {
    FarHello& far = other.far_hello;
    if (far.number != 0 && far.number != far.echoed && now - far.rx <= kHeldMax) {
      waiting.push_back({other.synchronised, far.echoed_at, peer, &far});
    }
  });
  std::ranges::sort(waiting, {}, [](const Candidate& c) { return std::tuple(c.synchronised, c.echoed_at, c.peer); });
  for (std::size_t i = 0; i < std::min(waiting.size(), kEchoesMax); ++i) {
    FarHello& far = *waiting[i].hello;
    far.echoed = far.number;
    far.echoed_at = now;
    // The peers that receive it read the times alone. A full run is the shortest to send.
    const Received all{far.number, std::min(far.number, Received::kRunMax), ~std::uint64_t{0}};
    hello.echoes.push_back({waiting[i].peer, far.number, now - far.rx, all, 0.0});
  }
}

bool Greeter::introduces(bool synchronised) const {
  return must_introduce(synchronised) || hellos_ % kIntroductionEvery == 0;
}

// A peer without a session waits for its echoes: where they take turns, every other hello begins with the next one of
// those peers.
void Greeter::fill_echoes(Hello& hello, HostTime now, bool cuts_regions) {
  const auto is_new = [](const auto& entry) { return !entry.second.synchronised; };
  const bool newcomers = std::ranges::any_of(members_.all(), is_new);
  const std::size_t turn = members_.hellos_in_a_turn(), unnamed = turn > 1 && newcomers ? 2 * turn : turn;
  std::vector<std::pair<PeerId, const Member*>> echoable;
  std::vector<std::size_t> echoable_new;
  for (const auto& [peer, member] : members_.all()) {
    const LossMeter* const received = member.received_on(members_.channel());
    if (const auto lost = lost_peers_.find(peer); lost != lost_peers_.end()) {
      if (lost->second++ < unnamed) continue;
      lost_peers_.erase(lost);
    }
    if (member.hello == 0 || now - member.hello_rx > kHeldMax) continue;
    if (received == nullptr || member.echoes_on != members_.channel()) continue;
    if (!member.synchronised) echoable_new.push_back(echoable.size());
    echoable.emplace_back(peer, &member);
  }
  const bool for_new = !echoable_new.empty() && hellos_ % 2 == 1;
  const std::size_t first = for_new ? echoable_new[hellos_ / 2 % echoable_new.size()] : kEchoesStep * echo_turns_++;
  const double mean_loss = members_.mean_loss();
  take_turns(first, echoable.size(), kEchoesMax, [&](std::size_t i) {
    const auto& [peer, member] = echoable[i];
    const LossMeter& meter = *member->received_on(members_.channel());
    // Regions keep most of a far peer's datagrams away, so that its hellos alone would take long to show a good link:
    // the mean loss of all members counts, too.
    const LossMeter all = member->received_in_all();
    const double loss = cuts_regions ? all.loss(mean_loss) : all.loss();
    hello.echoes.push_back({peer, member->hello, now - member->hello_rx, meter.received(), loss});
  });
  assert(hello.echoes.size() <= kEchoesMax);
}

Introduction Greeter::introduction(std::span<const ObjectId> own, std::optional<SimTime> start,
                                   std::optional<SimTime> world_zero) {
  assert(std::ranges::is_sorted(own));
  Introduction i{config_.name, config_.world_hash, {}, 0, start, world_zero, config_.decisions.viewpoint};
  const auto next = last_introduced_ ? std::ranges::upper_bound(own, *last_introduced_) : own.begin();
  std::vector<ObjectId> turn;
  take_turns(static_cast<std::size_t>(next - own.begin()), own.size(), kOwnedMax,
             [&](std::size_t k) { turn.push_back(own[k]); });
  for (; !turn.empty(); turn.pop_back()) {
    i.owned = turn;
    std::ranges::sort(i.owned);
    if (packed(i.owned).size() <= kOwnedMax_bytes) break;
  }
  assert((own.empty() || !turn.empty()) && "one fits by itself");
  if (!turn.empty()) last_introduced_ = turn.back();
  if (introductions_due_ > 0) --introductions_due_;
  return i;
}

void Greeter::on_hello_sent(HostTime now, RegionId channel, std::uint32_t number) {
  if (channel == members_.channel()) ++hellos_;
  while (!sent_hellos_.empty() && now - sent_hellos_.front().at > kHeldMax) sent_hellos_.pop_front();
  sent_hellos_.push_back({channel, number, now});
}

std::optional<HostTime> Greeter::sent_at(RegionId channel, std::uint32_t number) const {
  const auto sent = std::ranges::find_if(
      sent_hellos_, [&](const SentHello& each) { return each.channel == channel && each.number == number; });
  return sent == sent_hellos_.end() ? std::nullopt : std::optional(sent->at);
}

void Greeter::on_peer_lost(PeerId peer) {
  if (lost_peers_.size() < kLostPeersMax) lost_peers_[peer] = 0;
}

}  // namespace peerd::replication
