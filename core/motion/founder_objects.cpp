#include "core/motion/founder_objects.hpp"

#include <cstdint>

#include "core/motion/carriers.hpp"
#include "core/motion/predefined_motion.hpp"

namespace peerd {

std::vector<ObjectId> founder_objects(const Scene& scene) {
  std::vector<ObjectId> marked;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
    const ObjectId id = scene.id_of(i);
    if (scene.object(id).enslaved) marked.push_back(id);
  }
  if (marked.empty()) return marked;
  const PredefinedMotion motion(scene);
  const Carriers carriers(scene, motion, {});
  std::erase_if(marked, [&](ObjectId id) { return carriers.distorted(id) || !motion.fields_of(id).empty(); });
  return marked;
}

}  // namespace peerd
