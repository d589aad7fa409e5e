#pragma once
#include <vector>

#include "core/ids.hpp"
#include "core/scene/scene.hpp"

namespace peerd {

// The nodes with `enslaved TRUE` (the thesis, C.5), ascending. All peers have one file, so it says that the founder of
// the session owns them.
struct FounderObjects {
  std::vector<ObjectId> owned;
  // These have no owner by the file. A ROUTE moves the first, the same on all peers, and would not while somebody owns
  // them. The second change their shape, so that no rigid motion is theirs (Carriers::distorted).
  std::vector<ObjectId> routed, distorted;
};
[[nodiscard]] FounderObjects founder_objects(const Scene& scene);

}  // namespace peerd
