#include "peerd/net/relay/relay.hpp"

#include <boost/asio/post.hpp>

#include <algorithm>
#include <cassert>
#include <utility>

#include "peerd/net/greeting/address_text.hpp"
#include "peerd/net/greeting/read_greeting.hpp"
#include "peerd/net/os/udp_socket.hpp"

namespace peerd::relay {
namespace {

namespace asio = boost::asio;
using asio::ip::udp;
using net::RelayChoice;

constexpr LinkId kFirstNeighbour = 1024;  // the links before it are networks
constexpr Duration kStep = std::chrono::milliseconds(50);
constexpr Duration kNeighbourSilent = std::chrono::seconds(5);
constexpr int kRepeats = 2;
constexpr std::size_t kMostBytes = net::kMaxDatagramBytes + net::kRelayHeaderBytes;

Wanted wanted_of(bool all, const std::vector<RegionId>& regions) {
  return all ? Wanted{.all = true} : Wanted{.regions = regions};
}

}  // namespace

std::expected<std::unique_ptr<Relay>, net::NetError> Relay::open(asio::io_context& io, const net::HostClock& clock,
                                                                 const RelayOptions& options, Say say) {
  std::unique_ptr<Relay> opened(new Relay(io, clock, options, std::move(say)));
  udp::socket& socket = opened->receiver_.socket();
  const net::UdpOptions wanted{options.family == net::IpFamily::kV4, options.dscp, options.receive_buffer_bytes};
  if (auto good = net::open_udp(socket, wanted); !good) return std::unexpected(good.error());
  if (auto good = net::bind_udp(socket, options.port, "give this relay another port"); !good) {
    return std::unexpected(good.error());
  }
  return opened;
}

Relay::Relay(asio::io_context& io, const net::HostClock& clock, const RelayOptions& options, Say say)
    : io_(io),
      options_(options),
      say_(std::move(say)),
      reading_(clock, traffic_, kMostBytes),
      receiver_(io, reading_),
      queue_(kMostBytes),
      numbers_(options.key),
      parents_({.relays = options.parents, .self = numbers_.instance()}),
      strangers_(options.key, {}),
      neighbours_(kFirstNeighbour),
      timer_(io) {
  assert(say_);
  numbers_.advance(clock.now());
}

Relay::~Relay() {
  for (RelayChoice::Relay& parent : parents_.relays()) {
    if (parent.number != 0) greet(parent, /*leaving=*/true);
  }
  neighbours_.visit([&](Neighbour& each) {
    if (!each.is_parent) greet(each, /*leaving=*/true);
  });
  queue_.flush(receiver_.socket().native_handle(), traffic_);
}

std::uint16_t Relay::port() const { return receiver_.socket().local_endpoint().port(); }

void Relay::add(std::unique_ptr<Network> network) {
  assert(networks_.size() < kFirstNeighbour);
  networks_.push_back(std::move(network));
}

void Relay::start() {
  receiver_.start([this](const net::Received& received, HostTime at) { take(received, at); });
  for (std::size_t i = 0; i < networks_.size(); ++i) {
    networks_[i]->start(
        [this, link = static_cast<LinkId>(i)](RegionId region, std::span<const std::byte> datagram, HostTime at) {
          forward(link, {region}, datagram, at);
          finish_soon();
        },
        [this] { mark_changed(); });
  }
  mark_changed();
  advance();
}

// ---- datagrams

void Relay::take(const net::Received& received, HostTime at) {
  finish_soon();
  if (received.truncated) {
    ++traffic_.in_truncated;
  } else if (const auto header = net::read_relay_header(received.bytes)) {
    take_datagram(received, *header, at);
  } else {
    on_greeting(received, at);
  }
}

void Relay::take_datagram(const net::Received& received, const net::RelayHeader& header, HostTime at) {
  Neighbour* const from = neighbours_.find(received.from);
  if (from == nullptr) {
    ++traffic_.in_stranger;
    return;
  }
  ++traffic_.packets_in;
  traffic_.bytes_in += received.bytes.size();
  ++from->datagrams_in;
  from->bytes_in += received.bytes.size();
  from->is_parent ? parents_.on_datagram(at) : from->meter.count_in();
  if (header.hops == 0) {
    ++counters_.out_of_hops;
    return;
  }
  forward(from->link, {header.region, static_cast<std::uint8_t>(header.hops - 1)},
          received.bytes.subspan(net::kRelayHeaderBytes), at);
}

void Relay::forward(LinkId from, const net::RelayHeader& header, std::span<const std::byte> datagram, HostTime at) {
  if (header.region == kWholeScene && net::looks_like_greeting(datagram)) {
    ++counters_.greetings;  // those are of one link or island alone
    return;
  }
  const auto bytes = net::relay_header(header);
  bool is_wanted = false;
  table_.visit(header.region, [&](LinkId to) {
    if (to == from) return;
    is_wanted = true;
    if (to >= kFirstNeighbour) return send(neighbours_.of(to), bytes, header.region == kWholeScene, datagram, at);
    networks_[to]->send(header.region, datagram);
    ++counters_.forwarded;
  });
  if (!is_wanted) ++counters_.unwanted;
}

void Relay::send(Neighbour& to, const std::array<std::byte, net::kRelayHeaderBytes>& header, bool for_all,
                 std::span<const std::byte> datagram, HostTime at) {
  const std::size_t bytes = header.size() + datagram.size();
  if (to.budget && !to.budget->take(bytes, for_all, at)) {
    ++counters_.over_budget;
    ++to.over_budget;
    return;
  }
  push(to.at, header, datagram);
  ++counters_.forwarded;
  ++to.datagrams_out;
  to.bytes_out += bytes;
  (to.is_parent ? parents_.chosen()->meter : to.meter).count_out();
}

void Relay::push(const udp::endpoint& to, std::span<const std::byte> header, std::span<const std::byte> datagram) {
  if (queue_.full()) queue_.flush(receiver_.socket().native_handle(), traffic_);
  queue_.push(to, header, datagram);
}

// ---- greetings

void Relay::on_greeting(const net::Received& received, HostTime at) {
  const bool v4 = options_.family == net::IpFamily::kV4;
  const auto greeting =
      net::read_greeting(received.bytes, v4, options_.seal.get(), at, received.from, strangers_, traffic_);
  if (!greeting || greeting->instance == numbers_.instance()) return;
  ++traffic_.greetings_in;
  if (!numbers_.is_number_for(received.from, greeting->echo)) {
    // The answer is no longer than what has come.
    if (!greeting->leaving && (greeting->reply || greeting->echo != 0)) {
      send_greeting(received.from, {.echo = greeting->number, .reply = true});
    }
    return;
  }
  strangers_.has_proven(received.from.address(), at);
  RelayChoice::Relay* const parent = parents_.find(received.from);
  if (parent != nullptr) {
    const bool is_first = parent->number == 0 || !greeting->link;
    parents_.on_greeting(at, *parent, *greeting);
    choose_parent(at);
    if (is_first && !greeting->leaving) greet(*parent, /*leaving=*/false);
    if (parent == parents_.chosen()) {
      Neighbour& link = *neighbours_.find(received.from);
      if (table_.set(link.link, wanted_of(parent->all_regions, parent->regions))) mark_changed();
    }
    // Two relays may have each other in their lists, of which one is the child of the other.
    const bool is_child = greeting->link && greeting->link->path.size() > 1 && greeting->link->path[1] == instance();
    if (parent == parents_.chosen()) return;
    if (!is_child) {
      // It was one, and has chosen another parent.
      if (Neighbour* const former = neighbours_.find(received.from)) remove(*former);
      return;
    }
  }
  if (greeting->link || greeting->leaving) on_neighbour(received, *greeting, at);
}

void Relay::on_neighbour(const net::Received& received, const net::Greeting& greeting, HostTime at) {
  Neighbour* neighbour = neighbours_.find(received.from);
  if (greeting.leaving) {
    if (neighbour != nullptr && neighbour->instance == greeting.instance) remove(*neighbour);
    return;
  }
  if (neighbour != nullptr && neighbour->instance != greeting.instance) {  // another process has that address now
    remove(*neighbour);
    neighbour = nullptr;
  }
  if (neighbour == nullptr) {
    if (neighbours_.count() >= options_.neighbours_max) {
      ++counters_.refused;
      if (!std::exchange(full_said_, true)) {
        say_(true, "has as many neighbours as it takes: others are refused");
      }
      return;
    }
    neighbour = &neighbours_.add(received.from);
    neighbour->instance = greeting.instance;
    if (options_.budget_bytes_per_s > 0.0) neighbour->budget.emplace(options_.budget_bytes_per_s, at);
  }
  if (!neighbour->meter.on_note(at, *greeting.link)) return;
  neighbour->last_received = at;
  neighbour->number = greeting.number;
  neighbour->is_relay = !greeting.link->path.empty();
  if (table_.set(neighbour->link, wanted_of(greeting.all_regions, greeting.regions))) mark_changed();
  neighbour->wanted_elsewhere = table_.wanted_by_others(neighbour->link);
  greet(*neighbour, /*leaving=*/false);
}

std::vector<std::uint32_t> Relay::path() const {
  std::vector<std::uint32_t> path{instance()};
  if (const RelayChoice::Relay* const parent = parents_.chosen()) {
    path.insert(path.end(), parent->path.begin(), parent->path.end());
  }
  path.resize(std::min(path.size(), net::kRelayPathMax));
  return path;
}

void Relay::greet(Neighbour& neighbour, bool leaving) {
  net::Greeting greeting{.echo = neighbour.number, .leaving = leaving};
  greeting.link = neighbour.meter.note(reading_.clock.now());
  greeting.link->path = path();
  greeting.link->detached = is_detached();
  greeting.all_regions = neighbour.wanted_elsewhere.all;
  greeting.regions = neighbour.wanted_elsewhere.regions;
  send_greeting(neighbour.at, std::move(greeting));
}

void Relay::greet(RelayChoice::Relay& parent, bool leaving) {
  // It may be a child of this relay, too, which hears one thing of it: what a child does.
  Neighbour* const child = neighbours_.find(parent.at);
  if (child != nullptr && !child->is_parent) return greet(*child, leaving);
  net::Greeting greeting{.echo = parent.number, .reply = parent.number == 0, .leaving = leaving};
  if (!greeting.reply) {
    greeting.link = parent.meter.note(reading_.clock.now());
    greeting.link->path = path();
    greeting.link->detached = is_detached();
    if (&parent == parents_.chosen() && !leaving) {
      const Neighbour& link = *neighbours_.find(parent.at);
      greeting.all_regions = link.wanted_elsewhere.all;
      greeting.regions = link.wanted_elsewhere.regions;
    }
  }
  parent.greeted = reading_.clock.now();
  send_greeting(parent.at, std::move(greeting));
}

void Relay::send_greeting(const udp::endpoint& to, net::Greeting greeting) {
  greeting.instance = numbers_.instance();
  greeting.number = numbers_.number_for(to);
  const auto bytes = net::encode(greeting, options_.family == net::IpFamily::kV4);
  push(to, {}, options_.seal ? options_.seal->seal(bytes) : bytes);
  ++traffic_.greetings_out;
}

// ---- changes

void Relay::choose_parent(HostTime now) {
  const RelayChoice::Relay* const before = parents_.chosen();
  if (!parents_.update(now)) return;
  ++traffic_.relay_changes;
  if (before != nullptr) {
    if (Neighbour* const link = neighbours_.find(before->at)) remove(*link);
  }
  RelayChoice::Relay* const parent = parents_.chosen();
  if (parent == nullptr) {
    say_(true, "no relay above this one answers: what is behind it is cut off");
  } else {
    if (Neighbour* const child = neighbours_.find(parent->at)) remove(*child);
    Neighbour& link = neighbours_.add(parent->at);
    link.instance = parent->instance;
    link.is_parent = link.is_relay = true;
    if (options_.budget_bytes_per_s > 0.0) link.budget.emplace(options_.budget_bytes_per_s, now);
    (void)table_.set(link.link, wanted_of(parent->all_regions, parent->regions));
    link.wanted_elsewhere = table_.wanted_by_others(link.link);
    link.repeats = kRepeats;
    say_(false, "is below relay " + net::address_text(parent->at));
  }
  mark_changed();
  for (RelayChoice::Relay& each : parents_.relays()) {
    if (each.number != 0) greet(each, /*leaving=*/false);  // the one before has nothing more to send here
  }
  neighbours_.visit([&](Neighbour& each) {
    if (!each.is_parent) greet(each, /*leaving=*/false);  // the path is another one
  });
}

void Relay::remove(Neighbour& neighbour) {
  if (table_.remove(neighbour.link)) mark_changed();
  neighbours_.remove(neighbour);
}

void Relay::mark_changed() {
  changed_ = true;
  finish_soon();
}

// All that one turn of reading has brought leaves together.
void Relay::finish_soon() {
  if (std::exchange(finishing_, true)) return;
  asio::post(io_, [this, alive = std::weak_ptr(alive_)] {
    if (alive.expired()) return;
    finishing_ = false;
    if (std::exchange(changed_, false)) settle();
    queue_.flush(receiver_.socket().native_handle(), traffic_);
    for (const auto& network : networks_) network->flush();
  });
}

// Somebody wants other regions than before: those who send them have to know.
void Relay::settle() {
  for (std::size_t i = 0; i < networks_.size(); ++i) {
    Wanted wanted = networks_[i]->wanted();
    if (wanted.all) wanted.regions.clear();
    (void)table_.set(static_cast<LinkId>(i), std::move(wanted));
  }
  for (std::size_t i = 0; i < networks_.size(); ++i) {
    networks_[i]->receive(table_.wanted_by_others(static_cast<LinkId>(i)));
  }
  neighbours_.visit([&](Neighbour& each) {
    Wanted wanted_elsewhere = table_.wanted_by_others(each.link);
    if (wanted_elsewhere == each.wanted_elsewhere) return;
    each.wanted_elsewhere = std::move(wanted_elsewhere);
    each.repeats = kRepeats;
    each.is_parent ? greet(*parents_.chosen(), false) : greet(each, false);
  });
}

void Relay::advance() {
  const HostTime now = reading_.clock.now();
  numbers_.advance(now);
  choose_parent(now);
  const Network::Place place{.distance = path().size(), .detached = is_detached()};
  for (const auto& network : networks_) {
    if (const auto said = network->advance(now, place)) say_(false, *said);
  }
  for (RelayChoice::Relay& parent : parents_.relays()) {
    if (parents_.is_greeting_due(parent, now)) greet(parent, /*leaving=*/false);
  }
  neighbours_.visit([&](Neighbour& each) {
    if (each.repeats > 0) {
      --each.repeats;
      each.is_parent ? greet(*parents_.chosen(), false) : greet(each, false);
    }
    if (!each.is_parent && now - each.last_received > kNeighbourSilent) remove(each);
  });
  finish_soon();
  timer_.expires_after(std::chrono::duration_cast<std::chrono::nanoseconds>(kStep));
  timer_.async_wait([this, alive = std::weak_ptr(alive_)](const boost::system::error_code& ec) {
    if (!alive.expired() && !ec) advance();
  });
}

}  // namespace peerd::relay
