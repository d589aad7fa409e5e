#pragma once
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "peerd/net/greeting/source_buckets.hpp"
#include "peerd/net/keys/roster.hpp"
#include "peerd/net/os/host_clock.hpp"
#include "peerd/net/seal/check_queue.hpp"
#include "peerd/net/seal/roster_exchange.hpp"
#include "peerd/net/seal/sealer.hpp"
#include "peerd/net/seal/wrong_datagrams.hpp"
#include "peerd/net/transport/transport.hpp"

namespace peerd::seal {

// Contents say of a datagram what those need to know who carry it.
struct Contents {
  PeerId sender;
  bool must_be_signed = true;  // no member may say it in another's name, not even once
  bool changes_world = true;   // no observer may say it
};

// A transport whose datagrams are sealed. What is not opened is counted, and the first of a kind in a minute is said.
class SealedTransport final : public net::Transport {
 public:
  using Warn = std::function<void(const std::string&)>;
  // Examines a datagram; none: peers send no such thing.
  using Examine = std::function<std::optional<Contents>(std::span<const std::byte>)>;

  // `io`, `clock` and `rosters` outlive it. `self`: of its first epoch.
  SealedTransport(boost::asio::io_context& io, const net::HostClock& clock, std::unique_ptr<net::Transport> carrier,
                  const keys::SymmetricKey& session, Sealer::Self self, Examine examine, Warn warn);
  // The same for a session whose members a roster names, of whom this one is one. A newer roster that comes from others
  // is passed to `on_roster`. Who lets `rosters` adopt one calls follow_roster() then.
  using OnRoster = std::function<void(const keys::Roster&)>;
  SealedTransport(boost::asio::io_context& io, const net::HostClock& clock, std::unique_ptr<net::Transport> carrier,
                  RosterExchange& rosters, OnRoster on_roster, Sealer::Self self, Examine examine, Warn warn);
  void follow_roster();
  [[nodiscard]] std::vector<PeerId> deaf_peers() const { return sealer_.deaf_peers(clock_.now()); }

  void on_receive(ReceiveHandler handler) override;
  bool receive_pending() override { return carrier_->receive_pending(); }
  std::expected<void, net::NetError> join(RegionId region) override { return carrier_->join(region); }
  std::expected<void, net::NetError> leave(RegionId region) override { return carrier_->leave(region); }
  void send(RegionId region, std::span<const std::byte> datagram) override;
  void flush() override;
  [[nodiscard]] std::optional<net::InterfaceChange> follow_interface() override { return carrier_->follow_interface(); }
  [[nodiscard]] const net::TrafficCounters& counters() const override;
  [[nodiscard]] std::size_t joined_count() const override { return carrier_->joined_count(); }
  [[nodiscard]] int receive_buffer_bytes() const override { return carrier_->receive_buffer_bytes(); }
  [[nodiscard]] boost::asio::ip::address own_address() const override { return carrier_->own_address(); }
  [[nodiscard]] std::string why_only_here() const override { return carrier_->why_only_here(); }
  [[nodiscard]] std::string describe() const override { return carrier_->describe() + ", sealed"; }

 private:
  [[nodiscard]] Sealer sealer_of_roster() const;
  void take_announcement(const net::Arrival& arrival, bool may_check);
  void take_roster_part(const net::Arrival& arrival);
  void take(const net::Arrival& arrival);
  void examine(const net::Arrival& arrival, bool may_check);
  void examine_later(const net::Arrival& arrival);
  void await_checks();
  void examine_waiting();
  void refuse(Refusal why, const net::Arrival& arrival);
  void send_due();
  [[nodiscard]] HostTime next_due() const;
  void wait();
  void say_findings();

  const net::HostClock& clock_;
  std::unique_ptr<net::Transport> carrier_;
  net::SourceBuckets strangers_;
  CheckQueue checks_;
  WrongDatagrams wrong_;
  boost::asio::steady_timer checks_timer_;
  bool awaits_checks_ = false;  // the timer runs
  Sealer::Self self_;
  RosterExchange* rosters_ = nullptr;  // null: there is one key for all
  OnRoster on_roster_;
  Sealer sealer_;
  Examine examine_;
  Warn warn_;
  boost::asio::steady_timer timer_;
  HostTime waits_until_{};
  ReceiveHandler handler_;
  // When a person was last told.
  std::array<std::optional<HostTime>, kRefusals> refusal_said_{};
  std::map<std::string, HostTime> finding_said_;  // by its sentence
  // The parts of what the carrier has passed on, the refused ones by Refusal.
  std::uint64_t announcements_in_ = 0, flood_ = 0;
  std::array<std::uint64_t, kRefusals> refused_{};
  mutable net::TrafficCounters counters_;
};

}  // namespace peerd::seal
