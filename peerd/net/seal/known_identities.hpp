#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/net/keys/identity.hpp"
#include "peerd/net/seal/announcement.hpp"

namespace peerd::seal {

// KnownIdentities knows which key each peer's number belongs to, from that peer's first proof on. One member can make
// identities without end, each of which proves itself and falls silent: those are forgotten, and their numbers may be
// anybody's again.
class KnownIdentities {
 public:
  static constexpr std::size_t kMost = 1 << 16;
  // One that was heard for less is forgotten once it has been silent for as long.
  static constexpr Duration kShortLife = std::chrono::seconds(30);
  // Others make room once they have been silent for that long.
  static constexpr Duration kSilent = std::chrono::seconds(10);
  static constexpr std::size_t kForgottenMax = 1 << 14;  // boots of identities that are forgotten

  // `own`: this peer's, which is never forgotten.
  KnownIdentities(PeerId own, const keys::PublicKey& key);

  [[nodiscard]] std::optional<keys::PublicKey> key_of(PeerId peer) const;
  [[nodiscard]] std::size_t size() const { return known_.size(); }
  // The peer, which is not known, belongs to that key. False: there is no room.
  [[nodiscard]] bool bind(PeerId peer, const keys::PublicKey& key, HostTime now);
  // The peer was heard, and proven.
  void note_heard(PeerId peer, HostTime now);
  // The peers that are forgotten from now on. It looks at most once in some seconds.
  [[nodiscard]] std::vector<PeerId> take_forgotten(HostTime now);
  // The last announcement of a boot of a forgotten peer had that number: it and those before are records.
  void note_boot(PeerId peer, const BootId& boot, std::uint64_t announcements);
  [[nodiscard]] bool is_record(PeerId peer, const BootId& boot, std::uint64_t announcement) const;

 private:
  struct Known {
    keys::PublicKey key;
    HostTime since, heard;
  };

  void forget(PeerId peer);
  [[nodiscard]] bool make_room(HostTime now);

  std::map<PeerId, Known> known_;
  std::vector<PeerId> forgotten_;  // since take_forgotten()
  HostTime due_{};
  std::map<std::pair<PeerId, BootId>, std::uint64_t> boots_;  // of forgotten peers, by the last announcement
  std::deque<std::pair<PeerId, BootId>> boots_by_age_;        // the oldest makes room
};

}  // namespace peerd::seal
