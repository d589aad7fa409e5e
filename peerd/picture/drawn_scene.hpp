#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/ids.hpp"
#include "core/math.hpp"

namespace peerd::picture {

// The types below say what a viewer draws of a world, as plain data. Lengths are in metres, angles in radians; colours
// are as the file has them (sRGB, 0 to 1).

using Color = std::array<float, 3>;

// Corners of triangles, lines or points with what belongs to each; arrays are empty or of one size.
struct DrawnGeometry {
  enum class Mode : std::uint8_t { kPoints = 0, kLines = 1, kTriangles = 4 };  // as in glTF

  Mode mode = Mode::kTriangles;
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;              // of triangles
  std::vector<Eigen::Vector2f> texture_coordinates;  // as in VRML: t runs upwards
  std::vector<Color> colors;
  std::vector<std::uint32_t> corners;  // into the arrays
};

struct DrawnImage {
  enum class Format : std::uint8_t { kPng, kJpeg };

  Format format = Format::kPng;
  std::string bytes;
  bool has_color = true;  // otherwise it is grey, and shades the colour of the material
  bool has_alpha = false;
};

struct DrawnTexture {
  std::uint32_t image = 0;  // into ScenePicture::images
  bool repeat_s = true, repeat_t = true;
  friend auto operator<=>(const DrawnTexture&, const DrawnTexture&) = default;
};

struct DrawnMaterial {
  Color diffuse = {0.8F, 0.8F, 0.8F};
  Color emissive = {0, 0, 0};
  float shininess = 0.2F;
  float transparency = 0;
  bool lit = true;  // false: its colour is `emissive`, or that of the vertices, whatever shines on it
  bool double_sided = false;
  std::optional<DrawnTexture> texture;
  friend auto operator<=>(const DrawnMaterial&, const DrawnMaterial&) = default;
};

struct DrawnMesh {
  std::uint32_t geometry = 0;  // into ScenePicture::geometries
  std::uint32_t material = 0;  // into ScenePicture::materials
  friend auto operator<=>(const DrawnMesh&, const DrawnMesh&) = default;
};

struct DrawnShape {
  ObjectId id;
  std::uint32_t node = 0;  // into ScenePicture::nodes
  std::uint32_t mesh = 0;  // into ScenePicture::meshes
  Eigen::Affine3d node_from_shape = Eigen::Affine3d::Identity();
};

struct DrawnNode {
  std::optional<ObjectId> id;  // none: all that stands
  Pose pose;
  PeerId owner = kNobody;
};

struct DrawnLight {
  enum class Kind : std::uint8_t { kDirectional, kPoint, kSpot };

  Kind kind = Kind::kDirectional;
  std::uint32_t node = 0;
  Pose node_from_light;  // it shines along -Z
  Color color = {1, 1, 1};
  float intensity = 1, ambient_intensity = 0;
  Eigen::Vector3f attenuation = {1, 0, 0};
  float radius_m = 100;
  float beam_width_rad = 1.570796F, cut_off_angle_rad = 0.785398F;
};

struct DrawnViewpoint {
  std::string description;
  std::uint32_t node = 0;  // it moves with that one
  Pose node_from_camera;   // it looks along -Z
  double field_of_view_rad = 0.785398;
};

struct DrawnBackground {
  std::vector<float> sky_angles_rad, ground_angles_rad;
  std::vector<Color> sky_colors, ground_colors;
};

struct DrawnFog {
  Color color = {1, 1, 1};
  bool exponential = false;
  float visibility_range_m = 0;  // 0: none
};

struct Navigation {
  std::vector<std::string> types;
  std::vector<float> avatar_size_m;
  float speed_m_s = 1;
  float visibility_limit_m = 0;  // 0: none
  bool headlight = true;
};

// A picture leaves this out, or draws it otherwise than the standard says.
struct Undrawn {
  std::string path;  // of the first such node
  std::string what, why;
  std::uint32_t count = 1;  // of such nodes
};

struct ScenePicture {
  std::string world;
  std::uint32_t revision = 1;
  std::vector<DrawnNode> nodes;  // one for each mover, by their order, and the last one for all that stands
  std::vector<DrawnShape> shapes;
  std::vector<DrawnMesh> meshes;
  std::vector<DrawnGeometry> geometries;
  std::vector<DrawnMaterial> materials;
  std::vector<DrawnImage> images;
  std::vector<DrawnLight> lights;
  std::vector<DrawnViewpoint> viewpoints;     // the first one is bound at first
  std::optional<DrawnBackground> background;  // of each kind the one that is bound at first; none: the standard's
  std::optional<DrawnFog> fog;
  std::optional<Navigation> navigation;
  std::vector<Undrawn> undrawn;
  // The paths of the nodes and of the shapes, by their order.
  std::vector<std::string> node_paths, shape_paths;
  std::vector<std::string> node_names;  // DEF names; may be empty
};

}  // namespace peerd::picture
