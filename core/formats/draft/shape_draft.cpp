#include "core/formats/draft/shape_draft.hpp"

#include <utility>

#include "core/formats/draft/node_draft.hpp"

namespace peerd::formats {

using vrml::NodeRef;

NodeRef add_appearance(vrml::Document& document, vrml::Position at, const MaterialDraft& material, NodeRef image) {
  NodeDraft node(document, "Material", at);
  node.floats("diffuseColor", material.diffuse).floats("emissiveColor", material.emissive);
  node.floats("specularColor", material.specular).floats("shininess", {material.shininess});
  if (material.transparency > 0.0F) node.floats("transparency", {material.transparency});
  const NodeRef made = node.add();
  return NodeDraft(document, "Appearance", at).node("material", made).node("texture", image).add();
}

NodeRef add_image(vrml::Document& document, vrml::Position at, std::string_view url, bool repeat_s, bool repeat_t) {
  NodeDraft image(document, "ImageTexture", at);
  image.string("url", url);
  if (!repeat_s) image.flag("repeatS", false);
  if (!repeat_t) image.flag("repeatT", false);
  return image.add();
}

NodeRef add_shape(vrml::Document& document, vrml::Position at, ShapeDraft&& draft) {
  const auto array_node = [&](std::string_view type, std::string_view field, std::vector<float>&& values) {
    return values.empty() ? NodeRef{} : NodeDraft(document, type, at).floats(field, std::move(values)).add();
  };
  const NodeRef coordinate = array_node("Coordinate", "point", std::move(draft.points));
  const NodeRef color = array_node("Color", "color", std::move(draft.colors));
  const bool has_faces = !draft.polygons.empty(), has_lines = !has_faces && !draft.lines.empty();
  const NodeRef normal = has_faces ? array_node("Normal", "vector", std::move(draft.normals)) : NodeRef{};
  const NodeRef texture =
      has_faces ? array_node("TextureCoordinate", "point", std::move(draft.texture_points)) : NodeRef{};
  NodeDraft geometry(document, has_faces ? "IndexedFaceSet" : has_lines ? "IndexedLineSet" : "PointSet", at);
  geometry.node("coord", coordinate).node("color", color);
  if (has_faces) {
    geometry.integers("coordIndex", std::move(draft.polygons)).node("normal", normal).node("texCoord", texture);
    if (!draft.solid) geometry.flag("solid", false);
    if (!draft.normal_index.empty()) geometry.integers("normalIndex", std::move(draft.normal_index));
    if (!draft.texture_index.empty()) geometry.integers("texCoordIndex", std::move(draft.texture_index));
  } else if (has_lines) {
    geometry.integers("coordIndex", std::move(draft.lines));
  }
  if (color.is_node() && !draft.color_per_vertex) geometry.flag("colorPerVertex", false);
  const NodeRef made = geometry.add();
  return NodeDraft(document, "Shape", at).node("appearance", draft.appearance).node("geometry", made).add();
}

NodeRef add_transform(vrml::Document& document, vrml::Position at, std::string_view name,
                      const std::vector<NodeRef>& children) {
  return NodeDraft(document, "Transform", at).named(name).nodes("children", children).add();
}

}  // namespace peerd::formats
