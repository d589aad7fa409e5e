#pragma once
#include <chrono>
#include <optional>
#include <string>

#include "core/time.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/peer/store/operation_store.hpp"
#include "peerd/peer/store/unstored_growth.hpp"
#include "replication/edits/log/operation_log.hpp"

namespace peerd::store {

// Keeps the store of a peer that runs: what its logs grow by is added to it and waits, others' operations for
// kStoredWithin at most. This peer's own ones must be written before anything else of the peer leaves. Where the store
// can't be written, it is tried again kTriedAgainAfter, or with what follows sooner.
class StoreKeeper {
 public:
  static constexpr Duration kStoredWithin = std::chrono::milliseconds(100);
  static constexpr Duration kTriedAgainAfter = std::chrono::seconds(1);

  // Both outlive it. `logs`: what is added is in them.
  StoreKeeper(OperationStore& store, const replication::OperationLogs& logs) : store_(store), logs_(logs) {}

  // The logs have grown by whole operations.
  void add(const UnstoredGrowth::Growth& growth, HostTime now);
  // Something of this peer's own log waits.
  [[nodiscard]] bool must_write() const { return own_waits_; }
  // When write() is due; max(): nothing waits.
  [[nodiscard]] HostTime due() const { return due_; }
  [[nodiscard]] const UnstoredGrowth& unstored() const { return unstored_; }

  struct Written {
    std::optional<replication::OperationId> own;  // this peer's last operation that the store has got by this
    std::optional<InputError> error;              // why something waits still
    bool begins_to_fail = false;                  // it did not before
    bool is_good_again = false;                   // it failed before, and has all now
    std::string begins_not_to_pack;               // why the store takes more room than it needs; empty: as before
    bool must_stop = false;                       // what this peer publishes from now on, it could contradict later
  };
  // Writes all that waits.
  [[nodiscard]] Written write(HostTime now);

 private:
  OperationStore& store_;
  const replication::OperationLogs& logs_;
  UnstoredGrowth unstored_;
  HostTime due_ = HostTime::max();
  bool own_waits_ = false, fails_ = false, packs_ = true;
};

}  // namespace peerd::store
