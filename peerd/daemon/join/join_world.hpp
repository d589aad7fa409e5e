#pragma once
#include <string>

#include "peerd/daemon/open/peer_options.hpp"
#include "peerd/daemon/open/session_seal.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/net/keys/invitation.hpp"
#include "peerd/net/keys/session_key.hpp"
#include "peerd/peer/config/peer_settings.hpp"

namespace peerd {

// Which world of others a peer is to take part in.
struct JoinRequest {
  std::string world;                 // its name; empty: the only one
  std::string from;                  // "HOST:PORT" of a peer, in place of asking who is here; empty: none
  net::TransportSettings transport;  // interface and group by which it asks
  keys::KeyChoice key;               // neither file: this user's own key of the world
  bool open = false;                 // the session has no key
};

// Gets all of a world from the peers that are in it, or, where none answers, from this user's store of it, and
// completes `peer`, the options of the peer that is to take part: its world, its key, its store, whom it greets. Blocks
// for a second and for as long as the world takes to come. Errors: there is no such world, its key is missing, what
// came is damaged.
[[nodiscard]] Result<void> join_world(const JoinRequest& request, PeerOptions& peer, const SayLine& say);

// Keeps the key, or the roster, of an invitation as this user's own of its world, and makes that the world of the
// request. Errors: the request names another world, or nothing can be kept.
[[nodiscard]] Result<void> accept_invitation(const keys::Invitation& invitation, JoinRequest& request,
                                             const SayLine& say);

}  // namespace peerd
