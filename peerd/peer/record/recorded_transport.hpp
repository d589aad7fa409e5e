#pragma once
#include <functional>
#include <memory>

#include "peerd/net/transport/transport.hpp"
#include "peerd/peer/record/capture.hpp"

namespace peerd::record {

// A transport whose datagrams are captured as they are on the network: below a seal, that is sealed.
class RecordedTransport final : public net::Transport {
 public:
  // `capture` outlives it.
  RecordedTransport(std::unique_ptr<net::Transport> carrier, CaptureWriter& capture, std::function<HostTime()> clock);

  void on_receive(ReceiveHandler handler) override;
  bool receive_pending() override { return carrier_->receive_pending(); }
  std::expected<void, net::NetError> join(RegionId region) override { return carrier_->join(region); }
  std::expected<void, net::NetError> leave(RegionId region) override { return carrier_->leave(region); }
  void send(RegionId region, std::span<const std::byte> datagram) override;
  void flush() override;
  [[nodiscard]] std::optional<net::InterfaceChange> follow_interface() override { return carrier_->follow_interface(); }
  [[nodiscard]] const net::TrafficCounters& counters() const override { return carrier_->counters(); }
  [[nodiscard]] std::size_t joined_count() const override { return carrier_->joined_count(); }
  [[nodiscard]] int receive_buffer_bytes() const override { return carrier_->receive_buffer_bytes(); }
  [[nodiscard]] boost::asio::ip::address own_address() const override { return carrier_->own_address(); }
  [[nodiscard]] std::string why_only_here() const override { return carrier_->why_only_here(); }
  [[nodiscard]] std::string describe() const override { return carrier_->describe() + ", recorded"; }

 private:
  [[nodiscard]] HostTime not_before_last(HostTime at);

  std::unique_ptr<net::Transport> carrier_;
  CaptureWriter& capture_;
  std::function<HostTime()> clock_;
  ReceiveHandler handler_;
  HostTime last_{};
};

}  // namespace peerd::record
