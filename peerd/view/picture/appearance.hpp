#pragma once
#include <cstdint>
#include <expected>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/vrml/document.hpp"
#include "peerd/view/frames/driven_looks.hpp"
#include "peerd/view/frames/picture_input.hpp"
#include "peerd/view/picture/drawn_geometry.hpp"
#include "peerd/view/picture/drawn_scene.hpp"

namespace peerd::view {

// The images of a picture, each once.
class Images {
 public:
  static constexpr std::size_t kAll_bytes = std::size_t{64} << 20;

  explicit Images(const ImageLoader& load) : load_(load) {}
  // The image behind the first of the URLs that can be read, by index; the error says why there is none.
  [[nodiscard]] std::expected<std::uint32_t, std::string> find(std::span<const std::string_view> urls);
  // The image of a PixelTexture.
  [[nodiscard]] std::expected<std::uint32_t, std::string> find_pixels(std::span<const std::int32_t> image);
  [[nodiscard]] const DrawnImage& at(std::uint32_t image) const { return all_[image]; }
  [[nodiscard]] std::vector<DrawnImage> take() { return std::move(all_); }

 private:
  [[nodiscard]] std::expected<std::uint32_t, std::string> read(std::string_view url);
  [[nodiscard]] std::expected<std::uint32_t, std::string> keep(std::string bytes);

  const ImageLoader& load_;
  std::vector<DrawnImage> all_;
  std::size_t bytes_ = 0;
  std::map<std::string, std::expected<std::uint32_t, std::string>, std::less<>> known_;    // by URL
  std::map<const std::int32_t*, std::expected<std::uint32_t, std::string>> known_pixels_;  // by where they are
};

// How a Shape is painted.
struct Paint {
  DrawnMaterial material;
  std::optional<TextureMap> texture;    // there where the material has a texture
  std::vector<std::string> left_out{};  // a few words each
};

// Reads the appearance of a Shape, whose geometry has that mode: of surfaces, `lit` where there is a Material; lines
// and points shine by themselves. `colored`: the geometry brings its own colours.
// `looks`: which fields of a Material change as the world runs; null: none.
[[nodiscard]] Paint paint_of(const vrml::Document& document, const vrml::Node& shape, bool is_surface, bool colored,
                             Images& images, const view::DrivenLooks* looks = nullptr);

}  // namespace peerd::view
