#include "loopback.hpp"

#include <cstdio>
#include <exception>
#include <optional>
#include <utility>

#include "ping_pong.hpp"

namespace peerd::bench {
namespace {

// Percentiles of one contestant, round by round.
struct Rounds {
  std::vector<double> p50_us, p99_us;
  void add(const std::vector<double>& samples_us) {
    p50_us.push_back(percentile(samples_us, 0.5));
    p99_us.push_back(percentile(samples_us, 0.99));
  }
};

std::vector<double> ratios(const std::vector<double>& of, const std::vector<double>& to) {
  std::vector<double> each;
  for (std::size_t i = 0; i < of.size(); ++i) each.push_back(of[i] / to[i]);
  return each;
}

void add(LoopbackResult& result, const std::string& name, const std::vector<double>& samples, const char* unit,
         const char* target = "", std::optional<double> target_value = {}) {
  const Quartiles q = quartiles(samples);
  const auto ratio = target_value ? std::optional(q.median / *target_value) : std::nullopt;
  result.figures.push_back({name, q.median, unit, target, ratio, q.low, q.high});
}

// All at one pace; `suffix` goes with the names of the figures.
void measure(LoopbackResult& result, Pace pace, const std::string& suffix, bool quick) {
  const std::size_t rounds = quick ? 1 : 11;
  const std::size_t pings = quick ? 100 : pace == Pace::kPingPong ? 10'000 : 2'000;
  const bool with_dds = has_ddsperf();
  Rounds udp, peers, open, one_way, dds, udp_polling, peers_polling, one_way_polling;
  for (std::size_t round = 0; round < rounds; ++round) {
    udp.add(udp_round({pings, Waits::kAsleep, pace}).half_round_trip_us);
    const Latencies by_peers = peers_round({pings, Waits::kAsleep, pace});
    peers.add(by_peers.half_round_trip_us);
    one_way.add(by_peers.one_way_us);
    open.add(peers_round({.pings = pings, .waits = Waits::kAsleep, .pace = pace, .sealed = false}).half_round_trip_us);
    udp_polling.add(udp_round({pings, Waits::kBusyPolling, pace}).half_round_trip_us);
    const Latencies by_polling = peers_round({pings, Waits::kBusyPolling, pace});
    peers_polling.add(by_polling.half_round_trip_us);
    one_way_polling.add(by_polling.one_way_us);
    if (!with_dds) continue;
    const DdsRound by_dds = dds_round(2, pace);
    dds.p50_us.push_back(by_dds.p50_us);
    dds.p99_us.push_back(by_dds.p99_us);
  }
  const auto all = [&](const std::string& name, const Rounds& of) {
    add(result, "loopback_p50_us." + name + suffix, of.p50_us, "us");
    add(result, "loopback_p99_us." + name + suffix, of.p99_us, "us");
  };
  const auto over = [&](const std::string& name, const Rounds& of, const Rounds& to, const char* target = "",
                        std::optional<double> target_value = {}) {
    add(result, "loopback_p50_over_" + name + suffix, ratios(of.p50_us, to.p50_us), "x", target, target_value);
    add(result, "loopback_p99_over_" + name + suffix, ratios(of.p99_us, to.p99_us), "x");
  };
  all("udp", udp);
  all("peers", peers);
  all("open_peers", open);
  all("peers.one_way", one_way);
  all("udp_busy_polling", udp_polling);
  all("peers_busy_polling", peers_polling);
  all("peers_busy_polling.one_way", one_way_polling);
  over("udp", peers, udp, "<= 1.5", 1.5);
  over("open_peers", peers, open, "<= 1.1", 1.1);
  over("udp_busy_polling", peers_polling, udp, "<= 1.5", 1.5);
  over("udp_both_busy_polling", peers_polling, udp_polling);
  if (!with_dds) return;
  all("cyclone", dds);
  over("cyclone", peers, dds, "< 1", 1.0);
  over("cyclone_busy_polling", peers_polling, dds, "< 1", 1.0);
}

// Both on one core, asleep when nothing is to be done: nobody has to be woken elsewhere, and the work is all there is.
void measure_on_one_core(LoopbackResult& result, Pace pace, const std::string& suffix, bool quick) {
  Rounds udp, peers;
  for (std::size_t round = 0; round < (quick ? 1 : 5); ++round) {
    const Round each{quick ? 100U : 2'000U, Waits::kAsleep, pace, one_core()};
    udp.add(udp_round(each).half_round_trip_us);
    peers.add(peers_round(each).half_round_trip_us);
  }
  add(result, "loopback_p50_us.udp.one_core" + suffix, udp.p50_us, "us");
  add(result, "loopback_p50_us.peers.one_core" + suffix, peers.p50_us, "us");
  add(result, "loopback_p50_over_udp.one_core" + suffix, ratios(peers.p50_us, udp.p50_us), "x");
}

}  // namespace

LoopbackResult measure_loopback(bool quick) {
  LoopbackResult result;
  if (!has_ddsperf()) std::printf("no figures of Cyclone DDS: ddsperf (cyclonedds-tools) is not installed\n");
  if (const Cores cores = two_cores(); cores.ping == cores.pong)
    std::printf("both processes share the only core that there is\n");
  try {
    for (const auto& [pace, suffix] : {std::pair{Pace::kPingPong, ""}, {Pace::kEveryMillisecond, ".1khz"}}) {
      measure(result, pace, suffix, quick);
      measure_on_one_core(result, pace, suffix, quick);
    }
  } catch (const std::exception& error) {
    result.wrong.push_back(std::string("loopback: ") + error.what());
  }
  return result;
}

LoopbackResult measure_loopback_growth(bool quick) {
  const std::size_t rounds = quick ? 1 : 5, pings = quick ? 50 : 1'000;
  LoopbackResult result;
  for (const std::size_t objects :
       quick ? std::vector<std::size_t>{100, 400} : std::vector<std::size_t>{100, 1'000, 10'000, 100'000}) {
    const std::string name = "growth." + std::to_string(objects) + ".loopback_";
    Rounds udp, peers;
    try {
      for (std::size_t round = 0; round < rounds; ++round) {
        const Round each{pings, Waits::kAsleep, Pace::kEveryMillisecond};
        udp.add(udp_round(each).half_round_trip_us);
        peers.add(peers_round(each, objects).half_round_trip_us);
      }
    } catch (const std::exception& error) {
      result.wrong.push_back("loopback with " + std::to_string(objects) + " objects: " + error.what());
      return result;
    }
    add(result, name + "p50_over_udp.1khz", ratios(peers.p50_us, udp.p50_us), "x");
    add(result, name + "p99_over_udp.1khz", ratios(peers.p99_us, udp.p99_us), "x");
  }
  return result;
}

}  // namespace peerd::bench
