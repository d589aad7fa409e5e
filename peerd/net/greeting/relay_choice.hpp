#pragma once
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/time.hpp"
#include "peerd/net/greeting/link_meter.hpp"
#include "peerd/net/greeting/unicast_frame.hpp"

namespace peerd::net {

// Chooses one relay of a list: the first that answers. Another one takes its place when it is silent, is cut off from
// its own parent, loses much, or leads back here. Sans-IO.
class RelayChoice {
 public:
  struct Options {
    std::vector<asio::ip::udp::endpoint> relays = {};     // in the order of preference
    std::uint32_t self = 0;                               // the instance of this process, which a path may lead back to
    Duration silence = std::chrono::milliseconds(1'200);  // a relay that is silent for so long has failed
    Duration steady = std::chrono::seconds(3);            // a better relay takes over after it has answered for so long
  };
  struct Relay {
    asio::ip::udp::endpoint at;
    std::uint32_t instance = 0;
    std::uint64_t number = 0;                    // the last number that it sent, which greetings to it echo; 0: none
    std::optional<HostTime> last_received = {};  // the last sign of it; none: none so far, or it has left
    HostTime answers_since{};
    std::vector<std::uint32_t> path = {};  // from it up to the root
    bool detached = false;                 // it is to have a parent, and has none
    bool all_regions = false;
    std::vector<RegionId> regions = {};  // those that it wants, ascending
    LinkMeter meter = {};
    HostTime greeted{};      // the last greeting to it; of the driver
    HostTime greeting_at{};  // the last greeting from it that has a note
    HostTime datagram_at{};  // the last datagram from it
  };

  explicit RelayChoice(Options options);

  // The relay at that address; null: it is none of the list.
  [[nodiscard]] Relay* find(const asio::ip::udp::endpoint& at);
  // A greeting of a relay of the list that has echoed this process's number for it.
  void on_greeting(HostTime now, Relay& relay, const Greeting& greeting);
  // A datagram has come from the relay that is chosen.
  void on_datagram(HostTime now);
  // Whether the driver is to greet it now: every 400 ms, and every second while it sends datagrams, which say as well
  // that it is there.
  [[nodiscard]] bool is_greeting_due(const Relay& relay, HostTime now) const;
  // Chooses anew; true: another one than before, or none.
  bool update(HostTime now);

  [[nodiscard]] Relay* chosen() { return chosen_ ? &relays_[*chosen_] : nullptr; }
  [[nodiscard]] const Relay* chosen() const { return chosen_ ? &relays_[*chosen_] : nullptr; }
  [[nodiscard]] std::vector<Relay>& relays() { return relays_; }
  [[nodiscard]] const std::vector<Relay>& relays() const { return relays_; }

  [[nodiscard]] static bool wants(const Relay& relay, RegionId region);

 private:
  [[nodiscard]] bool answers(const Relay& relay, HostTime now) const;
  [[nodiscard]] bool leads_back(std::size_t relay) const;

  Options options_;
  std::vector<Relay> relays_;
  std::optional<std::size_t> chosen_;
};

}  // namespace peerd::net
