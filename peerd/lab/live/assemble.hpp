#pragma once
#include <vector>

#include "peerd/lab/live/run_assembler.hpp"

namespace peerd {

// The record of a run whose peers have kept the rows of their logs. RunAssembler says how.
[[nodiscard]] Result<measure::RunRecord> assemble(const config::RunSettings& run, const SharedWorld& shared,
                                                  const std::vector<PeerLog>& logs, Measuring measuring = {});

}  // namespace peerd
