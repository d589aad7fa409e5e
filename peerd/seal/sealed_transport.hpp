#pragma once
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "peerd/os/host_clock.hpp"
#include "peerd/seal/sealer.hpp"
#include "peerd/transport/source_buckets.hpp"
#include "peerd/transport/transport.hpp"

namespace peerd::seal {

// A transport whose datagrams are sealed. What is not opened is counted, and the first of a kind in a minute is said.
class SealedTransport final : public net::Transport {
 public:
  using Warn = std::function<void(const std::string&)>;

  // `io` and `clock` outlive it.
  SealedTransport(boost::asio::io_context& io, const net::HostClock& clock, std::unique_ptr<net::Transport> carrier,
                  const SymmetricKey& session, PeerId self, Warn warn);

  void on_receive(ReceiveHandler handler) override;
  bool receive_pending() override { return carrier_->receive_pending(); }
  std::expected<void, net::NetError> join(RegionId region) override { return carrier_->join(region); }
  std::expected<void, net::NetError> leave(RegionId region) override { return carrier_->leave(region); }
  void send(RegionId region, std::span<const std::byte> datagram) override;
  void flush() override { carrier_->flush(); }
  [[nodiscard]] std::optional<net::InterfaceChange> follow_interface() override { return carrier_->follow_interface(); }
  [[nodiscard]] const net::TrafficCounters& counters() const override;
  [[nodiscard]] std::size_t joined_count() const override { return carrier_->joined_count(); }
  [[nodiscard]] int receive_buffer_bytes() const override { return carrier_->receive_buffer_bytes(); }
  [[nodiscard]] boost::asio::ip::address own_address() const override { return carrier_->own_address(); }
  [[nodiscard]] std::string describe() const override { return carrier_->describe() + ", sealed"; }

 private:
  void take(const net::Arrival& arrival);
  void refuse(Refusal why, const net::Arrival& arrival);
  void announce();
  void wait();

  const net::HostClock& clock_;
  std::unique_ptr<net::Transport> carrier_;
  net::SourceBuckets strangers_;
  Sealer sealer_;
  Warn warn_;
  boost::asio::steady_timer timer_;
  ReceiveHandler handler_;
  std::map<Refusal, HostTime> warned_;
  // The parts of what the carrier has passed on, the refused ones by Refusal.
  std::uint64_t announcements_in_ = 0, flood_ = 0;
  std::array<std::uint64_t, kRefusals> refused_{};
  mutable net::TrafficCounters counters_;
};

}  // namespace peerd::seal
