#pragma once
#include <string>

#include "core/scene/scene.hpp"

namespace peerd {

// The first thing in which `copy` is not the world that `original` is, for people; empty where nothing differs: the
// instances with their places, whether they collide, transforms bit for bit and geometries; all fields of all nodes
// that are reached, bit for bit; which nodes are shared; names; ROUTEs; CollisionInterests and KeySensors, by what they
// name. What writing a world as one text changes is no difference (core/writer/writer.hpp): a Group for an Inline that
// was read, a name for a node without one, NAME_2 for a name inside of a PROTO or an Inline or one that another node
// has too, the order of ROUTEs and of what stands beside the scene, the words of a path.
[[nodiscard]] std::string difference(const Scene& original, const Scene& copy);

}  // namespace peerd
