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

// A record of an instant that this peer's worlds have not reached. It waits until they do: if its law were laid at
// once, the object would no longer be searched for contacts on its old way up to that instant, although the sender's
// ghost has had them.
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
  // The most of one sender, and of all. A peer whose clock is right sends far fewer within a tick, and none of them
  // waits longer than that.
  static constexpr std::size_t kOfSenderMax = 1024, kOfAllMax = 16'384;

  // Returns false where too many of that sender, or of all, wait: the record is not taken.
  [[nodiscard]] bool add(EarlyRecord record);
  // The first record that is not of an instant after t; none: there is no such record. It waits no more.
  [[nodiscard]] std::optional<EarlyRecord> take_until(SimTime t);
  void clear();

 private:
  std::multimap<std::pair<SimTime, std::size_t>, EarlyRecord> waiting_;  // by instant and kind
  std::map<PeerId, std::size_t> of_sender_;
};

}  // namespace peerd::replication
