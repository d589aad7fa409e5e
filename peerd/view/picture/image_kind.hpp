#pragma once
#include <cstdint>
#include <expected>
#include <span>
#include <string>
#include <string_view>

#include "peerd/view/picture/drawn_scene.hpp"

namespace peerd::view {

// Says what an image is, by its first bytes: PNG or JPEG, with or without colours and transparent parts. The error says
// in a few words why it is none that glTF takes.
[[nodiscard]] std::expected<DrawnImage, std::string> image_of(std::string bytes);

// The PNG of an SFImage (ISO/IEC 14772-1, 5.5): its width, its height, its components, and its pixels from the lower
// edge on. The error says in a few words why there is none.
[[nodiscard]] std::expected<std::string, std::string> png_of_pixels(std::span<const std::int32_t> image);

}  // namespace peerd::view
