#pragma once
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "replication/edits/log/operation_log.hpp"
#include "replication/edits/scene/conflicts.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::chaos {

// All operations of a run, from whichever peer has them first. All peers have the same bytes of each log, which the
// oracle checks.
class OperationBook {
 public:
  // Reads what these logs have more of that author than was read before. Where they have other bytes, what was read is
  // forgotten: it was lost with its author, who has begun anew since.
  void follow(const replication::OperationLogs& logs, replication::AuthorId author);
  // Forgets what that author has beyond these logs.
  void cut(const replication::OperationLogs& logs, replication::AuthorId author);

  // Null: no peer has had it.
  [[nodiscard]] const replication::Operation* find(replication::OperationId id) const;
  [[nodiscard]] const std::map<replication::OperationId, replication::Operation>& operations() const {
    return operations_;
  }
  // The operations with stamps until then that their authors have undone until then, and not redone. `refused`: undos
  // that change nothing.
  [[nodiscard]] std::set<replication::OperationId> undone(
      SimTime until, const std::function<bool(replication::OperationId)>& refused = {}) const;

 private:
  void forget(replication::AuthorId author);

  std::map<replication::AuthorId, std::vector<std::byte>> read_;
  std::map<replication::OperationId, replication::Operation> operations_;
};

[[nodiscard]] inline replication::OperationKey key_of(const replication::Operation& operation) {
  return {operation.stamp, operation.id};
}

// An author and a number: 7:12.
[[nodiscard]] std::string name_of(replication::OperationId id);

}  // namespace peerd::chaos
