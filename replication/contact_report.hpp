#pragma once
#include "core/time.hpp"
#include "replication/peer_parts.hpp"

namespace peerd::replication {

// At a tick, after both worlds have been advanced to t: hands the contacts that they have found to who decides them,
// and reports them, and what has ceased to touch anything.
void report_contacts(PeerParts& parts, SimTime t);

}  // namespace peerd::replication
