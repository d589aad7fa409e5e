#include "wire_traffic.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <stdexcept>

#include "replication/peer/peer.hpp"
#include "simulated_run.hpp"
#include "temporary_folder.hpp"
#include "wire_objects.hpp"

namespace peerd::bench {
namespace {

using namespace replication;
using namespace std::chrono_literals;

constexpr double kEntityState_bytes = 144.0 + kUdpHeader_bytes;  // IEEE 1278.1, without articulations
constexpr double kAtMostOfDis = 1.0 / 8.0, kAtMostOfInterest = 1.3;

Outcome sound(const SimulatedRun& run) {
  Outcome outcome = simulate(run);
  if (!outcome.wrong.empty()) throw std::runtime_error(run.scenario + ": " + outcome.wrong);
  return outcome;
}

Figure figure(const std::string& name, double value) { return {name, value, "x", "", std::nullopt, value, value}; }
Figure figure(const std::string& name, double value, double at_most, const char* sentence) {
  return {name, value, "x", sentence, value / at_most, value, value};
}

std::string at(double latency_ms) { return "." + std::to_string(static_cast<int>(latency_ms)) + "ms"; }
std::string growth(std::size_t objects, const std::string& what) {
  return "growth." + std::to_string(objects) + '.' + what;
}

// The worst of them comes first.
std::vector<Figure> with_worst(std::vector<Figure> each, const std::string& name) {
  Figure worst = *std::ranges::max_element(each, {}, &Figure::value);
  worst.name = name;
  each.insert(each.begin(), worst);
  return each;
}

double over_dis(Tradeoff ours, const Outcome& dis, double Outcome::*bytes, const std::string& what) {
  const auto needed = bytes_for(ours, dis.ghost_error_m, bytes);
  if (!needed) throw std::runtime_error(what + ": never as accurate as DIS");
  return *needed / (kEntityState_bytes * dis.updates_per_s);
}

struct OverDis {
  double all = 0.0, updates = 0.0;
};
OverDis bytes_over_dis(const std::string& scenario, double latency_ms, const Options& options) {
  const double duration_s = options.quick ? 3.0 : 12.0;
  const auto run = [&](const char* config, std::vector<std::string> sets) {
    if (scenario == "traffic") sets.push_back("decisions.policy=expected-error");
    return sound({scenario, config, latency_ms, duration_s, std::move(sets)});
  };
  const Outcome dis = run("baselines/dis", dead_reckoning_at(1.0));
  std::vector<Outcome> ours;
  for (const double m : thresholds_m(options.quick)) ours.push_back(run("best", best_at(m)));
  return {over_dis(ours, dis, &Outcome::bytes_with_udp_per_s, scenario),
          over_dis(ours, dis, &Outcome::update_bytes_per_s, scenario)};
}

struct OverInterest {
  double all = 0.0, worst = 0.0;  // of all peers together; of one
};
OverInterest received_over_interest(const SimulatedRun& run) {
  const auto summary = summary_of(run);
  const auto& interest = summary.at("interest");
  if (interest.at("missing_samples") != 0) throw std::runtime_error("flock-regions: an object is missing");
  OverInterest over{interest.at("received_over_interest").get<double>()};
  for (const auto& peer : interest.at("peers")) {
    over.worst = std::max(over.worst, peer.at("received_over_interest").get<double>());
  }
  return over;
}

// A peer that publishes its objects, an eleventh of a world's, to another one 100 ms away.
class TwoPeers {
 public:
  TwoPeers(std::size_t own, const PublishPolicy& policy)
      : own_(own),
        crowd_(kShare * own),
        publisher_(config_of(1, crowd_.object(0), own, policy), *crowd_.model),
        receiver_(config_of(2, crowd_.object(0), 0, policy), *crowd_.model) {
    std::mt19937_64 rng(own);
    for (std::size_t i = 0; i < own; ++i) paths_.emplace_back(rng);
  }

