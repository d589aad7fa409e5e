#include "peerd/lab/baselines/baseline_run.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <optional>

#include "peerd/lab/baselines/game_client.hpp"
#include "peerd/lab/baselines/lockstep.hpp"
#include "peerd/lab/sim/event_times.hpp"
#include "peerd/lab/sim/network.hpp"
#include "peerd/peer/config/scenario.hpp"

namespace peerd::baselines {
namespace {

using config::BaselineSystem;
using sim::VirtualTime;

constexpr std::size_t kDrivenMax = 600;  // of a player: its input fits a message, with the two before it

// Late datagrams and events still count: for a second, and for as long as a way there, back and there again takes.
double lingers_s(const config::RunSettings& run) {
  double delay_ms = 0.0;
  for (const config::LinkSettings& link : config::links_of(run)) delay_ms = std::max(delay_ms, link.longest_delay_ms());
  return 1.0 + 3e-3 * delay_ms;
}

// The run with the server as a peer of its own, the last one.
config::RunSettings with_server(config::RunSettings run) {
  if (run.baseline.system != BaselineSystem::kServer) return run;
  config::PeerSettings server;
  server.name = "server";
  while (std::ranges::find(run.peers, server.name, &config::PeerSettings::name) != run.peers.end()) server.name += "_";
  for (const config::PeerSettings& peer : run.peers) server.id = std::max(server.id, peer.id);
  ++server.id;
  run.peers.push_back(server);
  return run;
}

std::optional<InputError> why_not(const config::RunSettings& run, const std::vector<config::PeerObjects>& objects,
                                  const sim::Captures* captures) {
  const auto no = [](const std::string& what) {
    return InputError{"error: baseline.system: " + what + ", and only peers of this project do that"};
  };
  if (captures != nullptr) return no("--capture records peers");
  for (const config::ScenarioEvent& event : run.events) {
    if (event.kind == config::EventKind::kEdit) return no("event." + event.name + " edits the scene");
    if (config::peers_change({event})) return no("event." + event.name + " is about peers that join or leave");
  }
  for (std::size_t i = 0; i < run.peers.size(); ++i) {
    if (objects[i].motions.size() > kDrivenMax)
      return InputError{"error: baseline.system: an input is of " + std::to_string(kDrivenMax) +
                        " driven objects at most, and " + run.peers[i].name + " drives " +
                        std::to_string(objects[i].motions.size())};
    if (!objects[i].outside.empty()) return no("a program outside moves objects of " + run.peers[i].name);
  }
  return std::nullopt;
}

std::map<ObjectId, std::size_t> owners_of(const std::vector<config::PeerObjects>& objects) {
  std::map<ObjectId, std::size_t> owners;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    for (const ObjectId object : objects[i].owned) owners.emplace(object, i);
  }
  return owners;
}

class BaselineRun {
 public:
  BaselineRun(const config::RunSettings& run, const SharedWorld& shared, std::vector<config::PeerObjects> objects,
              LogRows& rows)
      : run_(run),
        objects_(std::move(objects)),
        setup_{run_, shared, objects_, rows, owners_of(objects_)},
        network_(run),
        events_(run.events) {
    std::unique_ptr<Game> game = make_game();
    start_ = game->start();
    if (run.baseline.system == BaselineSystem::kServer) {
      auto server = std::make_unique<GameServer>(setup_, std::move(game));
      for (std::size_t i = 0; i + 1 < run.peers.size(); ++i) {
        participants_.push_back(std::make_unique<GameClient>(setup_, i, *server));
      }
      participants_.push_back(std::move(server));
    } else {
      for (std::size_t i = 0; i < run.peers.size(); ++i) {
        participants_.push_back(std::make_unique<LockstepPlayer>(setup_, i, i == 0 ? std::move(game) : make_game()));
      }
    }
    for (std::size_t i = 0; i < participants_.size(); ++i) {
      for (const RegionId region : participants_[i]->regions()) network_.join(i, region);
    }
    events_.begin(VirtualTime{start_.time_since_epoch()});
  }

