#include "peerd/node/peer_edits.hpp"

#include <algorithm>
#include <utility>
#include <variant>

namespace peerd {

void PeerEdits::note(const EditReport& report) {
  if (report.operation) {
    operations_.try_emplace(*report.operation, OperationState{report.edit, false, false, false, {}, {}});
  }
  reports_.push_back(report);
}

void PeerEdits::note_request(replication::OperationId id, ObjectId object, HostTime give_up_at) {
  operations_.at(id).asks = {object, give_up_at};
  asking_.push_back(id);
}

void PeerEdits::note(const replication::Output& output, PeerId self) {
  if (const auto* edited = std::get_if<replication::SceneEdited>(&output)) {
    const auto own = operations_.find(edited->operation);
    if (own == operations_.end()) return;
    own->second.applied = !own->second.asks;
    own->second.refused = edited->refused;
    if (!edited->refused.empty()) reports_.push_back({own->second.edit, edited->operation, edited->refused});
  } else if (const auto* held = std::get_if<replication::OperationHeld>(&output)) {
    if (const auto own = operations_.find(held->operation); own != operations_.end()) own->second.held = true;
  } else if (const auto* given = std::get_if<replication::ObjectGiven>(&output)) {
    for (const auto id : std::vector(asking_)) {
      OperationState& state = operations_.at(id);
      if (state.asks->first != given->object) continue;
      end_request(state, id, given->owner == self ? "" : "it has gone to another peer");
    }
  } else if (const auto* asked = std::get_if<replication::ObjectRequested>(&output)) {
    requests_.push_back(*asked);
  } else if (const auto* refused = std::get_if<replication::RequestRefused>(&output)) {
    const bool is_asking = std::ranges::find(asking_, refused->request) != asking_.end();
    if (is_asking) end_request(operations_.at(refused->request), refused->request, refused->reason);
  }
}

void PeerEdits::end_request(OperationState& state, replication::OperationId id, std::string refused) {
  std::erase(asking_, id);
  state.applied = refused.empty();
  state.refused = std::move(refused);
  if (!state.refused.empty()) reports_.push_back({state.edit, id, state.refused});
}

void PeerEdits::give_up(HostTime now) {
  for (const auto id : std::vector(asking_)) {
    OperationState& state = operations_.at(id);
    if (state.asks->second <= now) end_request(state, id, "its owner has not answered");
  }
}

std::optional<HostTime> PeerEdits::next_give_up() const {
  std::optional<HostTime> next;
  for (const auto id : asking_) {
    const HostTime at = operations_.at(id).asks->second;
    next = next ? std::min(*next, at) : at;
  }
  return next;
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
