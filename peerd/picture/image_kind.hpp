#pragma once
#include <expected>
#include <string>
#include <string_view>

#include "peerd/picture/drawn_scene.hpp"

namespace peerd::picture {

// Says what an image is, by its first bytes: PNG or JPEG, with or without colours and transparent parts. The error says
// in a few words why it is none that glTF takes.
[[nodiscard]] std::expected<DrawnImage, std::string> image_of(std::string bytes);

}  // namespace peerd::picture
