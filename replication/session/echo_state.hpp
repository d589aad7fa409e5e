#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>

#include "replication/wire/wire.hpp"

namespace peerd::replication {

// The datagrams of this peer that another peer has received, as its echoes say: of those after the first one that it
// received.
struct Acknowledgement {
  std::uint32_t after;
  Received received;
  explicit Acknowledgement(const Received& first) : after(first.highest), received(first) {}
  [[nodiscard]] bool has(std::uint32_t number) const { return number > after && received.has(number); }
  [[nodiscard]] bool surely_lost(std::uint32_t number) const { return number > after && received.surely_lost(number); }
  void on_echo(const Echo& echo);
};

// Whether another peer receives this one, as the echoes in its hellos say.
struct EchoState {
  bool echoes_us = false;
  bool stopped_echoing_us = false;                 // it echoed this peer until it lost it
  std::size_t hellos_without_echo = 0;             // since the last hello with one
  bool unreachable = false;                        // hellos without an echo were so many that nothing gets there
  std::optional<double> loss_to_peer;              // the part of this peer's datagrams that gets lost, in (0, 1)
  std::optional<Acknowledgement> acknowledgement;  // of this peer's datagrams

  // The part that gets lost, for reports: zero where the echoes show that all has come since the first of them, while
  // the estimate never quite gets there. None before an echo.
  [[nodiscard]] std::optional<double> reported_loss() const;
  // A hello that does not name this peer. `leaves_us_out`: although it was this peer's turn to be named. `turn`: the
  // number of hellos in which the sender names every peer that it receives, >= 1.
  void on_hello_without_echo(bool leaves_us_out, std::size_t turn);
  // A hello that names this peer. True where the sender had lost this peer and has found it again: whatever it knew of
  // this peer's objects is void.
  [[nodiscard]] bool on_echo(const Echo& echo);
};

}  // namespace peerd::replication
