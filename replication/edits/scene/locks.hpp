#pragma once
#include <cstddef>
#include <map>
#include <string>

#include "core/ids.hpp"
#include "replication/wire/operation.hpp"

namespace peerd::replication {

// The objects that are locked, with all below them, each by the author who has done that.
using Locks = std::map<ObjectId, AuthorId>;

// A Lock keeps all but its writer from changing an object and what is below it.
struct Lock {
  ObjectId object;
  AuthorId author;
  std::string by;  // for people
};

// So many objects are locked at once at most, because each operation is checked against all of them.
inline constexpr std::size_t kLocksMax = 256;

}  // namespace peerd::replication
