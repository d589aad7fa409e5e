#pragma once
#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/geometry.hpp"
#include "core/vrml/document.hpp"
#include "peerd/view/picture/drawn_scene.hpp"

namespace peerd::view {

// A TextureTransform (ISO/IEC 14772-1, 6.49), as the map of texture coordinates that it means.
struct TextureMap {
  Eigen::Matrix2f linear = Eigen::Matrix2f::Identity();
  Eigen::Vector2f offset = Eigen::Vector2f::Zero();
  [[nodiscard]] Eigen::Vector2f operator*(const Eigen::Vector2f& at) const { return linear * at + offset; }
};

struct GeometryToDraw {
  const vrml::Document& document;
  const vrml::Node& node;  // the geometry node
  const Geometry& form;    // what has become of it
  const Tessellation& tessellation;
  std::optional<TextureMap> texture{};    // none: it needs no texture coordinates
  std::optional<std::uint32_t> moving{};  // its points move: DrawnGeometry::form
};

struct GeometryAsDrawn {
  DrawnGeometry geometry;               // without corners: there is nothing to draw
  std::vector<std::string> left_out{};  // a few words each
};

// The triangles, lines or points of a geometry node in the frame of its Shape: the polygons and the triangles that
// collide, with normals by `normal` or `creaseAngle`, colours and texture coordinates.
[[nodiscard]] GeometryAsDrawn draw(const GeometryToDraw& what);

}  // namespace peerd::view
