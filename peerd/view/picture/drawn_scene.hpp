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
#include "peerd/view/picks/page_sensor.hpp"

namespace peerd::view {

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
  std::vector<std::uint32_t> points;   // of each vertex, of a form that moves: which point of the Coordinate it is
  std::vector<std::uint32_t> corners;  // into the arrays
  std::optional<std::uint32_t> form;   // it moves: its number among view::MovingForms::geometries
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

// The numbers of the looks (view::DrivenLooks) that a Material's fields take while the world runs.
struct DrivenMaterial {
  std::optional<std::uint32_t> color, emissive, transparency;
  friend auto operator<=>(const DrivenMaterial&, const DrivenMaterial&) = default;
};

struct DrawnMaterial {
  Color diffuse = {0.8F, 0.8F, 0.8F};
  Color emissive = {0, 0, 0};
  float shininess = 0.2F;
  float transparency = 0;
  bool lit = true;  // false: its colour is `emissive`, or that of the vertices, whatever shines on it
  bool double_sided = false;
  std::optional<DrawnTexture> texture;
  DrivenMaterial driven;
  friend auto operator<=>(const DrawnMaterial&, const DrawnMaterial&) = default;
};

struct DrawnMesh {
  std::uint32_t geometry = 0;  // into ScenePicture::geometries
  std::uint32_t material = 0;  // into ScenePicture::materials
  friend auto operator<=>(const DrawnMesh&, const DrawnMesh&) = default;
};

// A Text with its FontStyle (ISO/IEC 14772-1, 6.47 and 6.20). The viewer has the fonts.
struct DrawnText {
  std::vector<std::string> lines, families, justify;
  std::string style;
  std::vector<float> lengths_m;  // of the lines; 0, or too few: as long as they are
  float max_extent_m = 0;        // 0: any
  float size_m = 1, spacing = 1;
  bool horizontal = true, left_to_right = true, top_to_bottom = true;
  DrawnMaterial material;  // without a texture
};

struct DrawnShape {
  static constexpr std::uint32_t kNoMesh = ~0U;

  ObjectId id;
  std::uint32_t node = 0;  // into ScenePicture::nodes
  std::uint32_t mesh = 0;  // into ScenePicture::meshes; kNoMesh: it has a text
  Eigen::Affine3d node_from_shape = Eigen::Affine3d::Identity();
  std::optional<std::uint32_t> group{};  // the innermost, into ScenePicture::groups
  std::optional<std::uint32_t> form{};   // its place changes: its number among view::MovingForms::shapes
  std::optional<std::uint32_t> text{};   // into ScenePicture::texts
};

// A node that the viewer has to do something about, with the Shapes below it.
struct DrawnGroup {
  enum class Kind : std::uint8_t {
    kLevel,      // of an LOD, shown by the distance of the camera
    kBillboard,  // it turns towards the camera
    kAnchor
  };

  Kind kind = Kind::kLevel;
  ObjectId id{};
  std::uint32_t node = 0;                // it moves with that one
  std::optional<std::uint32_t> above{};  // the next one outwards, into ScenePicture::groups
  Eigen::Affine3d node_from_group = Eigen::Affine3d::Identity();
  std::uint32_t number = 0, count = 1;               // of the levels
  Eigen::Vector3f center = Eigen::Vector3f::Zero();  // of the LOD
  std::vector<float> ranges_m{};                     // of the LOD
  Eigen::Vector3f axis = Eigen::Vector3f::UnitY();   // of the Billboard; zero: none
  std::vector<std::string> urls{};                   // of the Anchor
  std::string description{};                         // of the Anchor
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
  bool on = true;
  std::optional<std::uint32_t> driven_on{}, driven_color{}, driven_intensity{};  // among view::DrivenLooks
};

// A sensor that a page works, where it stands, and what moves while it is dragged.
struct DrawnSensor {
  // A Transform that stands in its node, and whose translation or rotation a ROUTE from the sensor sets. With a value
  // `to` it is drawn at F D F^-1 of where it is: F is node_from_frame, D the motion from `from` to `to`.
  struct Preview {
    std::uint32_t target = 0;                                       // into PageSensor::targets
    std::string path;                                               // what is at it and below it moves
    std::uint32_t node = 0;                                         // it moves with that one
    Eigen::Affine3d node_from_frame = Eigen::Affine3d::Identity();  // about what it turns is at the frame's origin
    std::vector<float> from;                                        // the field's value now
  };

  view::PageSensor what;
  std::uint32_t node = 0;  // it moves with that one
  Eigen::Affine3d node_from_sensor = Eigen::Affine3d::Identity();
  std::vector<Preview> previews;
};

struct DrawnViewpoint {
  std::string def;  // by which an Anchor finds it
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

// All nodes of the world, as node_tree() has them, drawn or not.
struct DrawnTree {
  struct Row {
    std::uint32_t depth = 0;
    std::string type, name, def;  // `def` may be empty
  };
  std::vector<Row> rows;
  std::size_t left_out = 0;
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
  std::vector<DrawnText> texts;
  std::vector<DrawnGroup> groups;  // each behind those above it
  std::vector<DrawnSensor> sensors;
  std::vector<DrawnLight> lights;
  std::vector<DrawnViewpoint> viewpoints;     // the first one is bound at first
  std::optional<DrawnBackground> background;  // of each kind the one that is bound at first; none: the standard's
  std::optional<DrawnFog> fog;
  std::optional<Navigation> navigation;
  std::vector<Undrawn> undrawn;
  // The paths of the nodes, of the shapes and of the groups, and of the nodes in which sensors stand, by their order.
  std::vector<std::string> node_paths, shape_paths, group_paths, sensor_paths;
  std::vector<std::string> node_names;  // DEF names; may be empty
  DrawnTree tree;
};

}  // namespace peerd::view
