#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "peerd/peer/config/scene_edit.hpp"
#include "peerd/peer/node/edit_operation.hpp"
#include "replication/settings/output/output.hpp"
#include "replication/wire/operation.hpp"

namespace peerd {

// An OperationState says what has become of an operation of this peer so far.
struct OperationState {
  config::SceneEdit edit;
  bool applied = false;                  // it has taken effect
  bool held = false;                     // another peer has it
  bool stored = false;                   // this peer's store has it
  std::string refused;                   // why it changes nothing, where it does not
  std::optional<ObjectId> object{};      // whose owner it changes; none: it changes the scene
  std::optional<HostTime> asks_until{};  // another peer owns that: when this one gives up; none: it is not asked
};

// The edits of a peer: those that its settings make at their times, and what has become of all. Of what was asked for
// long ago and is over it remembers the kind and the outcome, in a byte.
class PeerEdits {
 public:
  // The last operations of which all is known.
  static constexpr std::size_t kRecentMax = 256;

  explicit PeerEdits(std::vector<config::ScriptedEdit> scripted) : scripted_(std::move(scripted)) {}

  // The time of the next edit of the settings [s, after the start]; none: there is none left.
  [[nodiscard]] std::optional<double> next_at_s() const {
    return next_ < scripted_.size() ? std::optional(scripted_[next_].at_s) : std::nullopt;
  }
  [[nodiscard]] config::SceneEdit take_next() { return scripted_[next_++].edit; }

  void note(const EditReport& report);
  // An edit has become an operation on the owner of the object. `asks_until`: it asks another peer, and is over when
  // that answers, or has not by then.
  void note(const EditReport& report, ObjectId object, std::optional<HostTime> asks_until);
  // `self`: this peer.
  void note(const replication::Output& output, PeerId self);
  // Gives up what has not been answered.
  void give_up(HostTime now);
  // Whether this peer has grabbed the object, and gives it to nobody who asks.
  [[nodiscard]] bool holds(ObjectId object) const { return held_.contains(object); }
  // The requests of others that have come since the last call.
  [[nodiscard]] std::vector<replication::ObjectRequested> take_requests() { return std::exchange(requests_, {}); }
  // This peer's store has that operation, and all before it.
  void note_stored(replication::OperationId last);
  // None: this peer has made no such operation.
  [[nodiscard]] std::optional<OperationState> find(replication::OperationId id) const;
  // The next edit that was asked for, or that was found to change nothing.
  [[nodiscard]] std::optional<EditReport> poll();

 private:
  // The operations of one author that are over and not recent, by their numbers.
  class Settled {
   public:
    void add(replication::OperationId id, const OperationState& state);
    [[nodiscard]] std::optional<OperationState> find(replication::OperationId id) const;
    // Notes what has become of it since; ignores what is not here.
    void note_held(replication::OperationId id);
    void note_stored(replication::OperationId last);  // and all before it
    // The operation that changes nothing from now on, or, by an empty sentence, does again; none: it is not here.
    [[nodiscard]] std::optional<OperationState> note_edited(replication::OperationId id, const std::string& refused);

   private:
    [[nodiscard]] std::uint8_t* entry(replication::OperationId id);

    replication::AuthorId author_{replication::kNoAuthor};
    std::uint32_t first_ = 0;
    std::vector<std::uint8_t> entries_;  // from the first on: the kind and what has become of it; 0: not here
    std::map<std::uint32_t, std::string> refused_;  // why these change nothing
  };

  void forget_old_ones();
  void refuse(OperationState& state, replication::OperationId id, std::string why);
  void note_given(const replication::ObjectGiven& given, PeerId self);

  std::vector<config::ScriptedEdit> scripted_;  // by time
  std::size_t next_ = 0;
  std::deque<EditReport> reports_;
  std::map<replication::OperationId, OperationState> operations_;  // those that go on, and recent ones
  Settled settled_;
  std::vector<replication::OperationId> asking_;  // those of them that are not answered yet
  std::set<ObjectId> held_;
  std::vector<replication::ObjectRequested> requests_;
};

}  // namespace peerd
