#pragma once
#include <ostream>
#include <string>

#include "peerd/daemon/join/join_world.hpp"
#include "peerd/daemon/open/peer_options.hpp"
#include "peerd/peer/config/peer_settings.hpp"

namespace peerd {

// `peerd ls` prints which worlds there are in this LAN, and which peers in each: those that say so (transport.
// discoverable). Returns the exit code: 0, also where there are none; 3 the network cannot be asked.
//
// With `json` it prints one object to `out`: {"worlds": [{"name", "session", "protocol", "peers": [{"id", "name",
// "address", "snapshot_port"}]}]}; the session is 16 hexadecimal digits.
struct LsOptions {
  net::TransportSettings transport;  // interface and group
  double seconds = 1.0;              // for which it asks
  bool json = false;
};
[[nodiscard]] int run_ls(const LsOptions& options, std::ostream& out);

// `peerd join` runs a peer in a world of which it has no file: it gets all of it from the peers that are there, or,
// where none answers, from this user's store of it. Blocks as run_peer() does, and returns what that returns; 3 where
// there is no such world.
struct JoinOptions {
  JoinRequest request;
  std::string invitation;  // of --invite: the world's name and its key; "-": in standard input; empty: none
  PeerOptions peer;        // without a configuration; its `sets` are those of its own
};
[[nodiscard]] int run_join(JoinOptions& options);

}  // namespace peerd
