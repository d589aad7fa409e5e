#pragma once
#include <cstdint>
#include <vector>

#include "core/ids.hpp"
#include "core/time.hpp"
#include "replication/objects/replica/own_objects.hpp"
#include "replication/session/membership.hpp"
#include "replication/settings/output/peer_counters.hpp"
#include "replication/settings/policy/peer_config.hpp"
#include "replication/wire/record.hpp"

namespace peerd::replication {

// Second copies of updates against loss: copies that follow an update at once, tick by tick, where its loss would cost
// more than its bytes; and repetitions with hellos of an update that nothing newer has replaced, as long as a peer may
// not have it.
class UpdateRepeater {
 public:
  // All arguments outlive this object. `acknowledged`: updates are acknowledged; those to regions are not.
  UpdateRepeater(const PeerConfig& config, const Membership& members, OwnObjects& own, bool acknowledged,
                 PeerCounters& counters);

  // Whether every member is known to have the object's last update.
  [[nodiscard]] bool is_acknowledged_by_all(const OwnObject& own) const;

  // A newer update of the object than its last one is about to go out at t.
  void before_update(OwnObject& own, SimTime t) const;
  // The record has just been made: it is the one to copy and to repeat.
  void on_update(ObjectId object, OwnObject& own, const UpdateRecord& record);
  // An update went to all with the datagram of that number.
  void note_sent(const UpdateRecord& record, std::uint32_t number);

  // At a tick: appends the copies that are due.
  void copy(std::vector<EncodedUpdate>& copies_due);
  // The caller calls it with each hello: it appends the repetitions that are due, except of objects that `updates_due`
  // has already.
  void repeat(HostTime now, SimTime session_now, std::vector<EncodedUpdate>& updates_due);

 private:
  void copy_later(ObjectId object, OwnObject& own);
  [[nodiscard]] bool is_lost(const OwnObject& own) const;

  const PeerConfig& config_;
  const Membership& members_;
  OwnObjects& own_;
  bool acknowledged_;
  PeerCounters& counters_;
  std::vector<ObjectId> copying_;    // own objects whose last update may have to be copied once more
  std::uint32_t copies_wanted_ = 1;  // the most that the loss of the last tick asked for
};

}  // namespace peerd::replication
