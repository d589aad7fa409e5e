#pragma once
#include <boost/asio/io_context.hpp>
#include <expected>
#include <memory>
#include <set>

#include "peerd/net/relay/network.hpp"
#include "peerd/net/transport/unicast_fan_out.hpp"

namespace peerd::relay {

// Peers that send a copy of each datagram to each other, because they have no multicast. The relay is one of them.
class Mesh final : public Network {
 public:
  // `io` and `clock` outlive it.
  [[nodiscard]] static std::expected<std::unique_ptr<Mesh>, net::NetError> open(boost::asio::io_context& io,
                                                                                const net::HostClock& clock,
                                                                                const net::UnicastOptions& options);

  void start(OnDatagram on_datagram, OnChange on_change) override;
  [[nodiscard]] std::optional<std::string> advance(HostTime now, const Place& place) override;
  [[nodiscard]] Wanted wanted() const override;
  void receive(const Wanted& wanted_elsewhere) override;
  void send(RegionId region, std::span<const std::byte> datagram) override { fan_out_->send(region, datagram); }
  void flush() override { fan_out_->flush(); }
  [[nodiscard]] const net::TrafficCounters& counters() const override { return fan_out_->counters(); }
  [[nodiscard]] std::size_t peers() const override { return fan_out_->peers().size(); }
  [[nodiscard]] bool is_active() const override { return true; }
  [[nodiscard]] std::string describe() const override { return fan_out_->describe(); }

 private:
  explicit Mesh(std::unique_ptr<net::UnicastFanOut> fan_out) : fan_out_(std::move(fan_out)) {}

  std::unique_ptr<net::UnicastFanOut> fan_out_;
  OnChange on_change_;
  Wanted before_;  // as of the last advance()
  std::set<RegionId> joined_;
};

}  // namespace peerd::relay
