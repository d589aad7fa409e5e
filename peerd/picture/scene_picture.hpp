#pragma once
#include "peerd/picture/drawn_scene.hpp"
#include "peerd/picture/picture_input.hpp"

namespace peerd::picture {

// Makes the picture: a pure function of the input, and of what its loader gives.
[[nodiscard]] ScenePicture picture_of(const PictureInput& input);

}  // namespace peerd::picture
