#pragma once
#include <cstdint>
#include <expected>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>

#include "peerd/net/greeting/address_numbers.hpp"
#include "peerd/net/greeting/greeting_seal.hpp"
#include "peerd/net/greeting/source_buckets.hpp"
#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/transport/transport.hpp"

namespace peerd::net {

// A member of an island: a network where all reach each other by multicast. Where a relay (peerd/net/relay) joins the
// island to others it asks, in region 0, who wants which regions; a member answers, for multicast itself tells nobody.
// Without a relay it sends nothing of its own.
class IslandMember final : public Transport {
 public:
  struct Options {
    SipKey key = {};                          // AddressNumbers
    std::shared_ptr<GreetingSeal> seal = {};  // null: greetings are open
    bool v4 = true;
    std::uint32_t group_offset = 0;  // GroupPlan::offset
  };

  // `clock` outlives it.
  IslandMember(const HostClock& clock, std::unique_ptr<Transport> carrier, const Options& options);
  // Tells the relay that nothing is wanted any more.
  ~IslandMember() override;

  void on_receive(ReceiveHandler handler) override;
  bool receive_pending() override { return carrier_->receive_pending(); }
  std::expected<void, NetError> join(RegionId region) override;
  std::expected<void, NetError> leave(RegionId region) override;
  void send(RegionId region, std::span<const std::byte> datagram) override { carrier_->send(region, datagram); }
  void flush() override;
  [[nodiscard]] std::optional<InterfaceChange> follow_interface() override { return carrier_->follow_interface(); }
  [[nodiscard]] const TrafficCounters& counters() const override;
  [[nodiscard]] std::size_t joined_count() const override { return carrier_->joined_count(); }
  [[nodiscard]] int receive_buffer_bytes() const override { return carrier_->receive_buffer_bytes(); }
  [[nodiscard]] asio::ip::address own_address() const override { return carrier_->own_address(); }
  [[nodiscard]] std::string why_only_here() const override { return carrier_->why_only_here(); }
  [[nodiscard]] std::string describe() const override { return carrier_->describe(); }

 private:
  void on_greeting(const Arrival& arrival);
  void report(HostTime now, bool leaving);
  [[nodiscard]] bool has_relay(HostTime now) const;

  const HostClock& clock_;
  std::unique_ptr<Transport> carrier_;
  Options options_;
  std::uint32_t instance_;
  SourceBuckets strangers_;
  std::set<RegionId> joined_;
  ReceiveHandler handler_;
  std::optional<HostTime> relay_asked_, reported_;
  bool report_due_ = false;
  std::int64_t last_report_ns_ = 0;
  TrafficCounters own_;                                      // of greetings alone
  std::uint64_t greetings_passed_ = 0, greeting_bytes_ = 0;  // what the carrier has counted as datagrams
  mutable TrafficCounters counters_;
};

}  // namespace peerd::net
