#include "peerd/node/peer_edits.hpp"

#include <utility>
#include <variant>

namespace peerd {

void PeerEdits::note(const EditReport& report) {
  if (report.operation)
    operations_.try_emplace(*report.operation, OperationState{report.edit, false, false, false, {}});
  reports_.push_back(report);
}

void PeerEdits::note(const replication::Output& output) {
  if (const auto* edited = std::get_if<replication::SceneEdited>(&output)) {
    const auto own = operations_.find(edited->operation);
    if (own == operations_.end()) return;
    own->second.applied = true;
    own->second.refused = edited->refused;
    if (!edited->refused.empty()) reports_.push_back({own->second.edit, edited->operation, edited->refused});
  } else if (const auto* held = std::get_if<replication::OperationHeld>(&output)) {
    if (const auto own = operations_.find(held->operation); own != operations_.end()) own->second.held = true;
  }
}

void PeerEdits::note_stored(replication::OperationId last) {
  for (auto after = operations_.upper_bound(last); after != operations_.begin();) {
    OperationState& state = (--after)->second;
    if (after->first.author != last.author || state.stored) return;
    state.stored = true;
  }
}

const OperationState* PeerEdits::find(replication::OperationId id) const {
  const auto known = operations_.find(id);
  return known == operations_.end() ? nullptr : &known->second;
}

std::optional<EditReport> PeerEdits::poll() {
  if (reports_.empty()) return std::nullopt;
  EditReport report = std::move(reports_.front());
  reports_.pop_front();
  return report;
}

}  // namespace peerd