  // Runs to the end, or until `progress` says no. Deliveries precede a tick of the same time, and samples follow it.
  void go_on(const sim::Progress& progress) {
    const SimTime end = start_ + from_seconds(run_.duration_s + lingers_s(run_));
    std::int64_t tick = 0, sample = 0;
    SimTime now = start_;
    while (now <= end && (!progress || progress(to_seconds(now - start_)))) {
      const SimTime tick_at = start_ + time_of(tick, run_.replication.tick_hz);
      const SimTime sample_at = start_ + time_of(sample, run_.sample_hz);
      SimTime due = std::min(tick_at, sample_at);
      if (const auto event = events_.next(); event && SimTime{event->time_since_epoch()} <= due) {
        happen(events_.take());
        continue;
      }
      if (!network_.idle() && SimTime{network_.next_delivery().time_since_epoch()} <= due) {
        const sim::Delivery delivery = network_.take_next();
        now = SimTime{delivery.at.time_since_epoch()};
        participants_[delivery.to]->on_packet(now, *delivery.datagram);
        continue;
      }
      now = due;
      if (tick_at <= sample_at) {
        for (std::size_t i = 0; i < participants_.size(); ++i) {
          participants_[i]->on_tick(now, tick);
          for (replication::Send& sent : participants_[i]->take_sent()) {
            network_.send(VirtualTime{now.time_since_epoch()}, i, sent.region, std::move(sent.datagram));
          }
        }
        ++tick;
      } else {
        for (const auto& each : participants_) each->record(now);
        ++sample;
      }
    }
  }

  [[nodiscard]] std::vector<PeerLog> logs() const {
    std::vector<PeerLog> logs;
    for (const auto& each : participants_) logs.push_back(each->log());
    return logs;
  }

 private:
  static Duration time_of(std::int64_t number, std::int64_t hz) {
    return std::chrono::seconds(number / hz) + Duration{number % hz * 1'000'000'000 / hz};
  }
  [[nodiscard]] std::unique_ptr<Game> make_game() const {
    return std::make_unique<Game>(run_, setup_.shared, objects_);
  }

  void happen(const config::ScenarioEvent& event) {
    const auto is = [&](const std::string& name, std::size_t i) { return name.empty() || run_.peers[i].name == name; };
    if (event.kind == config::EventKind::kPartition) {
      std::vector<std::uint32_t> sides = event.sides;
      sides.resize(participants_.size());  // the server is on the first side
      network_.part(std::move(sides));
    }
    if (event.kind == config::EventKind::kHeal) network_.part({});
    if (event.kind != config::EventKind::kNetwork) return;
    for (std::size_t from = 0; from < participants_.size(); ++from) {
      for (std::size_t to = 0; to < participants_.size(); ++to) {
        if (is(event.from, from) && is(event.to, to)) network_.change(from, to, event.change);
      }
    }
  }

  const config::RunSettings& run_;
  const std::vector<config::PeerObjects> objects_;
  const Setup setup_;
  sim::Network network_;
  sim::EventTimes events_;
  SimTime start_;
  std::vector<std::unique_ptr<Participant>> participants_;
};

}  // namespace

Result<measure::RunRecord> run_of_any_system(const config::RunSettings& run, const SharedWorld& shared,
                                             const sim::Observer& observer, const sim::ActionObserver& action_observer,
                                             const sim::Captures* captures, Measuring measuring,
                                             const sim::Progress& progress) {
  if (run.baseline.system == BaselineSystem::kNone) {
    return sim::simulated_run(run, shared, observer, action_observer, captures, std::move(measuring), progress);
  }
  const config::RunSettings all = with_server(run);
  auto objects = config::resolve(all, shared.world.scene);
  if (!objects) return std::unexpected(objects.error());
  if (auto error = why_not(all, *objects, captures)) return std::unexpected(*error);
  auto assembler = RunAssembler::make(all, shared, std::move(measuring));
  if (!assembler) return std::unexpected(assembler.error());
  BaselineRun baseline(all, shared, *std::move(objects), **assembler);
  sim::Stop stop(progress, run.duration_s);
  baseline.go_on(std::ref(stop));
  return sim::record_of(**assembler, baseline.logs(), stop, run, shared, progress);
}

}  // namespace peerd::baselines
