#include "peerd/net/greeting/relay_choice.hpp"

#include <algorithm>
#include <cassert>
#include <tuple>
#include <utility>

namespace peerd::net {

namespace {

constexpr Duration kGreetedApart = std::chrono::milliseconds(400), kGreetedApartWithDatagrams = std::chrono::seconds(1);
constexpr Duration kKeptByDatagrams = std::chrono::seconds(3);

}  // namespace

using asio::ip::udp;

RelayChoice::RelayChoice(Options options) : options_(std::move(options)) {
  for (const udp::endpoint& at : options_.relays) {
    if (find(at) == nullptr) relays_.push_back({.at = at});
  }
}

RelayChoice::Relay* RelayChoice::find(const udp::endpoint& at) {
  const auto found = std::ranges::find(relays_, at, &Relay::at);
  return found == relays_.end() ? nullptr : &*found;
}

void RelayChoice::on_greeting(HostTime now, Relay& relay, const Greeting& greeting) {
  const bool is_new = relay.instance != greeting.instance;
  if (!is_new && greeting.link && !relay.meter.on_note(now, *greeting.link)) return;  // recorded, or overtaken
  relay.number = greeting.number;
  if (is_new && greeting.leaving) return;  // of a process that has ended before this one
  relay.instance = greeting.instance;
  if (is_new) {  // it has been started anew
    relay.meter = {};
    relay.path.clear();
    relay.regions.clear();
    relay.all_regions = false;
  }
  if (greeting.leaving) {
    relay.last_received.reset();
    return;
  }
  if (!greeting.link) return;  // it does not know this process yet, or never will: it may be full
  if (is_new && !relay.meter.on_note(now, *greeting.link)) return;
  if (!answers(relay, now)) relay.answers_since = now;
  relay.last_received = relay.greeting_at = now;
  relay.path = greeting.link->path;
  relay.detached = greeting.link->detached;
  relay.all_regions = greeting.all_regions;
  relay.regions = greeting.regions;
}

void RelayChoice::on_datagram(HostTime now) {
  assert(chosen_);
  Relay& relay = relays_[*chosen_];
  relay.meter.count_in();
  relay.datagram_at = now;
  // Datagrams have no key of the link: alone they show for a while that the relay is there.
  if (now - relay.greeting_at <= kKeptByDatagrams) relay.last_received = now;
}

bool RelayChoice::is_greeting_due(const Relay& relay, HostTime now) const {
  const bool sends = &relay == chosen() && now - relay.datagram_at <= kGreetedApart;
  return now - relay.greeted >= (sends ? kGreetedApartWithDatagrams : kGreetedApart);
}

bool RelayChoice::answers(const Relay& relay, HostTime now) const {
  return relay.last_received && now - *relay.last_received <= options_.silence;
}

// Relays whose paths lead to each other would pass datagrams round. A new choice may not close such a circle. Where two
// have chosen each other at the same time, the one with the lowest instance of the circle lets go, and becomes the root
// of the others.
bool RelayChoice::leads_back(std::size_t relay) const {
  const std::vector<std::uint32_t>& path = relays_[relay].path;
  const auto self = std::ranges::find(path, options_.self);
  if (self == path.end()) return false;
  return relay != chosen_ || std::all_of(path.begin(), self, [&](std::uint32_t each) { return options_.self < each; });
}

bool RelayChoice::update(HostTime now) {
  const auto before = chosen_;
  const auto rank = [&](std::size_t i) { return std::tuple(relays_[i].detached, relays_[i].meter.is_lossy(), i); };
  const auto usable = [&](std::size_t i) { return answers(relays_[i], now) && !leads_back(i); };
  if (chosen_ && !usable(*chosen_)) chosen_.reset();
  for (std::size_t i = 0; i < relays_.size(); ++i) {
    if (!usable(i)) continue;
    const bool steady = now - relays_[i].answers_since >= options_.steady;
    if (!chosen_ || (steady && rank(i) < rank(*chosen_))) chosen_ = i;
  }
  return chosen_ != before;
}

bool RelayChoice::wants(const Relay& relay, RegionId region) {
  return relay.all_regions || std::ranges::binary_search(relay.regions, region);
}

}  // namespace peerd::net
