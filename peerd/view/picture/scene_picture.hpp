#pragma once
#include "peerd/view/frames/picture_input.hpp"
#include "peerd/view/picture/drawn_scene.hpp"

namespace peerd::view {

// Makes the picture: a pure function of the input, and of what its loader gives.
[[nodiscard]] ScenePicture picture_of(const PictureInput& input);

}  // namespace peerd::view
