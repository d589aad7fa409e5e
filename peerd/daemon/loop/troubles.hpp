#pragma once
#include <map>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "replication/session/membership.hpp"

namespace peerd {

// Troubles are what keeps a peer that runs from being in one session with all others, as sentences for people.

// The members that are heard, and that say for a while that they hear nothing of this peer.
[[nodiscard]] std::vector<std::string> one_way_links(const replication::Membership& members, HostTime now);
// The sentence where this computer alone is reached, for that reason (net::Transport::why_only_here).
[[nodiscard]] std::string only_here(const std::string& why);
// The sentence where the world came from a peer by TCP, and no datagram of any peer has come since.
[[nodiscard]] std::string nothing_heard(const std::string& provider);

// Says each trouble when it begins, and again once a minute while it lasts.
class SaidTroubles {
 public:
  static constexpr Duration kAgainAfter = std::chrono::minutes(1);

  // Somebody has said that one already.
  void note(HostTime now, const std::string& trouble) { said_[trouble] = now; }
  // The ones of these, all that there are at present, that are to be said now.
  [[nodiscard]] std::vector<std::string> due(HostTime now, const std::vector<std::string>& present);

 private:
  std::map<std::string, HostTime> said_;
};

}  // namespace peerd
