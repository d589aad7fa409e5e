#pragma once
#include <vector>

#include "peerd/measure/run_record.hpp"
#include "peerd/node/peer_node.hpp"

namespace peerd {

// Lays the logs of one run's peers side by side: every ghost against the truth at the same true instant. The truth of a
// driven object is its motion; that of any other object is interpolated between the ticks of its owner.
[[nodiscard]] Result<report::RunRecord> assemble(const config::RunSettings& run, const SharedWorld& shared,
                                                 const std::vector<PeerLog>& logs);

}  // namespace peerd
