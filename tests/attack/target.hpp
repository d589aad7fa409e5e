#pragma once
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <boost/asio/io_context.hpp>

#include "peerd/net/discovery/discovery.hpp"
#include "peerd/net/keys/identity.hpp"
#include "peerd/net/keys/symmetric_key.hpp"
#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/snapshot/snapshot_fetch.hpp"

namespace peerd::attack {

// The region of what is for all.
inline constexpr RegionId kAll{0};

// The session that is attacked, and how, as the command line says.
struct Target {
  std::string world, interface, key_file, identity_file;
  std::uint16_t port = 47474;
  std::uint32_t number = 0;  // of the peer that the attacker says it is; 0: a random one
  double seconds = 10;
  double rate = 0;          // a second; 0: that of the attack
  std::uint32_t count = 0;  // of connections, for example; 0: that of the attack
  std::string at;           // HOST:PORT of a peer that gives the world by TCP; empty: the first that answers
};

// How much of each kind an attack has sent, by the kind's name.
using Sent = std::map<std::string, std::uint64_t>;

// Whether somebody has asked the program to end (SIGTERM, SIGINT), from when on an attack ends as if its time were
// over.
[[nodiscard]] bool is_over();
void end_on_signals();

// Calls `step` so often that it is called `rate` times a second on average, and `pause` in between, until the time is
// over.
template <class Step, class Pause>
void repeat(const Target& target, double rate, Step step, Pause pause) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  std::uint64_t done = 0;
  for (;;) {
    const double elapsed_s = std::chrono::duration<double>(Clock::now() - begin).count();
    if (elapsed_s >= target.seconds || is_over()) return;
    // A computer that is too slow for the rate does not make up for it in one burst.
    const auto due = static_cast<std::uint64_t>(elapsed_s * rate);
    if (due > done + 1000) done = due - 1000;
    for (; done < due; ++done) step();
    pause();
  }
}

// The key of the session, from the file; ends the program where there is none.
[[nodiscard]] keys::SymmetricKey session_key(const Target& target);
// The identity of the file, else a new one.
[[nodiscard]] keys::Identity identity(const Target& target);
// The options of a socket for the session's group or for that of discovery.
[[nodiscard]] net::MulticastOptions multicast(const Target& target);
// The peers that answer for the world, at least one.
[[nodiscard]] std::vector<discovery::Found> peers(const Target& target);
// The peer to connect to by TCP.
[[nodiscard]] snapshot::Provider provider(const Target& target);
// The world as a joining peer gets it.
[[nodiscard]] snapshot::Snapshot snapshot(const Target& target);
[[noreturn]] void fail(const std::string& why);

}  // namespace peerd::attack
