#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "core/scene/scene.hpp"
#include "core/vrml/document.hpp"
#include "peerd/view/frames/driven_looks.hpp"
#include "peerd/view/frames/moving_forms.hpp"
#include "peerd/view/picture/appearance.hpp"
#include "peerd/view/picture/drawn_scene.hpp"
#include "peerd/view/picture/undrawn_list.hpp"

namespace peerd::view {

// The meshes of a picture: geometries, materials and images, each once however many Shapes have it, also where copies
// of a PROTO's body do.
class MeshMaker {
 public:
  // All outlive it.
  MeshMaker(const Scene& scene, const ImageLoader& load_image, const view::DrivenLooks& looks,
            const view::MovingForms& forms, UndrawnList& undrawn)
      : scene_(scene),
        document_(*scene.document),
        looks_(looks),
        forms_(forms),
        undrawn_(undrawn),
        images_(load_image) {}

  // The mesh of an instance that is a Shape, by index; none: there is nothing to draw.
  [[nodiscard]] std::optional<std::uint32_t> mesh_of(ObjectId shape);
  // The text of an instance that is a Shape with a Text, into ScenePicture::texts; none: it has none, or is empty.
  [[nodiscard]] std::optional<std::uint32_t> text_of(ObjectId shape);
  // Moves all that has been made into the picture.
  void finish(ScenePicture& picture);

 private:
  // A solid is known by its numbers. Any other geometry is known by where its values are, so that copies are one, and
  // by its form in the scene.
  using Content = std::vector<std::uint64_t>;
  struct GeometryKey {
    Content content;
    std::uint32_t form = 0;
    std::vector<float> texture{};  // the map; empty: none
    friend auto operator<=>(const GeometryKey&, const GeometryKey&) = default;
  };

  [[nodiscard]] std::optional<std::uint32_t> make(ObjectId shape);
  [[nodiscard]] std::optional<std::uint32_t> geometry_of(ObjectId shape, const vrml::Node& node,
                                                         const std::optional<TextureMap>& texture);
  void add_content(const vrml::Node& node, Content& content) const;
  [[nodiscard]] GeometryKey key_of(ObjectId shape, const vrml::Node& node) const;

  const Scene& scene_;
  const vrml::Document& document_;
  const view::DrivenLooks& looks_;
  const view::MovingForms& forms_;
  UndrawnList& undrawn_;
  Images images_;
  // The meshes by node of the Shape and form of its geometry.
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::optional<std::uint32_t>> of_node_;
  std::map<GeometryKey, std::optional<std::uint32_t>> known_geometries_;
  std::map<DrawnMaterial, std::uint32_t> known_materials_;
  std::map<DrawnMesh, std::uint32_t> known_meshes_;
  std::vector<DrawnGeometry> geometries_;
  std::map<std::uint32_t, std::optional<std::uint32_t>> text_of_node_;
  std::vector<DrawnText> texts_;
};

}  // namespace peerd::view
