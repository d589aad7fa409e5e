#pragma once
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace peerd::bench {

// Somebody who passes datagrams of one source on to several sinks, on a core of its own.
class Forwarder {
 public:
  Forwarder() = default;
  Forwarder(const Forwarder&) = delete;
  Forwarder& operator=(const Forwarder&) = delete;
  virtual ~Forwarder() = default;

  // The processor time that it has used so far [s].
  [[nodiscard]] virtual double cpu_s() const = 0;
  // Sends these datagrams; each has the same size.
  virtual void send(const std::vector<std::vector<std::byte>>& datagrams) = 0;
  // Appends what has arrived at the sink since the last call, without waiting; returns how many datagrams.
  virtual std::size_t receive(std::size_t sink, std::vector<std::byte>& all) = 0;
  // To be called at least once a second.
  virtual void keep_alive() {}
};

// recvmmsg and sendmmsg in a loop, and nothing else: what the kernel's way costs.
[[nodiscard]] std::unique_ptr<Forwarder> bare_forwarder(std::size_t sinks);
// A relay::Relay, whose source and sinks are single peers.
[[nodiscard]] std::unique_ptr<Forwarder> relay_forwarder(std::size_t sinks);
// Debian's nats-server, limited to one thread of Go, over TCP on lo. Null: it is not installed.
[[nodiscard]] std::unique_ptr<Forwarder> nats_forwarder(std::size_t sinks, std::size_t datagram_bytes);

inline constexpr int kEndsCore = 0, kForwardersCore = 1;
void run_on(int core);  // the calling thread from now on; where there is only one, nothing happens

}  // namespace peerd::bench
