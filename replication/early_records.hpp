#pragma once
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <variant>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::replication {

// A record of an instant that this peer's worlds have not reached. It waits until they do: a law that was laid before
// would make its object meet nothing on the rest of its old way, which the sender's ghosts have met.
struct EarlyRecord {
  SimTime at;  // the record's own instant
  PeerId sender;
  std::uint64_t incarnation = 0;                                   // of the sender
  std::uint32_t number = 0;                                        // of the datagram that carried it
  std::variant<UpdateRecord, SceneStates, DecisionRecord> record;  // of scene states a single one
};

// The records that wait. Those of one instant leave as those of one message would be taken: updates, scene states, then
// decisions; of one kind in the order in which they came.
class EarlyRecords {
 public:
  // The most of one sender: what a peer with a right clock sends in a tick is far less, and waits no longer.
  static constexpr std::size_t kOfSenderMax = 1024;

  // Returns false where too many of that sender wait: the record is not taken.
  [[nodiscard]] bool add(EarlyRecord record);
  // The first record that is not of an instant after t; none: there is no such record. It waits no more.
  [[nodiscard]] std::optional<EarlyRecord> take_until(SimTime t);
  void clear();

 private:
  std::multimap<std::pair<SimTime, std::size_t>, EarlyRecord> waiting_;  // by instant and kind
  std::map<PeerId, std::size_t> of_sender_;
};

}  // namespace peerd::replication
