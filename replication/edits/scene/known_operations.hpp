#pragma once
#include <cstdint>
#include <map>
#include <vector>

#include "replication/edits/scene/known_steps.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::replication {

// The operations that authors knew of each other when they made theirs, as these say it (Operation::knows). Of two that
// did not know each other's operation, neither meant to overwrite what the other one has done.
class KnownOperations {
 public:
  // The operations of each author come in the order of its log.
  void add(const Operation& operation);
  // Whether the author of the one knew the other when it made it.
  [[nodiscard]] bool knew(OperationId operation, OperationId other) const;
  // The knowledge that the next operation of that author is to say, at most kKnowsMax entries, where this peer is its
  // author.
  [[nodiscard]] std::vector<OperationId> news_for(AuthorId author) const;

 private:
  std::map<AuthorId, std::map<AuthorId, KnownSteps>> said_;
  std::map<AuthorId, std::uint32_t> last_;
};

}  // namespace peerd::replication
