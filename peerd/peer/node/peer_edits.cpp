#include "peerd/peer/node/peer_edits.hpp"

#include <algorithm>
#include <cassert>
#include <utility>
#include <variant>

#include <spdlog/fmt/fmt.h>

namespace peerd {
namespace {

// An entry of Settled: the kind in the low bits.
constexpr std::uint8_t kKind = 0x0F, kKnown = 0x10, kApplied = 0x20, kHeld = 0x40, kStored = 0x80;
static_assert(static_cast<std::uint8_t>(config::SceneEdit::Kind::kRedo) <= kKind, "the last kind has a place");

}  // namespace

void PeerEdits::Settled::add(replication::OperationId id, const OperationState& state) {
  if (author_ == replication::kNoAuthor) {
    author_ = id.author;
    first_ = id.number;
  }
  assert(id.author == author_ && id.number >= first_ + entries_.size());
  entries_.resize(id.number - first_ + 1);
  entries_.back() =
      static_cast<std::uint8_t>(static_cast<std::uint8_t>(state.edit.kind) | kKnown | (state.applied ? kApplied : 0) |
                                (state.held ? kHeld : 0) | (state.stored ? kStored : 0));
  if (!state.refused.empty()) refused_[id.number] = state.refused;
}

std::uint8_t* PeerEdits::Settled::entry(replication::OperationId id) {
  const bool is_in = id.author == author_ && id.number >= first_ && id.number - first_ < entries_.size();
  return is_in && entries_[id.number - first_] != 0 ? &entries_[id.number - first_] : nullptr;
}

std::optional<OperationState> PeerEdits::Settled::find(replication::OperationId id) const {
  const bool is_in = id.author == author_ && id.number >= first_ && id.number - first_ < entries_.size();
  const std::uint8_t entry = is_in ? entries_[id.number - first_] : std::uint8_t{0};
  if (entry == 0) return std::nullopt;
  OperationState state;
  state.edit.kind = static_cast<config::SceneEdit::Kind>(entry & kKind);
  state.edit.path = fmt::format("(operation {}:{})", id.author.value, id.number);
  state.applied = (entry & kApplied) != 0;
  state.held = (entry & kHeld) != 0;
  state.stored = (entry & kStored) != 0;
  if (const auto why = refused_.find(id.number); why != refused_.end()) state.refused = why->second;
  return state;
}

void PeerEdits::Settled::note_held(replication::OperationId id) {
  if (std::uint8_t* const at = entry(id)) *at |= kHeld;
}

void PeerEdits::Settled::note_stored(replication::OperationId last) {
  if (last.author != author_ || last.number < first_) return;
  for (std::size_t after = std::min<std::size_t>(last.number - first_ + 1, entries_.size()); after > 0;) {
    std::uint8_t& at = entries_[--after];
    if ((at & kStored) != 0) return;
    if (at != 0) at |= kStored;
  }
}

std::optional<OperationState> PeerEdits::Settled::note_edited(replication::OperationId id, const std::string& refused) {
  std::uint8_t* const at = entry(id);
  if (at == nullptr) return std::nullopt;
  *at |= kApplied;
  if (refused.empty()) {
    refused_.erase(id.number);
  } else {
    refused_[id.number] = refused;
  }
  return find(id);
}

void PeerEdits::note(const EditReport& report) {
  if (report.operation) {
    operations_[*report.operation].edit = report.edit;
    forget_old_ones();
  }
  reports_.push_back(report);
}

// They are over where they have taken effect, or do not; a request that is not answered is neither.
void PeerEdits::forget_old_ones() {
  while (operations_.size() > kRecentMax) {
    const auto& [id, state] = *operations_.begin();
    const bool is_over = (state.applied || !state.refused.empty()) && std::ranges::find(asking_, id) == asking_.end();
    if (!is_over) return;
    settled_.add(id, state);
    operations_.erase(operations_.begin());
  }
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
    if (own == operations_.end()) {
      const auto settled = settled_.note_edited(edited->operation, edited->refused);
      if (settled && !edited->refused.empty()) reports_.push_back({settled->edit, edited->operation, edited->refused});
      return;
    }
    OperationState& state = own->second;
    if (!state.asks_until) state.applied = true;
    if (!edited->refused.empty()) {
      refuse(state, edited->operation, edited->refused);
    } else if (!state.asks_until) {
      state.refused.clear();
    }
  } else if (const auto* held = std::get_if<replication::OperationHeld>(&output)) {
    if (const auto own = operations_.find(held->operation); own != operations_.end()) own->second.held = true;
    settled_.note_held(held->operation);
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
  settled_.note_stored(last);
}

std::optional<OperationState> PeerEdits::find(replication::OperationId id) const {
  const auto known = operations_.find(id);
  return known == operations_.end() ? settled_.find(id) : known->second;
}

std::optional<EditReport> PeerEdits::poll() {
  if (reports_.empty()) return std::nullopt;
  EditReport report = std::move(reports_.front());
  reports_.pop_front();
  return report;
}

}  // namespace peerd
