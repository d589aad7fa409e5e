#include "tests/sim/clock_lab.hpp"

#include <algorithm>
#include <sstream>

#include "replication/wire/codec.hpp"

#include "core/scene/reader.hpp"

namespace peerd::sim::testing_support {
namespace {

// All clocks count from about here, so that none becomes negative.
constexpr Duration kEpoch = std::chrono::seconds(10'000'000);
constexpr std::size_t kFindingsMax = 8;
constexpr Duration kHelloPeriod = std::chrono::milliseconds(250);

std::string name_of(std::size_t i) { return "p" + std::to_string(i + 1); }

}  // namespace

ClockLab::ClockLab(const config::LinkSettings& links, std::vector<HostSettings> hosts, std::uint64_t seed) {
  run_.seed = seed;
  run_.network = links;
  longest_delay_ = from_seconds((links.latency_ms + links.jitter_ms) * (links.reordering > 0.0 ? 2e-3 : 1e-3));
  for (std::size_t i = 0; i < hosts.size(); ++i) {
    config::PeerSettings& peer = run_.peers.emplace_back();
    peer.name = name_of(i);
    peer.id = static_cast<std::uint32_t>(i + 1);
  }
  scene_ = std::make_unique<Scene>(read_world("#VRML V2.0 utf8\n").scene.value());
  model_ = replication::make_world_model(*scene_);
  for (const HostSettings& settings : hosts) static_cast<HostSettings&>(hosts_.emplace_back()) = settings;
}

void ClockLab::set_link(std::size_t from, std::size_t to, const config::LinkSettings& link) {
  run_.links[{name_of(from), name_of(to)}] = link;
  longest_delay_ = std::max(longest_delay_, from_seconds((link.latency_ms + link.jitter_ms) * 1e-3));
}

// The clock drifts from the beginning on: its reading is a function of true time and of its jumps.
HostTime ClockLab::host_at(std::size_t i, Duration t) const {
  const Host& h = hosts_[i];
  const Duration runs = h.clock_runs ? t : std::min(t, h.stopped_at);
  return HostTime{kEpoch + h.ahead + runs + runs * h.drift_ppm / 1'000'000};
}

// The first instant at which the clock shows at least that.
Duration ClockLab::true_time(std::size_t i, HostTime host) const {
  const Duration elapsed = host.time_since_epoch() - kEpoch - hosts_[i].ahead;
  Duration t = elapsed - elapsed * hosts_[i].drift_ppm / 1'000'000;
  while (host_at(i, t) >= host) t -= Duration{std::max<std::int64_t>(1, (host_at(i, t) - host).count())};
  while (host_at(i, t) < host) t += Duration{std::max<std::int64_t>(1, (host - host_at(i, t)).count() / 2)};
  return t;
}

Duration ClockLab::deadline(std::size_t i) const {
  const HostTime host = hosts_[i].peer->next_deadline();
  return host == HostTime::min() ? now_ : std::max(now_, true_time(i, host));
}

void ClockLab::start(std::size_t i) {
  replication::PeerConfig c;
  c.id = PeerId{run_.peers[i].id};
  c.name = run_.peers[i].name;
  c.incarnation = ++hosts_[i].incarnation;
  hosts_[i].peer = std::make_unique<replication::Peer>(std::move(c), *model_);
  hosts_[i].runs = true;
  hosts_[i].last_reading.reset();
  drain(i);
}

void ClockLab::leave(std::size_t i) {
  hosts_[i].peer->leave(host_now(i));
  drain(i);
  hosts_[i].runs = false;
}

void ClockLab::suspend(std::size_t i, bool clock_runs) {
  hosts_[i].runs = false;
  hosts_[i].clock_runs = clock_runs;
  hosts_[i].stopped_at = now_;
}

void ClockLab::wake(std::size_t i) {
  Host& h = hosts_[i];
  h.runs = true;
  if (!std::exchange(h.clock_runs, true)) {
    const Duration lost = now_ - h.stopped_at;
    h.ahead -= lost + lost * h.drift_ppm / 1'000'000;
  }
}

void ClockLab::set_os_clock(std::size_t i, Duration error, std::optional<Duration> bound) {
  hosts_[i].os_error = error;
  hosts_[i].os_bound = bound;
}

bool ClockLab::apart(std::size_t a, std::size_t b) const {
  const auto in = [&](std::size_t i) { return std::ranges::find(apart_, i) != apart_.end(); };
  return in(a) != in(b);
}

void ClockLab::drain(std::size_t i) {
  while (auto out = hosts_[i].peer->poll_output()) {
    if (auto* send = std::get_if<replication::Send>(&*out)) {
      network_->send(VirtualTime{now_}, i, send->region, std::move(send->datagram));
    } else if (const auto* join = std::get_if<replication::Join>(&*out)) {
      network_->join(i, join->region);
    } else if (std::holds_alternative<replication::ClockStepped>(*out)) {
      ++hosts_[i].steps;
      // Its followers learn of that from its next hello.
      hosts_[i].excused_until = std::max(hosts_[i].excused_until, now_ + longest_delay_ + 2 * kHelloPeriod);
    }
  }
}

void ClockLab::look(std::size_t i) {
  Host& h = hosts_[i];
  const auto& clock = h.peer->clock();
  const auto find = [&](const auto&... words) {
    if (findings_.size() == kFindingsMax) return;
    std::ostringstream text;
    text << to_seconds(now_) << " s, " << name_of(i) << ": ";
    (text << ... << words);
    findings_.push_back(text.str());
  };
  if (!clock.synchronised() && !h.last_reading) return;
  const SimTime reading = session_now(i);
  if (h.last_reading && reading < *h.last_reading) {
    find("session time ran back by ", to_seconds(*h.last_reading - reading) * 1e6, " us");
  }
  h.last_reading = reading;
  const auto follows = h.peer->follows();
  if (follows != h.follows) h.follows_since = now_;
  h.follows = follows;
  if (!clock.synchronised() || !follows || follows == h.peer->id()) return;
  const std::size_t followed = follows->value - 1;
  if (!hosts_[followed].peer->clock().synchronised()) return;
  const Duration error = reading - session_now(followed);
  const Duration bound = *clock.error_bound(host_now(i));
  const bool excused = now_ <= h.excused_until || now_ <= hosts_[followed].excused_until;
  excused_ += excused;
  if (!excused && std::chrono::abs(error) > bound) {
    find("error ", to_seconds(error) * 1e3, " ms against p", followed + 1, ", bound ", to_seconds(bound) * 1e3, " ms");
  }
  samples_.push_back({now_, i, error, bound, now_ - std::max(h.follows_since, hosts_[followed].follows_since)});
}

void ClockLab::run_until(Duration until) {
  if (!network_) {
    network_ = std::make_unique<Network>(run_);
    for (std::size_t i = 0; i < hosts_.size(); ++i) start(i);
  }
  for (;;) {
    std::size_t next = hosts_.size();
    for (std::size_t i = 0; i < hosts_.size(); ++i) {
      if (hosts_[i].runs && (next == hosts_.size() || deadline(i) < deadline(next))) next = i;
    }
    const Duration tick_at = next == hosts_.size() ? Duration::max() : deadline(next);
    if (!network_->idle() && network_->next_delivery().time_since_epoch() <= std::min(tick_at, until)) {
      const Delivery d = network_->take_next();
      now_ = d.at.time_since_epoch();
      const auto message = replication::decode(*d.datagram, SimTime{kEpoch});
      if (!hosts_[d.to].runs || !message || apart(message->sender.value - 1, d.to)) continue;
      (void)hosts_[d.to].peer->on_packet(host_now(d.to), d.region, *d.datagram);
      drain(d.to);
      look(d.to);
      continue;
    }
    if (tick_at > until) break;
    now_ = tick_at;
    Host& h = hosts_[next];
    if (h.os_bound) {
      const Duration os_minus_host = kEpoch + now_ + h.os_error - host_now(next).time_since_epoch();
      h.peer->on_os_clock(host_now(next), replication::OsClock{os_minus_host, *h.os_bound});
    } else {
      h.peer->on_os_clock(host_now(next), std::nullopt);
    }
    h.peer->on_tick(host_now(next), {});
    drain(next);
    look(next);
  }
  now_ = until;
}

}  // namespace peerd::sim::testing_support
