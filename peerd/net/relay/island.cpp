#include "peerd/net/relay/island.hpp"

#include <algorithm>
#include <utility>

#include "peerd/net/greeting/read_greeting.hpp"

namespace peerd::relay {
namespace {

constexpr Duration kAsksApart = std::chrono::milliseconds(250), kFollowsApart = std::chrono::seconds(1);
constexpr Duration kRelaySilent = std::chrono::seconds(1), kMemberSilent = std::chrono::milliseconds(3'500);
// A relay that has just come listens first, so that two never pass on the same datagrams for longer than they need to
// hear each other.
constexpr Duration kListensFirst = std::chrono::milliseconds(600);
constexpr std::size_t kMembersMax = 4096, kRelaysMax = 64;

}  // namespace

std::expected<std::unique_ptr<Island>, net::NetError> Island::open(boost::asio::io_context& io,
                                                                   const net::HostClock& clock,
                                                                   const IslandOptions& options) {
  auto socket = net::MulticastSocket::open(io, clock, options.multicast);
  if (!socket) return std::unexpected(socket.error());
  if (auto joined = (*socket)->join(kWholeScene); !joined) return std::unexpected(joined.error());
  return std::unique_ptr<Island>(new Island(clock, *std::move(socket), options));
}

Island::Island(const net::HostClock& clock, std::unique_ptr<net::MulticastSocket> socket, const IslandOptions& options)
    : clock_(clock), socket_(std::move(socket)), options_(options), strangers_(options.key, {}), joined_{kWholeScene} {}

Island::~Island() {
  ask(clock_.now(), /*leaving=*/true);
  socket_->flush();
}

void Island::start(OnDatagram on_datagram, OnChange on_change) {
  on_datagram_ = std::move(on_datagram);
  on_change_ = std::move(on_change);
  listens_since_ = clock_.now();
  socket_->on_receive([this](const net::Arrival& arrival) { take(arrival); });
}

std::optional<std::string> Island::advance(HostTime now, const Place& place) {
  rank_ = {place.detached, place.distance, options_.instance};
  std::erase_if(relays_, [&](const auto& each) { return now - each.second.last_received > kRelaySilent; });
  const auto silent =
      std::erase_if(members_, [&](const auto& each) { return now - each.second.last_received > kMemberSilent; });
  const bool active = should_be_active(now);
  if (silent > 0 || active != active_) on_change_();
  if (now - asked_ >= kAsksApart) ask(now, /*leaving=*/false);
  if (now - followed_ >= kFollowsApart) {
    followed_ = now;
    if (auto change = socket_->follow_interface()) return std::move(change->sentence);
  }
  if (std::exchange(active_, active) != active) {
    follow();
    return socket_->chosen_interface().interface.name +
           (active ? ": passes on what peers there send and want" : ": another relay passes on what peers there send");
  }
  return std::exchange(finding_, std::nullopt);
}

bool Island::should_be_active(HostTime now) const {
  if (now - listens_since_ < kListensFirst) return false;
  return std::ranges::none_of(relays_, [&](const auto& each) { return each.second.rank < rank_; });
}

// The other relays' ranks follow from what they ask.
void Island::ask(HostTime now, bool leaving) {
  last_note_ns_ = std::max(now.time_since_epoch().count(), last_note_ns_ + 1);
  net::Greeting greeting{.instance = options_.instance, .leaving = leaving};
  greeting.link = net::LinkNote{.sent_at_ns = last_note_ns_, .detached = std::get<0>(rank_)};
  greeting.link->path.assign(std::min(std::get<1>(rank_), net::kRelayPathMax), options_.instance);
  const auto bytes = net::encode(greeting, options_.multicast.groups.base.is_v4());
  socket_->send(kWholeScene, options_.seal ? options_.seal->seal(bytes) : bytes);
  socket_->flush();
  asked_ = now;
}

void Island::take(const net::Arrival& arrival) {
  if (arrival.region == kWholeScene && net::looks_like_greeting(arrival.datagram)) return on_greeting(arrival);
  // While two relays do not agree yet, neither may pass on what the other one has brought.
  const bool of_relay = own_address_ == arrival.from ||
                        std::ranges::any_of(relays_, [&](const auto& each) { return each.second.at == arrival.from; });
  if (!active_ || of_relay) {
    ++left_to_others_;
    return;
  }
  on_datagram_(arrival.region, arrival.datagram, arrival.at);
}

void Island::on_greeting(const net::Arrival& arrival) {
  ++greetings_passed_;
  greeting_bytes_ += arrival.datagram.size();
  const auto greeting =
      net::read_greeting(arrival.datagram, options_.multicast.groups.base.is_v4(), options_.seal.get(), arrival.at,
                         arrival.from, strangers_, greeting_counters_);
  if (!greeting || !greeting->link) return;
  ++greeting_counters_.greetings_in;
  if (greeting->instance == options_.instance) {
    // This relay is there by another interface, too, which passes on what this one would.
    if (std::exchange(own_address_, arrival.from) != arrival.from) {
      finding_ = socket_->chosen_interface().interface.name +
                 ": this relay is on that network twice, and takes nothing from itself; name one of the interfaces";
    }
    return;
  }
  strangers_.has_proven(arrival.from.address(), arrival.at);
  if (greeting->link->path.empty()) return on_report(arrival, *greeting);
  on_relay(arrival, *greeting);
}

void Island::on_report(const net::Arrival& arrival, const net::Greeting& greeting) {
  const bool is_new = !members_.contains(greeting.instance);
  if (is_new && members_.size() >= kMembersMax) {
    finding_ = "more than " + std::to_string(kMembersMax) + " peers want something there: the others get nothing";
    return;
  }
  Member& member = members_[greeting.instance];
  if (!is_new && greeting.link->sent_at_ns <= member.note_ns) return;
  member.note_ns = greeting.link->sent_at_ns;
  member.last_received = arrival.at;
  const std::uint32_t offset = greeting.link->group_offset;
  if (!group_offset_) {
    group_offset_ = offset;
    socket_->follow_world(offset);
  } else if (offset != *group_offset_ && !std::exchange(is_other_world_said_, true)) {
    finding_ = arrival.from.address().to_string() +
               " is in another world than the first peer that was heard there: "
               "this relay passes on the whole scene of both, and the regions of the first one";
  }
  Wanted wanted{.all = greeting.all_regions};
  if (!wanted.all) wanted.regions = greeting.regions;
  const bool changed = member.wanted != wanted;
  member.wanted = std::move(wanted);
  if (greeting.leaving) members_.erase(greeting.instance);
  if (changed || greeting.leaving) on_change_();
}

void Island::on_relay(const net::Arrival& arrival, const net::Greeting& greeting) {
  if (greeting.leaving) {
    relays_.erase(greeting.instance);
    return;
  }
  if (!relays_.contains(greeting.instance) && relays_.size() >= kRelaysMax) return;
  OtherRelay& relay = relays_[greeting.instance];
  if (greeting.link->sent_at_ns <= relay.note_ns) return;
  relay = {greeting.link->sent_at_ns,
           arrival.at,
           {greeting.link->detached, greeting.link->path.size(), greeting.instance},
           arrival.from};
}

Wanted Island::wanted() const {
  Wanted wanted;
  if (!active_) return wanted;
  std::set<RegionId> regions{kWholeScene};
  for (const auto& [instance, member] : members_) {
    wanted.all = wanted.all || member.wanted.all;
    regions.insert(member.wanted.regions.begin(), member.wanted.regions.end());
  }
  if (!wanted.all) wanted.regions.assign(regions.begin(), regions.end());
  return wanted;
}

void Island::receive(const Wanted& wanted_elsewhere) {
  wanted_elsewhere_ = wanted_elsewhere;
  follow();
}

// The groups of regions are known when a peer has said the offset of its world. Nobody can join all groups that there
// are: where somebody wants all regions, those that the island's own peers want are among them.
void Island::follow() {
  std::set<RegionId> regions{kWholeScene};
  if (active_ && group_offset_) {
    regions.insert(wanted_elsewhere_.regions.begin(), wanted_elsewhere_.regions.end());
    if (wanted_elsewhere_.all) {
      const Wanted here = wanted();
      regions.insert(here.regions.begin(), here.regions.end());
    }
  }
  for (const RegionId region : joined_) {
    if (regions.contains(region)) continue;
    if (const auto left = socket_->leave(region); !left) finding_ = left.error().sentence;
  }
  for (auto region = regions.begin(); region != regions.end();) {
    const auto joined = joined_.contains(*region) ? std::expected<void, net::NetError>{} : socket_->join(*region);
    if (!joined) finding_ = joined.error().sentence;
    region = joined ? std::next(region) : regions.erase(region);
  }
  joined_ = std::move(regions);
}

const net::TrafficCounters& Island::counters() const {
  counters_ = socket_->counters();
  counters_.packets_in -= greetings_passed_;
  counters_.bytes_in -= greeting_bytes_;
  counters_.greetings_in = greeting_counters_.greetings_in;
  counters_.greetings_unopened = greeting_counters_.greetings_unopened;
  counters_.greetings_flood = greeting_counters_.greetings_flood;
  counters_.in_malformed += greeting_counters_.in_malformed;
  return counters_;
}

void Island::send(RegionId region, std::span<const std::byte> datagram) {
  if (active_) socket_->send(region, datagram);  // the table learns of a change a moment later
}

}  // namespace peerd::relay
