#pragma once
#include <cassert>
#include <functional>
#include <map>
#include <utility>

#include "core/time.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::replication {

// The place of an operation among all.
using OperationKey = std::pair<SimTime, OperationId>;

// OperationBodies has the bodies of operations from the logs of a peer, which so are the only place that has them; or
// keeps them itself.
class OperationBodies {
 public:
  using Read = std::function<OperationBody(OperationId)>;

  OperationBodies() = default;
  // Somebody else has each of them from before keep() on, and reads it where it is needed.
  explicit OperationBodies(Read read) : read_(std::move(read)) { assert(read_); }

  void keep(const OperationKey& key, OperationBody body) {
    if (!read_) kept_.emplace(key, std::move(body));
  }
  [[nodiscard]] OperationBody operator()(const OperationKey& key) const {
    return read_ ? read_(key.second) : kept_.at(key);
  }

 private:
  Read read_;
  std::map<OperationKey, OperationBody> kept_;
};

}  // namespace peerd::replication
