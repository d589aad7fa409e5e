#include "peerd/node/peer_edits.hpp"

#include <algorithm>
#include <cassert>
#include <utility>
#include <variant>

namespace peerd {

void PeerEdits::note(const EditReport& report) {
  if (report.operation) operations_[*report.operation].edit = report.edit;
  reports_.push_back(report);
}

void PeerEdits::note(const EditReport& report, ObjectId object, std::optional<HostTime> asks_until) {
  assert(report.operation);
  note(report);
  OperationState& state = operations_.at(*report.operation);
  state.object = object;
  state.asks_until = asks_until;
  if (asks_until) asking_.push_back(*report.operation);
  if (report.edit.kind == config::SceneEdit::Kind::kGrab) held_.insert(object);
  if (report.edit.kind == config::SceneEdit::Kind::kRelease) held_.erase(object);
}

void PeerEdits::note(const replication::Output& output, PeerId self) {
  if (const auto* edited = std::get_if<replication::SceneEdited>(&output)) {
    const auto own = operations_.find(edited->operation);
    if (own == operations_.end()) return;
    OperationState& state = own->second;
    if (!state.asks_until) state.applied = true;
    if (!edited->refused.empty()) {
      refuse(state, edited->operation, edited->refused);
    } else if (!state.asks_until) {
      state.refused.clear();
    }
  } else if (const auto* held = std::get_if<replication::OperationHeld>(&output)) {
    if (const auto own = operations_.find(held->operation); own != operations_.end()) own->second.held = true;
  } else if (const auto* given = std::get_if<replication::ObjectGiven>(&output)) {
    note_given(*given, self);
  } else if (const auto* asked = std::get_if<replication::ObjectRequested>(&output)) {
    requests_.push_back(*asked);
  } else if (const auto* refused = std::get_if<replication::RequestRefused>(&output)) {
    const bool is_asking = std::ranges::find(asking_, refused->request) != asking_.end();
    if (is_asking) refuse(operations_.at(refused->request), refused->request, refused->reason);
  }
}

// An answer may also come after this peer has given up.
void PeerEdits::note_given(const replication::ObjectGiven& given, PeerId self) {
  if (given.owner != self) {
    held_.erase(given.object);
    const char* const why = given.owner == kNobody ? "its owner has released it" : "another peer has it";
    for (const auto id : std::vector(asking_)) {
      if (OperationState& state = operations_.at(id); state.object == given.object) refuse(state, id, why);
    }
    return;
  }
  for (auto& [id, state] : operations_) {
    if (state.object != given.object || !state.asks_until || state.applied) continue;
    std::erase(asking_, id);
    state.applied = true;
    state.refused.clear();
    if (state.edit.kind == config::SceneEdit::Kind::kGrab) held_.insert(given.object);
  }
}

void PeerEdits::refuse(OperationState& state, replication::OperationId id, std::string why) {
  std::erase(asking_, id);
  if (state.edit.kind == config::SceneEdit::Kind::kGrab) held_.erase(*state.object);
  state.refused = std::move(why);
  reports_.push_back({state.edit, id, state.refused});
}

void PeerEdits::give_up(HostTime now) {
  for (const auto id : std::vector(asking_)) {
    OperationState& state = operations_.at(id);
    if (*state.asks_until <= now) refuse(state, id, "its owner has not answered");
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
