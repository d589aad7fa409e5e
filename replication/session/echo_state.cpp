#include "replication/session/echo_state.hpp"

#include <cassert>
#include <utility>

namespace peerd::replication {
namespace {

// A peer that does not name this one in so many turns does not receive it: enough for one hello in ten lost
// (0.1^4 = 0.0001).
constexpr std::size_t kTurnsUnechoed = 4;
// A peer that does not name this one in so many turns receives nothing of it: no copy gets there, nor does an
// introduction.
constexpr std::size_t kTurnsUnreachable = 20;

}  // namespace

void Acknowledgement::on_echo(const Echo& echo) {
  if (echo.received.highest >= received.highest) received = echo.received;  // else a later hello has overtaken it
}

std::optional<double> EchoState::reported_loss() const {
  if (!acknowledgement) return loss_to_peer;
  const auto& [after, received] = *acknowledgement;
  const bool all_came = received.run >= std::min(received.highest - after, Received::kRunMax);
  return all_came ? std::optional(0.0) : loss_to_peer;
}

void EchoState::on_hello_without_echo(bool leaves_us_out, std::size_t turn) {
  assert(turn >= 1);
  // A hello may name others only because it is their turn; then many in a row without this peer's name say it, too.
  ++hellos_without_echo;
  unreachable = hellos_without_echo > kTurnsUnreachable * turn;
  const bool unnamed = leaves_us_out || hellos_without_echo > kTurnsUnechoed * turn;
  if (unnamed && std::exchange(echoes_us, false)) {
    stopped_echoing_us = true;
    acknowledgement.reset();
  }
}

bool EchoState::on_echo(const Echo& echo) {
  hellos_without_echo = 0;
  unreachable = false;
  echoes_us = true;
  loss_to_peer = echo.loss;
  if (!acknowledgement) acknowledgement.emplace(echo.received);
  acknowledgement->on_echo(echo);
  return std::exchange(stopped_echoing_us, false);
}

}  // namespace peerd::replication
