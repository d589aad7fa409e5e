#pragma once
#include <vector>

#include "core/ids.hpp"
#include "core/scene/scene.hpp"

namespace peerd {

// Returns the nodes with `enslaved TRUE` (the thesis, C.5) that the founder of the session owns, ascending: all peers
// have one file. Two kinds of marked nodes have no owner by the file: those that a ROUTE moves, the same on all peers,
// which it would not while somebody owns them; and those that change their shape, so that no rigid motion is theirs
// (Carriers::distorted).
[[nodiscard]] std::vector<ObjectId> founder_objects(const Scene& scene);

}  // namespace peerd
