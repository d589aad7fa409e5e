#pragma once
#include <vector>

#include "core/formats/gltf/accessors.hpp"

namespace peerd::formats::gltf {

// Adds the animations of a glTF, each with a TimeSensor that runs from the world's beginning and repeats, and an
// interpolator for each channel that one can do exactly: steps and straight lines of a translation, a rotation or a
// scale. All others are named. `transforms` are the Transforms of the nodes; none for nodes that are not in the scene.
bool add_animations(const tinygltf::Model& model, Accessors& accessors, const std::vector<vrml::NodeRef>& transforms,
                    Reading& reading);

}  // namespace peerd::formats::gltf
