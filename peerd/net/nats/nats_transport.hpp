#pragma once
#include <boost/asio/io_context.hpp>
#include <cstdint>
#include <expected>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "core/ids.hpp"
#include "peerd/net/nats/connection_state.hpp"
#include "peerd/net/nats/mailbox.hpp"
#include "peerd/net/nats/nats_options.hpp"
#include "peerd/net/nats/outbox.hpp"
#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/transport/transport.hpp"

namespace peerd::nats {

class Connection;

// Carries datagrams through NATS servers: a region is a subject, joining it is a subscription. The C library calls back
// in threads of its own and may wait for seconds while it connects, so a worker thread makes all calls to it; letters
// and parcels go through bounded queues.
class NatsTransport final : public net::Transport {
 public:
  // Connects to a server. Where none answers, it goes on trying, which follow_interface() says; errors are settings
  // that are wrong, and servers that refuse this user or have no TLS as it is wanted. `io` and `clock` outlive it.
  [[nodiscard]] static std::expected<std::unique_ptr<NatsTransport>, net::NetError> open(boost::asio::io_context& io,
                                                                                         const net::HostClock& clock,
                                                                                         const NatsOptions& options);
  // Sends what waits, as far as a server is there.
  ~NatsTransport() override;

  void on_receive(ReceiveHandler handler) override;
  bool receive_pending() override;
  std::expected<void, net::NetError> join(RegionId region) override;
  std::expected<void, net::NetError> leave(RegionId region) override;
  void send(RegionId region, std::span<const std::byte> datagram) override;
  void flush() override { outbox_.flush(); }
  [[nodiscard]] std::optional<net::InterfaceChange> follow_interface() override;

  [[nodiscard]] const net::TrafficCounters& counters() const override;
  [[nodiscard]] std::size_t joined_count() const override { return joined_.size(); }
  // The room for datagrams that wait to be read, which is this process's own.
  [[nodiscard]] int receive_buffer_bytes() const override { return static_cast<int>(options_.receive_bytes); }
  [[nodiscard]] boost::asio::ip::address own_address() const override { return options_.nobody.address(); }
  [[nodiscard]] std::string describe() const override;

 private:
  NatsTransport(boost::asio::io_context& io, const net::HostClock& clock, const NatsOptions& options);

  void take(const Letter& letter);

  // ---- of the worker ----
  void work();
  void connect();
  void change(const RegionChange& change);
  void publish(const Parcel& parcel);
  void count_thrown_away();

  // The worker counts these.
  struct Counts {
    std::uint64_t packets_out = 0, bytes_out = 0, unreachable = 0, stale = 0, errors = 0;
    std::uint64_t thrown_away = 0;
  };

  NatsOptions options_;
  const net::HostClock& clock_;
  std::shared_ptr<Mailbox> mailbox_;
  std::shared_ptr<ConnectionState> state_;
  Outbox outbox_;
  std::set<RegionId> joined_;
  ReceiveHandler handler_;
  std::vector<Letter> letters_;
  mutable net::TrafficCounters counters_;
  std::uint64_t lost_said_ = 0;

  std::unique_ptr<Connection> connection_;  // of the worker, once that runs; null: there is none
  std::set<RegionId> wanted_;               // of the worker
  std::uint64_t thrown_away_before_ = 0;    // of the worker: by connections that are no more
  mutable std::mutex counts_mutex_;
  Counts counts_;
  std::string server_;  // to which it was connected first; empty: to none
  std::thread worker_;
};

}  // namespace peerd::nats
