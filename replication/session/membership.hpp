#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/wire/loss_meter.hpp"
#include "replication/session/offset_interval.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// Which datagrams of ours another peer has, as its echoes say: of those after the one that it heard first.
struct Acknowledgement {
  std::uint32_t after;
  Received received;
  explicit Acknowledgement(const Received& first) : after(first.highest), received(first) {}
  [[nodiscard]] bool has(std::uint32_t number) const { return number > after && received.has(number); }
  [[nodiscard]] bool surely_lost(std::uint32_t number) const { return number > after && received.surely_lost(number); }
  void on_echo(const Echo& echo);
};

// One other peer, as far as it has been heard.
struct Member {
  std::uint64_t incarnation = 0;
  std::string name;
  HostTime last_received{};  // our clock
  std::uint64_t datagrams_in = 0, bytes_in = 0;
  std::map<std::string, std::uint64_t> drops;  // of what it said, by reason
  std::uint32_t hello = 0;                     // the number of its last hello's datagram; 0: none
  HostTime hello_rx{};                         // when that came, our clock
  bool awaits_our_decision = false;                   // it holds a contact that this peer may be the one to decide
  bool synchronised = false;
  OffsetInterval clock;                 // its session time minus our clock
  bool leads = false;                   // it says that the session's time is its
  Duration clock_error{0};              // else, how far from that it may be
  std::optional<OsClockNote> os_clock;  // as of hello_rx
  bool os_clock_doubted = false;        // its and ours contradict what the hellos' stamps say
  std::uint32_t sessions = 0;
  std::optional<SimTime> start;
  std::map<RegionId, LossMeter> received;  // of its datagrams, which are numbered by region
  [[nodiscard]] LossMeter received_in_all() const {
    LossMeter all;
    for (const auto& [region, meter] : received) all += meter;
    return all;
  }
  bool echoes_us = false;               // its hellos echo ours
  bool stopped_echoing_us = false;              // they did, until it lost us
  std::size_t hellos_without_echo = 0;            // hellos without our echo since the last with one
  bool unreachable = false;                   // so many that nothing we say gets there
  std::optional<double> loss_to_peer;  // of our datagrams on their way to it, as it says
  std::optional<Acknowledgement> acknowledgement;      // for our datagrams, as it says
  static constexpr std::size_t kDelays = 16;
  std::array<Duration, kDelays> delays{};  // of its last hellos, session time to session time
  std::size_t delays_known = 0;            // ever measured
  // Their mean; none before the first.
  [[nodiscard]] std::optional<Duration> mean_delay() const {
    const std::size_t known = std::min(delays_known, delays.size());
    if (known == 0) return std::nullopt;
    const auto last = delays.begin() + static_cast<std::ptrdiff_t>(known);
    return std::accumulate(delays.begin(), last, Duration{0}) / static_cast<std::int64_t>(known);
  }
  Duration latency{0};  // how late it hears of others, as it says
  std::optional<Viewpoint> viewpoint;
  std::unordered_map<ObjectId, std::uint32_t> last_sequence;  // of the updates that were applied
};

// Who is here. Silence makes a peer lost, a higher boot number makes it a new one.
class Membership {
 public:
  enum class Admission : std::uint8_t { kKnown, kJoined, kRestarted, kStale };

  explicit Membership(Duration lost_after) : lost_after_(lost_after) {}

  // Any datagram of a peer. kStale: it belongs to an earlier life of that peer and must be dropped.
  Admission on_datagram(HostTime now, PeerId peer, std::uint64_t incarnation);
  // Those silent for longer than lost_after, removed; ascending.
  [[nodiscard]] std::vector<std::pair<PeerId, Member>> expire(HostTime now);
  std::optional<Member> remove(PeerId peer);
  // Counts everybody's silence anew from now on.
  void restart_silence_of_all(HostTime now);
  // This host's clock has jumped: what it was compared with is void.
  void forget_clocks() {
    for (auto& [peer, member] : members_) member.clock = {};
  }

  [[nodiscard]] Member* find(PeerId peer);
  // Of the datagrams of all.
  [[nodiscard]] double mean_loss() const {
    LossMeter all;
    for (const auto& [peer, member] : members_) all += member.received_in_all();
    return all.loss();
  }
  // What was not listened to is no loss: counts a region's datagrams anew.
  void reset_loss_of(RegionId region) {
    for (auto& [peer, member] : members_) member.received.erase(region);
  }
  // The lowest synchronised peer: the one whose session time the others follow.
  [[nodiscard]] const std::map<PeerId, Member>& all() const { return members_; }
  [[nodiscard]] std::optional<HostTime> next_expiry() const;

 private:
  Duration lost_after_;
  std::map<PeerId, Member> members_;  // ordered: output must not depend on hashing
};

}  // namespace peerd::replication
