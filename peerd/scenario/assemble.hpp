#pragma once
#include <vector>

#include "peerd/measure/run_record.hpp"
#include "peerd/node/peer_node.hpp"

namespace peerd {

// Puts the peers' logs of one run side by side: every belief against the truth at the same true instant. The truth of a
// driven object is its motion; that of any other is interpolated between the ticks of the peer that runs it.
[[nodiscard]] Result<report::RunRecord> assemble(const config::RunSettings& run, const SharedWorld& shared,
                                                 const std::vector<PeerLog>& logs);

}  // namespace peerd
