#pragma once
#include <expected>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "core/formats/draft/shape_draft.hpp"
#include "core/formats/gltf/buffers.hpp"

namespace peerd::formats::gltf {

// Returns a share of a screen's colour for a share of light, which glTF's colours are (sRGB, IEC 61966-2-1).
[[nodiscard]] float screen_share(double light);

// The Appearances of a glTF's materials, each made once.
class Materials {
 public:
  Materials(const tinygltf::Model& model, const Buffers& buffers, const std::vector<ImageSource>& images,
            Reading& reading)
      : model_(model), buffers_(buffers), images_(images), reading_(reading), made_(material_count()) {}

  // The Appearance of a primitive's material; -1 is the standard's own.
  [[nodiscard]] vrml::NodeRef appearance(int material);
  [[nodiscard]] bool is_double_sided(int material) const;
  [[nodiscard]] bool is_tinted(int material) const;    // its base colour is not white
  [[nodiscard]] bool has_texture(int material) const;  // one of base colours that can be shown
  [[nodiscard]] bool is_there(int material) const {
    return material >= -1 && material < static_cast<int>(material_count());
  }

 private:
  [[nodiscard]] std::size_t material_count() const;
  void name_what_is_not_shown(int material);
  [[nodiscard]] vrml::NodeRef image_of(int texture);
  [[nodiscard]] std::expected<std::string, std::string> url_of(const ImageSource& image);

  const tinygltf::Model& model_;
  const Buffers& buffers_;
  const std::vector<ImageSource>& images_;
  Reading& reading_;
  std::vector<vrml::NodeRef> made_;
  vrml::NodeRef usual_;
  // The keys are an image's bufferView, its URI, and whether it repeats along s and along t. Materials share images,
  // which are large.
  std::map<std::tuple<int, std::string_view, bool, bool>, vrml::NodeRef> shown_;
};

}  // namespace peerd::formats::gltf