  Outcome run(Duration warm, Duration measured) {
    play(warm);
    const auto before = counted();
    error_sum_m_ = 0.0;
    samples_ = 0;
    play(warm + measured);
    const auto after = counted();
    const double s = to_seconds(measured);
    Outcome outcome;
    outcome.bytes_per_s = static_cast<double>(after.bytes - before.bytes) / s;
    outcome.bytes_with_udp_per_s =
        outcome.bytes_per_s + kUdpHeader_bytes * static_cast<double>(after.datagrams - before.datagrams) / s;
    outcome.updates_per_s = static_cast<double>(after.updates - before.updates) / s;
    outcome.ghost_error_m = error_sum_m_ / static_cast<double>(samples_);
    if (samples_ == 0 || !std::isfinite(error_sum_m_)) outcome.wrong = "nobody saw anything";
    return outcome;
  }

  static constexpr std::size_t kShare = 11;

 private:
  struct Counted {
    std::uint64_t bytes = 0, datagrams = 0, updates = 0;
  };
  struct Flight {
    HostTime at;
    bool to_listener;
    Bytes datagram;
  };

  [[nodiscard]] Counted counted() const {
    Counted all;
    for (const Peer* peer : {&publisher_, &receiver_}) {
      all.bytes += peer->counters().bytes_out;
      all.datagrams += peer->counters().datagrams_out;
      all.updates += peer->counters().updates_out;
    }
    return all;
  }
  void play(Duration until) {
    const HostTime end{until};
    while (now_ < end) {
      now_ = std::min({end, std::max(now_, publisher_.next_deadline()), std::max(now_, receiver_.next_deadline()),
                       flights_.empty() ? end : std::max(now_, flights_.front().at)});
      for (; !flights_.empty() && flights_.front().at <= now_; flights_.pop_front()) {
        Peer& to = flights_.front().to_listener ? receiver_ : publisher_;
        (void)to.on_packet(now_, kWholeScene, flights_.front().datagram);
        drain(to);
      }
      if (publisher_.next_deadline() <= now_) {
        publisher_.on_tick(now_, samples());
        drain(publisher_);
      }
      if (receiver_.next_deadline() <= now_) {
        const bool looks = receiver_.due_tick(now_) && receiver_.counters().ticks % kTicksPerLook == 0;
        receiver_.on_tick(now_, {});
        drain(receiver_);
        if (looks) look();
      }
    }
  }
  [[nodiscard]] std::vector<OwnSample> samples() const {
    std::vector<OwnSample> all;
    if (const auto due = publisher_.due_tick(now_)) {
      for (std::size_t i = 0; i < own_; ++i) all.push_back({crowd_.object(i), paths_[i].at(*due), true});
    }
    return all;
  }
  void look() {
    const SimTime t = receiver_.clock().to_session(now_);
    for (std::size_t i = 0; i < own_; ++i) {
      if (receiver_.owner(crowd_.object(i)) != publisher_.id()) continue;
      error_sum_m_ += (receiver_.ghost(crowd_.object(i), t).position - paths_[i].at(t).position).norm();
      ++samples_;
    }
  }
  void drain(Peer& peer) {
    while (auto out = peer.poll_output()) {
      if (auto* send = std::get_if<Send>(&*out)) {
        flights_.push_back({now_ + 100ms, &peer == &publisher_, std::move(send->datagram)});
      }
    }
  }

