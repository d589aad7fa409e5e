#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/formats/draft/reading.hpp"

namespace peerd::formats {

// A material as VRML97's Material says it, and the image on it.
struct MaterialDraft {
  std::array<float, 3> diffuse{0.8F, 0.8F, 0.8F}, emissive{}, specular{};
  float shininess = 0.2F, transparency = 0.0F;
  std::string texture;  // URL of an image; empty where there is none
};
// Adds an Appearance with the material and the node of its image, which may be none.
[[nodiscard]] vrml::NodeRef add_appearance(vrml::Document& document, vrml::Position at, const MaterialDraft& material,
                                           vrml::NodeRef image);

// Adds an ImageTexture. `url` is usually the whole image, so that materials with the same one share the node.
[[nodiscard]] vrml::NodeRef add_image(vrml::Document& document, vrml::Position at, std::string_view url,
                                      bool repeat_s = true, bool repeat_t = true);

// The polygons, lines or points of one Shape. The lists are those of IndexedFaceSet, IndexedLineSet and PointSet, which
// say what they mean.
struct ShapeDraft {
  std::vector<float> points;                  // three a point [m]
  std::vector<std::int32_t> polygons, lines;  // indices of points; -1 ends a polygon or a line
  std::vector<float> colors;                  // three a point, or a polygon
  bool color_per_vertex = true;
  bool solid = false;                                     // only the fronts of polygons are seen
  std::vector<float> normals, texture_points;             // three, or two, an entry
  std::vector<std::int32_t> normal_index, texture_index;  // empty: the points' indices are meant
  vrml::NodeRef appearance;                               // may be none
};

// Adds the Shape; what it takes is moved out of the draft. A draft with polygons is an IndexedFaceSet, one with lines
// an IndexedLineSet, one with points alone a PointSet.
[[nodiscard]] vrml::NodeRef add_shape(vrml::Document& document, vrml::Position at, ShapeDraft&& draft);

// Adds a Transform of that name (none where it is empty) around the children.
[[nodiscard]] vrml::NodeRef add_transform(vrml::Document& document, vrml::Position at, std::string_view name,
                                          const std::vector<vrml::NodeRef>& children);

}  // namespace peerd::formats
