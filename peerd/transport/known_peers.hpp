#pragma once
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/transport/sip_hash.hpp"
#include "peerd/transport/unicast_frame.hpp"

namespace peerd::net {

// Whom unicast goes to, and whom to greet in the hope of it. Pure: no socket, no clock.
//
// Known is who has echoed the number of its address of late. Candidates are the seeds of the configuration, for as long
// as they don't answer, whom a known peer says that it hears, for some rounds, and who fell silent, for some minutes.
class KnownPeers {
 public:
  struct Options {
    SipKey key = {};  // of this process alone, and secret: else others know what to echo
    std::vector<asio::ip::udp::endpoint> seeds = {};
    Duration silence = std::chrono::seconds(5);       // who hasn't greeted for so long is gone
    Duration introduction = std::chrono::seconds(3);  // for so long who was named by others is greeted
    Duration again = std::chrono::minutes(10);        // for so long who fell silent is greeted
    Duration own = std::chrono::seconds(60);          // for so long an address that is ours isn't greeted
    std::size_t most = 256;                           // of known peers, of those to be greeted, of our own
  };
  struct Peer {
    asio::ip::udp::endpoint at;
    std::uint32_t instance = 0;
    std::uint64_t number = 0;  // to echo to it
    HostTime last_received{};
    bool all_regions = false;
    std::vector<RegionId> regions = {};                // that it wants, ascending
    std::optional<asio::ip::udp::endpoint> also = {};  // where it echoed, too; nothing is sent there
  };
  enum class Outcome : std::uint8_t {
    kOwn,       // we greeted ourselves: by an address of this computer that is among the seeds
    kUnverified,  // hasn't echoed its number: answer it shortly, believe it nothing
    kNew,
    kKnown,
    kTwice,  // known by another address already
    kFull,
    kLeft,
  };

  explicit KnownPeers(Options options);

  Outcome on_greeting(HostTime now, const asio::ip::udp::endpoint& from, const Greeting& greeting);
  void forget(HostTime now);

  // Our process, and the number that who receives at `at` is to echo: a keyed hash of it, so that knowing that of one
  // address tells nothing of others. Never 0.
  [[nodiscard]] std::uint32_t instance() const { return instance_; }
  [[nodiscard]] std::uint64_t number_for(const asio::ip::udp::endpoint& at) const;
  // Whether a known peer has echoed from there.
  [[nodiscard]] bool has_echoed(const asio::ip::udp::endpoint& from) const;

  [[nodiscard]] const std::vector<Peer>& peers() const { return peers_; }      // in the order in which they came
  [[nodiscard]] std::size_t introduced() const { return introduced_.size(); }  // named or silent, and not known now
  [[nodiscard]] std::size_t own() const { return own_.size(); }                // candidates that are ourselves
  [[nodiscard]] static bool wants(const Peer& peer, RegionId region);
  [[nodiscard]] std::vector<asio::ip::udp::endpoint> candidates() const;
  // The peers to name in a greeting, kGreetingPeersMax of them; `round` picks which where there are more. Addresses of
  // this computer's loopback mean somebody else to a receiver elsewhere.
  [[nodiscard]] std::vector<asio::ip::udp::endpoint> introductions(const Peer& to, std::size_t round) const;

 private:
  [[nodiscard]] bool is_known(const asio::ip::udp::endpoint& at) const;
  void introduce(const asio::ip::udp::endpoint& at, HostTime until);
  void on_own(HostTime now, const asio::ip::udp::endpoint& from, const Greeting& greeting);

  Options options_;
  std::uint32_t instance_;
  std::vector<Peer> peers_;
  std::map<asio::ip::udp::endpoint, HostTime> own_;         // candidates that are ourselves, and until when
  std::map<asio::ip::udp::endpoint, HostTime> introduced_;  // until when to greet them
};

}  // namespace peerd::net
