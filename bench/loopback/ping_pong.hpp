#pragma once
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace peerd::bench {

using Clock = std::chrono::steady_clock;  // CLOCK_MONOTONIC: the same in all processes

inline constexpr std::chrono::seconds kPongWithin{5};  // else something was lost, which on loopback nothing should be
inline constexpr std::size_t kPingsMax = 20'000;

// Written by both processes, each its own row, read when both are done.
struct Stamps {
  std::size_t pings = 0;
  std::array<Clock::time_point, kPingsMax> published{}, heard{}, answered{};  // by ping; heard: by the other process
};

struct Latencies {
  std::vector<double> half_round_trip_us, one_way_us;
};

// The cores that two processes run on decide more than what they do: on one core a bare datagram takes 4 us, on two, of
// which one is to be woken, 30 us. So the choice of cores is not left to the kernel.
struct Cores {
  int ping, pong;
};
[[nodiscard]] Cores two_cores();  // as on two computers; the same core where this process may run on one only
[[nodiscard]] Cores one_core();

// Runs `pong` in a child process and `ping` in this one. Throws what either throws.
[[nodiscard]] Latencies ping_pong(std::size_t pings, Cores cores, const std::function<void(Stamps&)>& ping,
                                  const std::function<void(Stamps&)>& pong);

// The share-th part of them is less.
[[nodiscard]] double percentile(std::vector<double> samples, double share);

// How a process waits for the other's: as usual, or without ever sleeping, the processor offered to others meanwhile.
enum class Waits : std::uint8_t { kAsleep, kBusyPolling };

// When a ping leaves: when the pong before it has come, or a millisecond after the ping before it, for most of which
// both have slept.
enum class Pace : std::uint8_t { kPingPong, kEveryMillisecond };
inline constexpr std::chrono::milliseconds kPingInterval{1};

// The three that are compared, a round each.
struct Round {
  std::size_t pings;
  Waits waits;
  Pace pace;
  Cores cores = two_cores();
  bool sealed = true;  // of peers
};
[[nodiscard]] Latencies udp_round(const Round& round);
[[nodiscard]] Latencies peers_round(const Round& round, std::size_t objects = 0);  // at least those it needs
struct DdsRound {
  double p50_us, p99_us;  // medians of its seconds
};
[[nodiscard]] bool has_ddsperf();
[[nodiscard]] DdsRound dds_round(int seconds, Pace pace);

}  // namespace peerd::bench
