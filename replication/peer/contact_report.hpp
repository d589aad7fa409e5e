#pragma once
#include "core/time.hpp"
#include "replication/peer/peer_parts.hpp"

namespace peerd::replication {

// Handles the contacts that both worlds have found, at a tick, after both have been advanced to t: passes them to the
// decisions, and reports them and the objects that have ceased to touch anything.
void report_contacts(PeerParts& parts, SimTime t);

}  // namespace peerd::replication
