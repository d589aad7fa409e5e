#include "loopback.hpp"

#include <cstdio>
#include <exception>

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

}  // namespace

LoopbackResult measure_loopback(bool quick) {
  const std::size_t rounds = quick ? 1 : 15, pings = quick ? 100 : 2'000;
  const bool with_dds = has_ddsperf();
  LoopbackResult result;
  Rounds udp, peers, one_way, dds, udp_polling, peers_polling, one_way_polling;
  try {
    for (std::size_t round = 0; round < rounds; ++round) {
      udp.add(udp_round(pings, Waits::kAsleep).half_round_trip_us);
      const Latencies by_peers = peers_round(pings, Waits::kAsleep);
      peers.add(by_peers.half_round_trip_us);
      one_way.add(by_peers.one_way_us);
      udp_polling.add(udp_round(pings, Waits::kBusyPolling).half_round_trip_us);
      const Latencies by_polling = peers_round(pings, Waits::kBusyPolling);
      peers_polling.add(by_polling.half_round_trip_us);
      one_way_polling.add(by_polling.one_way_us);
      if (!with_dds) continue;
      const DdsRound by_dds = dds_round(2);
      dds.p50_us.push_back(by_dds.p50_us);
      dds.p99_us.push_back(by_dds.p99_us);
    }
  } catch (const std::exception& error) {
    result.wrong.push_back(std::string("loopback: ") + error.what());
    return result;
  }
  const auto all = [&](const std::string& name, const Rounds& of) {
    add(result, "loopback_p50_us." + name, of.p50_us, "us");
    add(result, "loopback_p99_us." + name, of.p99_us, "us");
  };
  all("udp", udp);
  all("peers", peers);
  all("peers.one_way", one_way);
  all("udp_busy_polling", udp_polling);
  all("peers_busy_polling", peers_polling);
  all("peers_busy_polling.one_way", one_way_polling);
  add(result, "loopback_p50_over_udp", ratios(peers.p50_us, udp.p50_us), "x", "<= 1.5", 1.5);
  add(result, "loopback_p99_over_udp", ratios(peers.p99_us, udp.p99_us), "x");
  add(result, "loopback_p50_over_udp_busy_polling", ratios(peers_polling.p50_us, udp.p50_us), "x", "<= 1.5", 1.5);
  add(result, "loopback_p99_over_udp_busy_polling", ratios(peers_polling.p99_us, udp.p99_us), "x");
  add(result, "loopback_p50_over_udp_both_busy_polling", ratios(peers_polling.p50_us, udp_polling.p50_us), "x");
  if (with_dds) {
    all("cyclone", dds);
    add(result, "loopback_p50_over_cyclone", ratios(peers.p50_us, dds.p50_us), "x", "< 1", 1.0);
    add(result, "loopback_p99_over_cyclone", ratios(peers.p99_us, dds.p99_us), "x");
    add(result, "loopback_p50_over_cyclone_busy_polling", ratios(peers_polling.p50_us, dds.p50_us), "x", "< 1", 1.0);
    add(result, "loopback_p99_over_cyclone_busy_polling", ratios(peers_polling.p99_us, dds.p99_us), "x");
  } else {
    std::printf("no figures of Cyclone DDS: ddsperf (cyclonedds-tools) is not installed\n");
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
        udp.add(udp_round(pings, Waits::kAsleep).half_round_trip_us);
        peers.add(peers_round(pings, Waits::kAsleep, objects).half_round_trip_us);
      }
    } catch (const std::exception& error) {
      result.wrong.push_back("loopback with " + std::to_string(objects) + " objects: " + error.what());
      return result;
    }
    add(result, name + "p50_over_udp", ratios(peers.p50_us, udp.p50_us), "x");
    add(result, name + "p99_over_udp", ratios(peers.p99_us, udp.p99_us), "x");
  }
  return result;
}

}  // namespace peerd::bench
