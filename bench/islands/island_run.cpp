#include "island_run.hpp"

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>

#include "peerd/lab/sim/simulation.hpp"
#include "peerd/peer/config/scenario.hpp"

namespace peerd::bench {
namespace {

double cpu_now_s() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double resident_bytes() {
  std::ifstream file("/proc/self/statm");
  double pages = 0.0, resident = 0.0;
  file >> pages >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

// Returns what the process has allocated, touched or not. The allocator's room between the blocks does not count.
double allocated_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

template <class T>
T must(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().text);
  return *std::move(result);
}

// The rows are not kept: they would be most of the memory.
class NoRows final : public LogRows {
 public:
  void enter(const PeerLog&) override {}
  void end(PeerId, HostTime) override {}
  void add(const PeerLog&, const PeerLog::ObjectSample&) override {}
  void add(const PeerLog&, PeerLog::Update) override {}
  void add(const PeerLog&, const PeerLog::Datagram&) override {}
};

// Sees all peers at the beginning and at the end of the measured part.
class Watch final : public sim::PeersWatch {
 public:
  Watch(const IslandWorld& world, IslandCosts& costs)
      : world_(world), resident_before_(resident_bytes()), allocated_before_(allocated_bytes()), costs_(costs) {}

  [[nodiscard]] std::uint32_t rate_hz() const override { return 1; }
  void begin(SimTime, HostTime) override {}
  void see(double t_s, std::span<const sim::SeenPeer> peers) override {
    const double end_s = std::floor(world_.duration_s());
    if (!before_.empty()) note_lost(peers);
    if (before_.empty() && t_s >= end_s - world_.measure_s) return begin_measuring(t_s, peers);
    if (!before_.empty() && t_s >= end_s && costs_.took_s == 0.0) measure(t_s, peers);
  }
  [[nodiscard]] bool has_measured() const { return costs_.took_s > 0.0; }

 private:
  void note_lost(std::span<const sim::SeenPeer> peers) {
    for (std::size_t i = 0; i < peers.size(); ++i) {
      const std::size_t known = peers[i].node->peer().members().count();
      if (known < known_[i]) costs_.lost += known_[i] - known;
      known_[i] = known;
    }
  }

  void begin_measuring(double t_s, std::span<const sim::SeenPeer> peers) {
    from_s_ = t_s;
    cpu_s_ = cpu_now_s();
    for (const sim::SeenPeer& peer : peers) {
      if (peer.node == nullptr) throw std::runtime_error("a peer is not there");
      before_.push_back(peer.node->peer().counters());
      known_.push_back(peer.node->peer().members().count());
    }
  }

  void measure(double t_s, std::span<const sim::SeenPeer> peers) {
    const double s = t_s - from_s_, n = static_cast<double>(peers.size());
    costs_.took_s = s;
    costs_.cpu_s = (cpu_now_s() - cpu_s_) / s / n;
    malloc_trim(0);
    costs_.memory_bytes = (resident_bytes() - resident_before_) / n;
    costs_.allocated_bytes = (allocated_bytes() - allocated_before_) / n;
    std::optional<SimTime> leader;
    for (std::size_t i = 0; i < peers.size(); ++i) {
      const replication::Peer& peer = peers[i].node->peer();
      const auto& c = peer.counters();
      const auto& b = before_[i];
      for (std::size_t kind = 0; kind < c.kinds_in.size(); ++kind) {
        Rate& rate = costs_.in[to_string(static_cast<replication::DatagramKind>(kind))];
        rate.datagrams += static_cast<double>(c.kinds_in[kind].datagrams - b.kinds_in[kind].datagrams) / s / n;
        rate.bytes += static_cast<double>(c.kinds_in[kind].bytes - b.kinds_in[kind].bytes) / s / n;
      }
      const double in = static_cast<double>(c.bytes_in - b.bytes_in) / s;
      costs_.in_all.bytes += in / n;
      costs_.in_all.datagrams += static_cast<double>(c.datagrams_in - b.datagrams_in) / s / n;
      if (in > costs_.in_worst.bytes) costs_.in_worst = {static_cast<double>(c.datagrams_in - b.datagrams_in) / s, in};
      costs_.out_all.bytes += static_cast<double>(c.bytes_out - b.bytes_out) / s / n;
      costs_.out_all.datagrams += static_cast<double>(c.datagrams_out - b.datagrams_out) / s / n;
      costs_.members += static_cast<double>(peer.members().count()) / n;
      costs_.near_members += static_cast<double>(peer.members().all().size()) / n;
      costs_.regions += static_cast<double>(peer.interest().regions().size()) / n;
      costs_.decisions += static_cast<double>(c.decisions - b.decisions) / s / n;
      for (const auto& [object, owner] : peer.owners()) {
        if (owner != peer.id() && peer.receives(object)) costs_.received_objects += 1.0 / n;
      }
      check(peer, peers.size());
      const SimTime now = peer.clock().to_session(peers[i].host);
      if (!leader) leader = now;
      costs_.clock_error_ms = std::max(costs_.clock_error_ms, std::abs(to_seconds(now - *leader)) * 1e3);
    }
    if (costs_.lost > 0 && costs_.wrong.empty()) costs_.wrong = std::to_string(costs_.lost) + " peers were lost";
  }

  // A peer has session time, and has heard of all others but those few whose hello the network has lost. Nobody edits:
  // an operation would say where the objects of a peer stand that somebody has taken for gone.
  void check(const replication::Peer& peer, std::size_t all) {
    const std::size_t others = all - 1, known = peer.members().count();
    const std::string name = "peer " + std::to_string(peer.id().value);
    if (known + others / 50 < others) costs_.wrong = name + " knows " + std::to_string(known) + " others";
    if (!peer.clock().synchronised()) costs_.wrong = name + " has no session time";
    if (!peer.logs().lengths().empty())
      costs_.wrong = name + " has " + std::to_string(peer.logs().lengths().size()) + " logs";
    if (known > others) costs_.wrong = name + " knows others who are not there";
  }

  const IslandWorld& world_;
  double resident_before_, allocated_before_;
  IslandCosts& costs_;
  double from_s_ = 0.0, cpu_s_ = 0.0;
  std::vector<replication::Peer::Counters> before_;
  std::vector<std::size_t> known_;
};

}  // namespace

IslandCosts run_islands(const IslandWorld& world) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / ("peerd-islands-" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "w.wrl") << world_text(world);
  config::ScenarioRequest request;
  request.file = folder / "s.toml";
  request.text = scenario_text(world, "w.wrl");
  request.sets = world.sets;
  config::Scenario scenario = must(config::read_scenario(request));
  const auto shared = must(share_world(scenario.world, scenario.reading, scenario.runs));
  std::filesystem::remove_all(folder);
  IslandCosts costs;
  costs.peers = world.peers;
  costs.objects = world.peers * world.objects;
  malloc_trim(0);
  NoRows rows;
  Watch watch(world, costs);
  // Nobody lingers behind the end of what is measured.
  const sim::Progress progress = [&](std::optional<double>) { return !watch.has_measured(); };
  const auto logs =
      must(sim::simulate(scenario.runs.front(), *shared, {}, {}, nullptr, nullptr, &rows, progress, &watch));
  if (!watch.has_measured()) costs.wrong = "the run has ended before it was measured";
  return costs;
}

}  // namespace peerd::bench
