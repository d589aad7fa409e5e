#pragma once
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/net/greeting/address_numbers.hpp"
#include "peerd/net/greeting/sip_hash.hpp"
#include "peerd/net/greeting/unicast_frame.hpp"

namespace peerd::net {

// The addresses that unicast datagrams go to, and the candidates that are greeted. Sans-IO: no socket, no clock.
//
// A peer is known while it echoes the number of its address. Candidates are the configured addresses for as long as
// they do not answer, addresses that a known peer names, for some rounds, and peers that have become silent: for some
// minutes in each round, and from time to time for as long as this one runs.
class KnownPeers {
 public:
  struct Options {
    SipKey key = {};  // secret and of this process alone: whoever knows it can forge echoes
    std::vector<asio::ip::udp::endpoint> seeds = {};
    Duration silence = std::chrono::seconds(5);       // a known peer that sends no greeting for so long is removed
    Duration introduction = std::chrono::seconds(3);  // an address that others name is greeted for so long
    Duration again = std::chrono::minutes(10);        // a peer that has become silent is greeted for so long
    Duration rarely = std::chrono::minutes(1);        // then for `introduction` each time that this has passed
    Duration own = std::chrono::seconds(60);          // an address of this process is not greeted for so long
    Duration number = std::chrono::seconds(30);       // numbers are renewed so often, and the one before counts, too
    std::size_t most = 256;                           // limit of known peers, of introduced and of own addresses
  };
  struct Peer {
    asio::ip::udp::endpoint at;
    std::uint32_t instance = 0;
    std::uint64_t number = 0;  // the last number that it sent, which our greetings echo
    HostTime last_received{};
    bool all_regions = false;
    std::vector<RegionId> regions = {};                // those that it wants, ascending
    std::optional<asio::ip::udp::endpoint> also = {};  // another address that it echoed from; nothing is sent there
  };
  enum class Outcome : std::uint8_t {
    kOwn,         // our own greeting, by an address of this computer that is among the configured ones
    kUnverified,  // the sender has not echoed its number: the answer is short, and its content is not used
    kNew,
    kKnown,
    kTwice,  // known by another address already
    kFull,
    kLeft,
  };

  explicit KnownPeers(Options options);

  Outcome on_greeting(HostTime now, const asio::ip::udp::endpoint& from, const Greeting& greeting);
  // To be called at least once in a period of numbers.
  void forget(HostTime now);

  [[nodiscard]] std::uint32_t instance() const { return numbers_.instance(); }  // of this process
  // The number that the receiver at `at` must echo, in the period that forget() has begun.
  [[nodiscard]] std::uint64_t number_for(const asio::ip::udp::endpoint& at) const { return numbers_.number_for(at); }
  // Whether a known peer has echoed from that address.
  [[nodiscard]] bool has_echoed(const asio::ip::udp::endpoint& from) const;

  [[nodiscard]] const std::vector<Peer>& peers() const { return peers_; }      // in the order of their joining
  [[nodiscard]] std::size_t introduced() const { return introduced_.size(); }  // named or silent, and not known now
  [[nodiscard]] std::size_t own() const { return own_.size(); }                // candidates that are of this process
  [[nodiscard]] static bool wants(const Peer& peer, RegionId region);
  [[nodiscard]] std::vector<asio::ip::udp::endpoint> candidates() const;
  // The peers to name in a greeting, at most kGreetingPeersMax; `round` selects them where there are more. Loopback
  // addresses are left out for receivers on other computers, where they mean another peer.
  [[nodiscard]] std::vector<asio::ip::udp::endpoint> introductions(const Peer& to, std::size_t round) const;

 private:
  [[nodiscard]] bool is_known(const asio::ip::udp::endpoint& at) const;
  void note_silent(HostTime now, const asio::ip::udp::endpoint& at);
  void introduce(const asio::ip::udp::endpoint& at, HostTime until);
  void on_own(HostTime now, const asio::ip::udp::endpoint& from, const Greeting& greeting);

  Options options_;
  AddressNumbers numbers_;
  std::vector<Peer> peers_;
  std::map<asio::ip::udp::endpoint, HostTime> own_;         // candidates of this process, and until when
  std::map<asio::ip::udp::endpoint, HostTime> introduced_;  // addresses to greet, and until when
  struct Silent {
    HostTime since, due;  // when it is to be greeted again
  };
  std::map<asio::ip::udp::endpoint, Silent> silent_;  // peers that were known, and have not said that they leave
};

}  // namespace peerd::net
