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

// A signature takes long to check (80 us), so that checks have a rate, whoever sends. What comes beyond it waits here,
// by address and by the peer that it says it is from. Addresses take turns, and so do the peers of each: who sends more
// than a share delays and loses its own. It has no clock.
class CheckQueue {
 public:
  // So many checks at once, and in the long run.
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
  // Keeps a copy of a datagram of that peer, which may take the place of another one. False: it is lost, or another is.
  [[nodiscard]] bool push(const net::Arrival& arrival, PeerId sender);
  // Whose turn it is; none: nobody waits, or it is too early.
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