  static constexpr std::uint64_t kTicksPerLook = 6;
  std::size_t own_;
  Crowd crowd_;
  Peer publisher_, receiver_;
  std::vector<Path> paths_;
  std::deque<Flight> flights_;
  HostTime now_{0s};
  double error_sum_m_ = 0.0;
  std::size_t samples_ = 0;
};

Figure growth_over_dis(std::size_t own, bool quick) {
  const Duration warm = 8s, measured = quick ? Duration{2s} : Duration{6s};
  const auto run = [&](const char* config, const std::vector<std::string>& sets) {
    Outcome outcome = TwoPeers(own, policy_in(config, sets)).run(warm, measured);
    if (!outcome.wrong.empty()) throw std::runtime_error("an eleventh of the objects: " + outcome.wrong);
    return outcome;
  };
  const Outcome dis = run("baselines/dis", dead_reckoning_at(1.0));
  std::vector<Outcome> ours;
  for (const double m : {2.0, 1.0, 0.5, 0.2, 0.05}) {
    ours.push_back(run("best", best_at(m)));
    if (ours.back().ghost_error_m < dis.ghost_error_m) break;
  }
  return figure(growth(TwoPeers::kShare * own, "bytes_over_dis"),
                over_dis(ours, dis, &Outcome::bytes_with_udp_per_s, "an eleventh of the objects"));
}

// Two flocks as dense as those of configs/worlds/flock-regions.wrl, of so many birds in all.
std::string world_of_flocks(std::size_t birds) {
  std::ostringstream world;
  world << "#VRML V2.0 utf8\n";
  std::mt19937_64 rng(birds);
  const double spread_m = 45.0 * std::cbrt(static_cast<double>(birds) / 128.0), spread_up_m = std::min(spread_m, 50.0);
  for (std::size_t i = 0; i < birds; ++i) {
    const std::size_t peer = i % 8;
    const double side_m = peer < 4 ? -150.0 : 150.0;
    world << "DEF BIRD_" << (peer < 4 ? 'N' : 'S') << '_' << static_cast<char>('A' + peer) << '_' << (i < 80 ? "0" : "")
          << i / 8 << " Transform { translation " << draw(rng, side_m - spread_m, side_m + spread_m) << ' '
          << draw(rng, 90.0 - spread_up_m, 90.0 + spread_up_m) << ' ' << draw(rng, side_m - spread_m, side_m + spread_m)
          << " children Shape { geometry Box { size 1.2 0.12 0.5 } } }\n";
  }
  return std::move(world).str();
}

Figure growth_of_flock(std::size_t birds) {
  const TemporaryFolder folder;
  const std::filesystem::path world = folder / "flocks.wrl";
  std::ofstream(world) << world_of_flocks(birds);
  return figure(growth(birds, "flock_received_over_aoi"),
                received_over_interest({"flock-regions", "best", 100.0, 20.0, {"world=" + world.string()}}).worst);
}

}  // namespace

std::vector<Figure> wire_traffic(const Options& options) {
  const std::vector<double> latencies_ms =
      options.quick ? std::vector<double>{100} : std::vector<double>{5, 100, 200, 500};
  std::vector<Figure> dis, dis_updates, flock, flock_all;
  for (const double ms : latencies_ms) {
    for (const char* scenario : {"crowd", "traffic"}) {
      const OverDis over = bytes_over_dis(scenario, ms, options);
      const std::string name = "bytes_over_dis." + std::string(scenario) + at(ms);
      dis.push_back(figure(name, over.all, kAtMostOfDis, "<= 0.125"));
      dis_updates.push_back(figure(name + ".updates", over.updates));
    }
    const OverInterest over = received_over_interest({"flock-regions", "best", ms, options.quick ? 5.0 : 60.0});
    const std::string name = "flock_received_over_aoi" + at(ms);
    flock.push_back(figure(name, over.worst, kAtMostOfInterest, "<= 1.3"));
    flock_all.push_back(figure(name + ".all", over.all));
  }
  std::vector<Figure> all = with_worst(std::move(dis), "bytes_over_dis");
  std::ranges::copy(dis_updates, std::back_inserter(all));
  std::ranges::copy(with_worst(std::move(flock), "flock_received_over_aoi"), std::back_inserter(all));
  std::ranges::copy(flock_all, std::back_inserter(all));
  for (const std::size_t own :
       options.quick ? std::vector<std::size_t>{10} : std::vector<std::size_t>{10, 100, 1000, 10'000}) {
    all.push_back(growth_over_dis(own, options.quick));
  }
  if (!options.quick) {
    for (const std::size_t birds : {128, 256, 512, 1024}) all.push_back(growth_of_flock(birds));
  }
  return all;
}

}  // namespace peerd::bench
