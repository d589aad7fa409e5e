#include "core/motion/founder_objects.hpp"

#include <cstdint>

#include "core/motion/carriers.hpp"
#include "core/motion/predefined_motion.hpp"

namespace peerd {

FounderObjects founder_objects(const Scene& scene) {
  std::vector<ObjectId> marked;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    if (scene.object({i}).enslaved) marked.push_back({i});
  }
  FounderObjects found;
  if (marked.empty()) return found;
  const PredefinedMotion motion(scene);
  const Carriers carriers(scene, motion, {});
  for (const ObjectId id : marked) {
    if (carriers.distorted(id)) {
      found.distorted.push_back(id);
    } else if (motion.fields_of(id).empty()) {
      found.owned.push_back(id);
    } else {
      found.routed.push_back(id);
    }
  }
  return found;
}

}  // namespace peerd
