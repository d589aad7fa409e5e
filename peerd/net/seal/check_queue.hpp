#pragma once
#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <vector>

#include <boost/asio/ip/udp.hpp>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/net/os/token_bucket.hpp"
#include "peerd/net/transport/transport.hpp"

namespace peerd::seal {

// Limits how many signatures are checked, each of which takes 80 us, whoever sends. A datagram beyond that rate waits
// here, by its address and by the peer that it says it is from. Addresses take turns, and so do the peers of each, so
// that a sender of more than its share delays and loses its own datagrams. It has no clock.
class CheckQueue {
 public:
  // The checks that are made at once, and in a second of the long run.
  static constexpr net::TokenRate kRate{64.0, 4000.0};
  static constexpr std::size_t kOfPeerMax = 64, kMost = 1024;  // datagrams that wait

  struct Waiting {
    RegionId region;
    std::vector<std::byte> datagram;
    HostTime at;
    boost::asio::ip::udp::endpoint from;
  };

  // Whether what comes now need not wait.
  [[nodiscard]] bool is_free(HostTime now) const { return size_ == 0 && checks_.tokens(kRate, now) >= 1.0; }
  // A check was made.
  void note_check(HostTime now) { (void)checks_.take(kRate, now); }
  // Keeps a copy of a datagram of that peer. False: a datagram is lost, this one or one of the address that has the
  // most.
  [[nodiscard]] bool push(const net::Arrival& arrival, PeerId sender);
  // The datagram whose turn it is; none: nothing waits, or it is too early.
  [[nodiscard]] std::optional<Waiting> next(HostTime now);
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  struct Source {
    std::map<PeerId, std::deque<Waiting>> peers;  // none is empty
    PeerId served{};                              // last
    std::size_t size = 0;
  };

  Waiting take_from(std::map<boost::asio::ip::address, Source>::iterator source);

  net::TokenBucket checks_{kRate};
  std::map<boost::asio::ip::address, Source> sources_;  // none is empty
  boost::asio::ip::address served_;                     // last
  std::size_t size_ = 0;
};

}  // namespace peerd::seal
