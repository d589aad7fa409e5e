#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "core/ids.hpp"
#include "core/motion/key_codes.hpp"
#include "peerd/lab/chaos/plan.hpp"
#include "peerd/peer/config/scene_edit.hpp"

namespace peerd {
struct Scene;
}
namespace peerd::replication {
class Owners;
}

namespace peerd::chaos {

// What a peer has before it when it edits.
struct EditView {
  const Scene& scene;
  const replication::Owners& owners;
  PeerId self = kNobody;
  std::vector<ObjectId> locked{};
};

// The edits that a planned one means for what its peer sees: a function of the two.
[[nodiscard]] std::vector<config::SceneEdit> make_edits(const PlannedEdit& planned, const EditView& view);
// The key that is pressed with it; none with most.
[[nodiscard]] std::optional<KeyEvent> make_key(const PlannedEdit& planned, const EditView& view);

}  // namespace peerd::chaos
