#include "peerd/view/picture/gltf_writer.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>
#include <span>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "peerd/view/picks/node_place.hpp"
#include "peerd/view/picture/json_writer.hpp"

namespace peerd::view {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers go out as they are in memory");

// Numbers of glTF 2.0.
constexpr int kFloat = 5126, kShort = 5123, kInt = 5125;
constexpr int kVertices = 34962, kIndices = 34963;

// Full light makes a white surface white: a viewer divides by pi (Lambert).
constexpr double kFullLight = std::numbers::pi;

double linear(float srgb) {
  const double c = std::clamp(double{srgb}, 0.0, 1.0);
  return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}
// The result is binary32, so that the text is short.
std::array<float, 3> linear(const Color& color) {
  return {static_cast<float>(linear(color[0])), static_cast<float>(linear(color[1])),
          static_cast<float>(linear(color[2]))};
}

std::array<double, 3> components(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
std::array<double, 4> components(const Quat& q) { return {q.x(), q.y(), q.z(), q.w()}; }

// The first three rows of an affine map.
std::array<double, 12> rows_of(const Eigen::Affine3d& map) {
  std::array<double, 12> rows{};
  for (int k = 0; k < 12; ++k) rows[static_cast<std::size_t>(k)] = map.matrix()(k / 4, k % 4);
  return rows;
}

class GltfWriter {
 public:
  explicit GltfWriter(const ScenePicture& picture) : picture_(picture) {}

  std::expected<std::string, std::string> write();

 private:
  // The parts of the binary chunk. All arrays of one kind stand side by side in one buffer view.
  enum View : std::uint8_t { kPositions, kNormals, kTextureCoordinates, kColors, kPoints, kCorners, kViews };
  static constexpr std::array<int, kViews> kStride = {12, 12, 8, 12, 4, 0};

  struct Accessors {
    std::uint32_t position = 0;
    std::optional<std::uint32_t> normal, texture, color, point, corners;
  };

  void write_geometries();
  template <class T>
  std::uint32_t accessor(View view, std::span<const T> values, int component, const char* type, std::size_t count);
  void write_nodes();
  void write_shape(const DrawnShape& shape, const std::string& path);
  void write_text(const DrawnText& text);
  void write_driven(const DrivenMaterial& driven);
  void write_groups();
  void write_sensors();
  void write_tree();
  void write_light(std::size_t light);
  void place(const NodePlace& at);
  void write_meshes();
  void write_materials();
  void write_images();
  void write_lights();
  void write_extras();
  void write_views();
  void number_views();
  void append(const std::string& bytes);

  const ScenePicture& picture_;
  JsonWriter json_, accessors_;
  std::array<std::string, kViews> views_;
  std::array<std::size_t, kViews> view_number_{};  // of those that are used
  std::size_t view_count_ = 0;
  std::string binary_;
  std::uint32_t accessor_count_ = 0;
  std::vector<Accessors> of_geometry_;
};

template <class T>
std::uint32_t GltfWriter::accessor(View view, std::span<const T> values, int component, const char* type,
                                   std::size_t count) {
  std::string& bytes = views_[view];
  bytes.resize((bytes.size() + 3) / 4 * 4);
  const std::size_t offset = bytes.size();
  bytes.resize(offset + values.size_bytes());
  std::memcpy(bytes.data() + offset, std::as_bytes(values).data(), values.size_bytes());
  accessors_.open('{').member("bufferView", view_number_[view]).member("byteOffset", offset);
  accessors_.member("componentType", component).member("count", count).member("type", type);
  return accessor_count_++;
}

void GltfWriter::write_geometries() {
  accessors_.open('[');
  for (const DrawnGeometry& g : picture_.geometries) {
    Accessors& at = of_geometry_.emplace_back();
    assert(!g.positions.empty() && !g.corners.empty());
    at.position = accessor(kPositions, std::span(g.positions), kFloat, "VEC3", g.positions.size());
    Eigen::Vector3f lo = g.positions.front(), hi = lo;
    for (const Eigen::Vector3f& p : g.positions) {
      lo = lo.cwiseMin(p);
      hi = hi.cwiseMax(p);
    }
    accessors_.list("min", lo).list("max", hi).close('}');
    if (!g.normals.empty()) {
      at.normal = accessor(kNormals, std::span(g.normals), kFloat, "VEC3", g.normals.size());
      accessors_.close('}');
    }
    if (!g.texture_coordinates.empty()) {  // glTF counts from the upper edge
      std::vector<Eigen::Vector2f> flipped;
      for (const Eigen::Vector2f& t : g.texture_coordinates) flipped.emplace_back(t[0], 1.0F - t[1]);
      at.texture = accessor(kTextureCoordinates, std::span(std::as_const(flipped)), kFloat, "VEC2", flipped.size());
      accessors_.close('}');
    }
    if (!g.colors.empty()) {
      std::vector<std::array<float, 3>> colors;
      for (const Color& color : g.colors) colors.push_back(linear(color));
      at.color = accessor(kColors, std::span(std::as_const(colors)), kFloat, "VEC3", colors.size());
      accessors_.close('}');
    }
    if (!g.points.empty()) {  // glTF has no attributes of whole numbers that are this large
      const std::vector<float> points(g.points.begin(), g.points.end());
      at.point = accessor(kPoints, std::span(points), kFloat, "SCALAR", points.size());
      accessors_.close('}');
    }
    if (g.mode == DrawnGeometry::Mode::kPoints) continue;
    if (g.positions.size() < std::numeric_limits<std::uint16_t>::max()) {
      const std::vector<std::uint16_t> corners(g.corners.begin(), g.corners.end());
      at.corners = accessor(kCorners, std::span(corners), kShort, "SCALAR", corners.size());
    } else {
      at.corners = accessor(kCorners, std::span(g.corners), kInt, "SCALAR", g.corners.size());
    }
    accessors_.close('}');
  }
  accessors_.close(']');
}

void GltfWriter::place(const NodePlace& at) {
  if (!at.translation.isZero(0.0)) json_.list("translation", components(at.translation));
  if (at.rotation.coeffs() != Quat::Identity().coeffs()) json_.list("rotation", components(at.rotation));
  if (at.scale != Vec3::Ones()) json_.list("scale", at.scale);
}

// A sheared Shape is a node with a node below.
void GltfWriter::write_shape(const DrawnShape& shape, const std::string& path) {
  json_.open('{').key("extras").open('{');
  json_.member("id", std::to_string(shape.id.packed())).member("path", path);
  if (shape.group) json_.member("group", *shape.group);
  if (shape.form) json_.member("form", *shape.form);
  if (shape.text) {
    write_text(picture_.texts[*shape.text]);
    json_.list("node_from_shape", rows_of(shape.node_from_shape));
  }
  json_.close('}');
  place(place_of(shape.node_from_shape));
}

void GltfWriter::write_text(const DrawnText& text) {
  json_.key("text").open('{').list("lines", text.lines).list("family", text.families).member("style", text.style);
  json_.list("justify", text.justify).list("length_m", text.lengths_m).member("max_extent_m", text.max_extent_m);
  json_.member("size_m", text.size_m).member("spacing", text.spacing).member("horizontal", text.horizontal);
  json_.member("left_to_right", text.left_to_right).member("top_to_bottom", text.top_to_bottom);
  json_.list("color", text.material.diffuse).list("emissive", text.material.emissive);
  json_.member("transparency", text.material.transparency).member("lit", text.material.lit);
  write_driven(text.material.driven);
  json_.close('}');
}

void GltfWriter::write_driven(const DrivenMaterial& driven) {
  if (driven == DrivenMaterial{}) return;
  json_.key("driven").open('{');
  if (driven.color) json_.member("color", *driven.color);
  if (driven.emissive) json_.member("emissive", *driven.emissive);
  if (driven.transparency) json_.member("transparency", *driven.transparency);
  json_.close('}');
}

void GltfWriter::write_groups() {
  json_.key("groups").open('[');
  for (std::size_t i = 0; i < picture_.groups.size(); ++i) {
    using enum DrawnGroup::Kind;
    const DrawnGroup& g = picture_.groups[i];
    json_.open('{').member("path", picture_.group_paths[i]).member("node", g.node);
    if (g.above) json_.member("above", *g.above);
    json_.list("node_from_group", rows_of(g.node_from_group));
    switch (g.kind) {
      case kLevel:
        json_.member("kind", "level").member("number", g.number).member("count", g.count);
        json_.list("center", g.center).list("range", g.ranges_m);
        break;
      case kBillboard:
        json_.member("kind", "billboard").list("axis", g.axis);
        break;
      case kAnchor:
        json_.member("kind", "anchor").list("url", g.urls).member("description", g.description);
        break;
    }
    json_.close('}');
  }
  json_.close(']');
}

void GltfWriter::write_sensors() {
  json_.key("sensors").open('[');
  for (std::size_t i = 0; i < picture_.sensors.size(); ++i) {
    const DrawnSensor& s = picture_.sensors[i];
    json_.open('{').member("type", s.what.type).member("path", picture_.sensor_paths[i]).member("number", s.what.node);
    json_.member("node", s.node).list("node_from_sensor", rows_of(s.node_from_sensor));
    for (const auto& [name, numbers] : s.what.numbers) json_.list(name, numbers);
    json_.member("auto_offset", s.what.auto_offset).key("targets").open('[');
    for (const view::PageSensor::Target& target : s.what.targets) {
      json_.open('{')
          .member("event", target.event)
          .member("path", target.path)
          .member("field", target.field)
          .close('}');
    }
    json_.close(']').key("previews").open('[');
    for (const DrawnSensor::Preview& preview : s.previews) {
      json_.open('{').member("target", preview.target).member("path", preview.path).member("node", preview.node);
      json_.list("node_from_frame", rows_of(preview.node_from_frame)).list("from", preview.from).close('}');
    }
    json_.close(']').close('}');
  }
  json_.close(']');
}

void GltfWriter::write_light(std::size_t light) {
  const DrawnLight& l = picture_.lights[light];
  json_.open('{');
  place({l.node_from_light.position, l.node_from_light.orientation, Vec3::Ones(), std::nullopt});
  json_.key("extensions").open('{').key("KHR_lights_punctual").open('{').member("light", light).close('}').close('}');
  json_.key("extras").open('{').key("light").open('{').member("intensity", l.intensity);
  json_.member("ambient_intensity", l.ambient_intensity);
  if (l.kind != DrawnLight::Kind::kDirectional) {
    json_.list("attenuation", l.attenuation).member("radius_m", l.radius_m);
  }
  if (!l.on) json_.member("on", false);
  if (l.driven_on) json_.member("driven_on", *l.driven_on);
  if (l.driven_color) json_.member("driven_color", *l.driven_color);
  if (l.driven_intensity) json_.member("driven_intensity", *l.driven_intensity);
  json_.close('}').close('}').close('}');
}

// The nodes of the picture, then those of its Shapes and lights, then those below sheared Shapes.
void GltfWriter::write_nodes() {
  const std::size_t nodes = picture_.nodes.size(), shapes = picture_.shapes.size();
  std::vector<std::vector<std::size_t>> children(nodes);
  for (std::size_t i = 0; i < shapes; ++i) children[picture_.shapes[i].node].push_back(nodes + i);
  for (std::size_t i = 0; i < picture_.lights.size(); ++i) {
    children[picture_.lights[i].node].push_back(nodes + shapes + i);
  }
  json_.key("scene").value(0).key("scenes").open('[').open('{').key("nodes").open('[');
  for (std::size_t i = 0; i < nodes; ++i) json_.value(i);
  json_.close(']').close('}').close(']').key("nodes").open('[');
  for (std::size_t i = 0; i < nodes; ++i) {
    const DrawnNode& node = picture_.nodes[i];
    json_.open('{');
    if (!picture_.node_names[i].empty()) json_.member("name", picture_.node_names[i]);
    json_.key("extras").open('{');
    if (node.id) {
      json_.member("id", std::to_string(node.id->packed())).member("path", picture_.node_paths[i]);
      json_.member("def", picture_.node_names[i]).member("owner", node.owner.value);
    } else {
      json_.member("static", true);
    }
    json_.close('}');
    place({node.pose.position, node.pose.orientation, Vec3::Ones(), std::nullopt});
    if (!children[i].empty()) json_.list("children", children[i]);
    json_.close('}');
  }
  std::vector<std::pair<Quat, std::uint32_t>> inner;  // nodes below sheared Shapes, with their meshes
  for (std::size_t i = 0; i < shapes; ++i) {
    const DrawnShape& shape = picture_.shapes[i];
    write_shape(shape, picture_.shape_paths[i]);
    const auto turned = place_of(shape.node_from_shape).inner;
    if (turned && shape.mesh != DrawnShape::kNoMesh) {
      json_.key("children").open('[').value(nodes + shapes + picture_.lights.size() + inner.size()).close(']');
      inner.emplace_back(*turned, shape.mesh);
    } else if (shape.mesh != DrawnShape::kNoMesh) {
      json_.member("mesh", shape.mesh);
    }
    json_.close('}');
  }
  for (std::size_t i = 0; i < picture_.lights.size(); ++i) write_light(i);
  for (const auto& [turned, mesh] : inner) {
    json_.open('{').list("rotation", components(turned)).member("mesh", mesh).close('}');
  }
  json_.close(']');
}

void GltfWriter::write_meshes() {
  if (picture_.meshes.empty()) return;
  json_.key("meshes").open('[');
  for (const DrawnMesh& mesh : picture_.meshes) {
    const Accessors& at = of_geometry_[mesh.geometry];
    json_.open('{').key("primitives").open('[').open('{').key("attributes").open('{').member("POSITION", at.position);
    if (at.normal) json_.member("NORMAL", *at.normal);
    if (at.texture) json_.member("TEXCOORD_0", *at.texture);
    if (at.color) json_.member("COLOR_0", *at.color);
    if (at.point) json_.member("_POINT", *at.point);
    json_.close('}');
    const auto form = picture_.geometries[mesh.geometry].form;
    if (form) json_.key("extras").open('{').member("form", *form).close('}');
    if (at.corners) json_.member("indices", *at.corners);
    json_.member("mode", static_cast<int>(picture_.geometries[mesh.geometry].mode)).member("material", mesh.material);
    json_.close('}').close(']').close('}');
  }
  json_.close(']');
}

void GltfWriter::write_materials() {
  if (picture_.materials.empty()) return;
  std::vector<DrawnTexture> textures;
  json_.key("materials").open('[');
  for (const DrawnMaterial& m : picture_.materials) {
    const auto base = linear(m.diffuse), emissive = linear(m.emissive);
    json_.open('{').key("pbrMetallicRoughness").open('{');
    json_.list("baseColorFactor", std::array{base[0], base[1], base[2], 1.0F - m.transparency});
    json_.member("metallicFactor", 0).member("roughnessFactor", m.lit ? 1.0F - m.shininess : 1.0F);
    bool blends = m.transparency > 0.0F;
    if (m.texture) {
      const auto known = std::ranges::find(textures, *m.texture);
      const auto number = static_cast<std::size_t>(known - textures.begin());
      if (known == textures.end()) textures.push_back(*m.texture);
      json_.key("baseColorTexture").open('{').member("index", number).close('}');
      blends = blends || picture_.images[m.texture->image].has_alpha;
    }
    json_.close('}');
    if (m.emissive != Color{0, 0, 0}) json_.list("emissiveFactor", emissive);
    if (blends || m.driven.transparency) json_.member("alphaMode", "BLEND");
    if (m.driven != DrivenMaterial{}) {
      json_.key("extras").open('{');
      write_driven(m.driven);
      json_.close('}');
    }
    if (m.double_sided) json_.member("doubleSided", true);
    if (!m.lit) json_.key("extensions").open('{').key("KHR_materials_unlit").open('{').close('}').close('}');
    json_.close('}');
  }
  json_.close(']');
  if (textures.empty()) return;
  json_.key("textures").open('[');
  for (std::size_t i = 0; i < textures.size(); ++i) {
    json_.open('{').member("sampler", i).member("source", textures[i].image).close('}');
  }
  json_.close(']').key("samplers").open('[');
  const auto wrap = [](bool repeats) { return repeats ? 10497 : 33071; };
  for (const DrawnTexture& t : textures) {
    json_.open('{').member("wrapS", wrap(t.repeat_s)).member("wrapT", wrap(t.repeat_t)).close('}');
  }
  json_.close(']');
}

void GltfWriter::write_images() {
  if (picture_.images.empty()) return;
  json_.key("images").open('[');
  for (std::size_t i = 0; i < picture_.images.size(); ++i) {
    const bool is_png = picture_.images[i].format == DrawnImage::Format::kPng;
    json_.open('{')
        .member("bufferView", view_count_ + i)
        .member("mimeType", is_png ? "image/png" : "image/jpeg")
        .close('}');
  }
  json_.close(']');
}

void GltfWriter::write_lights() {
  if (picture_.lights.empty()) return;
  json_.key("extensions").open('{').key("KHR_lights_punctual").open('{').key("lights").open('[');
  for (const DrawnLight& l : picture_.lights) {
    using enum DrawnLight::Kind;
    json_.open('{').member("type", l.kind == kDirectional ? "directional" : l.kind == kPoint ? "point" : "spot");
    json_.list("color", linear(l.color)).member("intensity", kFullLight * std::clamp(l.intensity, 0.0F, 1.0F));
    if (l.kind != kDirectional && l.radius_m > 0.0F) json_.member("range", l.radius_m);
    if (l.kind == kSpot) {
      const double outer = std::clamp(double{l.cut_off_angle_rad}, 1e-3, std::numbers::pi / 2.0);
      const double inner = std::clamp(double{l.beam_width_rad}, 0.0, 0.999 * outer);
      json_.key("spot").open('{').member("innerConeAngle", inner).member("outerConeAngle", outer).close('}');
    }
    json_.close('}');
  }
  json_.close(']').close('}').close('}');
}

// Each word stands once; a row is four numbers: its depth, and the words that are its type, its name and its DEF name.
void GltfWriter::write_tree() {
  std::vector<std::string_view> words;
  std::unordered_map<std::string_view, std::size_t> number_of;
  const auto number = [&](std::string_view word) {
    const auto [known, is_new] = number_of.try_emplace(word, words.size());
    if (is_new) words.push_back(word);
    return known->second;
  };
  json_.key("tree").open('{').key("rows").open('[');
  for (const DrawnTree::Row& row : picture_.tree.rows) {
    json_.value(row.depth).value(number(row.type)).value(number(row.name)).value(number(row.def));
  }
  json_.close(']').list("words", words);
  json_.member("left_out", picture_.tree.left_out).close('}');
}

// Says what a picture has beside what glTF knows.
void GltfWriter::write_extras() {
  json_.key("extras").open('{').member("revision", picture_.revision).member("world", picture_.world);
  json_.key("viewpoints").open('[');
  for (const DrawnViewpoint& v : picture_.viewpoints) {
    json_.open('{')
        .member("def", v.def)
        .member("description", v.description)
        .list("position_m", components(v.node_from_camera.position));
    json_.list("orientation_xyzw", components(v.node_from_camera.orientation));
    json_.member("field_of_view_rad", v.field_of_view_rad);
    if (picture_.nodes[v.node].id) json_.member("node", v.node);
    json_.close('}');
  }
  json_.close(']');
  const auto colors = [&](const char* name, const std::vector<Color>& all) {
    json_.key(name).open('[');
    for (const Color& color : all) {
      json_.open('[');
      for (const float part : color) json_.value(part);
      json_.close(']');
    }
    json_.close(']');
  };
  if (const auto& b = picture_.background) {
    json_.key("background").open('{').list("sky_angle", b->sky_angles_rad);
    colors("sky_color", b->sky_colors);
    json_.list("ground_angle", b->ground_angles_rad);
    colors("ground_color", b->ground_colors);
    json_.close('}');
  }
  if (const auto& f = picture_.fog) {
    json_.key("fog").open('{').list("color", f->color).member("type", f->exponential ? "EXPONENTIAL" : "LINEAR");
    json_.member("visibility_range_m", f->visibility_range_m).close('}');
  }
  if (const auto& n = picture_.navigation) {
    json_.key("navigation").open('{').list("type", n->types).list("avatar_size", n->avatar_size_m);
    json_.member("speed", n->speed_m_s).member("visibility_limit_m", n->visibility_limit_m);
    json_.member("headlight", n->headlight).close('}');
  }
  write_groups();
  write_sensors();
  write_tree();
  json_.key("undrawn").open('[');
  for (const Undrawn& u : picture_.undrawn) {
    json_.open('{').member("path", u.path).member("what", u.what).member("why", u.why);
    if (u.count > 1) json_.member("count", u.count);
    json_.close('}');
  }
  json_.close(']').close('}');
}

void GltfWriter::write_views() {
  std::size_t at = 0;
  json_.key("bufferViews").open('[');
  for (std::size_t view = 0; view < kViews; ++view) {
    if (views_[view].empty()) continue;
    json_.open('{').member("buffer", 0).member("byteOffset", at).member("byteLength", views_[view].size());
    if (kStride[view] > 0) json_.member("byteStride", kStride[view]);
    json_.member("target", view == kCorners ? kIndices : kVertices).close('}');
    at += (views_[view].size() + 3) / 4 * 4;
  }
  for (const DrawnImage& image : picture_.images) {
    json_.open('{').member("buffer", 0).member("byteOffset", at).member("byteLength", image.bytes.size()).close('}');
    at += (image.bytes.size() + 3) / 4 * 4;
  }
  json_.close(']').key("buffers").open('[').open('{').member("byteLength", at).close('}').close(']');
  binary_.reserve(at);
  for (const std::string& view : views_) append(view);
  for (const DrawnImage& image : picture_.images) append(image.bytes);
  assert(binary_.size() == at);
}

void GltfWriter::append(const std::string& bytes) {
  binary_ += bytes;
  binary_.resize((binary_.size() + 3) / 4 * 4);
}

void GltfWriter::number_views() {
  std::array<bool, kViews> used{};
  for (const DrawnGeometry& g : picture_.geometries) {
    used[kPositions] = true;
    used[kNormals] = used[kNormals] || !g.normals.empty();
    used[kTextureCoordinates] = used[kTextureCoordinates] || !g.texture_coordinates.empty();
    used[kColors] = used[kColors] || !g.colors.empty();
    used[kPoints] = used[kPoints] || !g.points.empty();
    used[kCorners] = used[kCorners] || g.mode != DrawnGeometry::Mode::kPoints;
  }
  for (std::size_t view = 0; view < kViews; ++view) view_number_[view] = used[view] ? view_count_++ : view_count_;
}

std::expected<std::string, std::string> GltfWriter::write() {
  number_views();
  write_geometries();
  json_.open('{').key("asset").open('{').member("version", "2.0").member("generator", "peerd");
  write_extras();
  json_.close('}');
  std::vector<std::string> extensions;
  if (!picture_.lights.empty()) extensions.emplace_back("KHR_lights_punctual");
  const bool unlit = std::ranges::any_of(picture_.materials, [](const DrawnMaterial& m) { return !m.lit; });
  if (unlit) extensions.emplace_back("KHR_materials_unlit");
  if (!extensions.empty()) json_.list("extensionsUsed", extensions);
  write_nodes();
  write_meshes();
  write_materials();
  write_images();
  write_lights();
  if (accessor_count_ > 0) {
    json_.key("accessors");
    std::string text = json_.take() + accessors_.take();
    json_ = JsonWriter(std::move(text));
    write_views();
  }
  json_.close('}');
  std::string text = json_.take();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  constexpr std::size_t kHeader_bytes = 12, kChunk_bytes = 8;
  const std::size_t size =
      kHeader_bytes + kChunk_bytes + text.size() + (binary_.empty() ? 0 : kChunk_bytes + binary_.size());
  if (size > std::numeric_limits<std::uint32_t>::max()) {
    return std::unexpected("the picture is larger than the 4 GiB that a file of glTF can be");
  }
  std::string out;
  out.reserve(size);
  const auto word = [&out](std::size_t value) {
    const auto narrow = static_cast<std::uint32_t>(value);
    out.append(reinterpret_cast<const char*>(&narrow), sizeof narrow);
  };
  out += "glTF";
  word(2);
  word(size);
  word(text.size());
  out += "JSON";
  out += text;
  if (!binary_.empty()) {
    word(binary_.size());
    out.append("BIN\0", 4);
    out += binary_;
  }
  return out;
}

}  // namespace

std::expected<std::string, std::string> write_glb(const ScenePicture& picture) { return GltfWriter(picture).write(); }

}  // namespace peerd::view
