#pragma once
#include <boost/asio/ip/udp.hpp>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/net/unicast_frame.hpp"

namespace peerd::net {

// Whom unicast goes to, and whom to greet in the hope of it. Pure: no socket, no clock.
//
// Known is who has echoed our instance of late. Candidates are the seeds of the configuration, for as long as they
// don't answer, and whom a known peer says that it hears, for some rounds.
class KnownPeers {
 public:
  struct Options {
    std::uint64_t instance = 0;  // our own, as a Greeting has it
    std::vector<asio::ip::udp::endpoint> seeds = {};
    Duration silence = std::chrono::seconds(5);       // who hasn't greeted for so long is gone
    Duration introduction = std::chrono::seconds(3);  // for so long who was named by others is greeted
    std::size_t most = 256;                           // of known peers, and of those named by others
  };
  struct Peer {
    asio::ip::udp::endpoint at;
    std::uint64_t instance = 0;
    HostTime heard{};
    bool all_regions = false;
    std::vector<RegionId> regions = {};  // that it wants, ascending
  };
  enum class Outcome : std::uint8_t {
    kOwn,       // we greeted ourselves: by an address of this computer that is among the seeds
    kStranger,  // hasn't echoed our instance: answer it shortly, believe it nothing
    kNew,
    kKnown,
    kTwice,  // known by another address already
    kFull,
    kLeft,
  };

  explicit KnownPeers(Options options);

  Outcome on_greeting(HostTime now, const asio::ip::udp::endpoint& from, const Greeting& greeting);
  void forget(HostTime now);

  [[nodiscard]] const std::vector<Peer>& peers() const { return peers_; }      // in the order in which they came
  [[nodiscard]] std::size_t introduced() const { return introduced_.size(); }  // by others, and not known yet
  [[nodiscard]] static bool wants(const Peer& peer, RegionId region);
  [[nodiscard]] std::vector<asio::ip::udp::endpoint> candidates() const;
  // The peers to name in a greeting, kGreetingPeersMax of them; `round` picks which where there are more. Addresses of
  // this computer's loopback mean somebody else to a receiver elsewhere.
  [[nodiscard]] std::vector<asio::ip::udp::endpoint> introductions(const Peer& to, std::size_t round) const;

 private:
  [[nodiscard]] bool is_known(const asio::ip::udp::endpoint& at) const;

  Options options_;
  std::vector<Peer> peers_;
  std::set<asio::ip::udp::endpoint> own_;                   // that turned out to be ours
  std::map<asio::ip::udp::endpoint, HostTime> introduced_;  // until when to greet them
};

}  // namespace peerd::net
