#pragma once
#include <string>

#include "core/scene/scene.hpp"

namespace peerd {

// Describes the first difference between `copy` and the world `original`, for people; the text is empty where nothing
// differs. Compared are the instances with their places, whether they collide, transforms bit for bit and geometries;
// all fields of all nodes that are reached, bit for bit; sharing of nodes; names; ROUTEs; CollisionInterests and
// KeySensors, by the nodes that they name. Changes that writing a world as one text makes are no difference
// (core/writer/writer.hpp): a Group for an Inline that was read, a name for a node without one, NAME_2 for a name
// inside of a PROTO or an Inline or one that another node has too, the order of ROUTEs and of the nodes beside the
// scene, the words of a path.
[[nodiscard]] std::string difference(const Scene& original, const Scene& copy);

}  // namespace peerd
