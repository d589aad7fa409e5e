#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/session/membership.hpp"

namespace peerd {

// Troubles are what keeps a peer that runs from being in one session with all others, as sentences for people.

// Finds the members that are heard, and that say for a while that they hear nothing of this peer. It is asked several
// times a second. Where it has not been for longer, this peer was stopped, and the others have lost it meanwhile: they
// have the time to hear it once more.
class OneWayLinks {
 public:
  static constexpr Duration kStoppedAfter = std::chrono::seconds(1);

  [[nodiscard]] std::vector<std::string> find(const replication::Membership& members, HostTime now);

 private:
  std::map<PeerId, HostTime> unheard_since_;  // by the members that say so
  std::optional<HostTime> asked_at_;
};
// The same of a peer that is no member: the seal opens nothing of what hears nothing of this peer.
[[nodiscard]] std::string one_way_link(PeerId peer);
// The sentence where the last stamp of this peer's own edits is so far ahead of session time, and no edit takes effect;
// empty: it is not.
[[nodiscard]] std::string edits_ahead(Duration ahead);
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
