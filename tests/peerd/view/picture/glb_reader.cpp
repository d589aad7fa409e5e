#include "tests/peerd/view/picture/glb_reader.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

namespace peerd::testing_support {
namespace {

using nlohmann::json;

std::uint32_t word(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value |= std::uint32_t{static_cast<unsigned char>(bytes[at + k])} << (8 * k);
  return value;
}

class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  Glb read() {
    if (!read_chunks()) return std::move(out_);
    const json& j = out_.json;
    if (j.at("asset").at("version") != "2.0") problem("asset.version");
    check_views();
    for (const json& mesh : list("meshes")) read_mesh(mesh);
    for (const json& material : list("materials")) check_material(material);
    for (const json& image : list("images")) {
      const std::string type = image.at("mimeType");
      const std::string_view begin = view_bytes(image.at("bufferView"));
      const bool is_png = begin.substr(0, 4) == "\x89PNG", is_jpeg = begin.substr(0, 2) == "\xFF\xD8";
      if (!(is_png && type == "image/png") && !(is_jpeg && type == "image/jpeg")) problem("an image of another type");
    }
    read_nodes();
    check_extensions(j);
    return std::move(out_);
  }

 private:
  void problem(const std::string& what) { out_.problems.push_back(what); }
  [[nodiscard]] const json& list(const char* name) const {
    static const json kNone = json::array();
    const auto at = out_.json.find(name);
    return at == out_.json.end() ? kNone : *at;
  }

  bool read_chunks() {
    if (bytes_.size() < 20 || bytes_.substr(0, 4) != "glTF" || word(bytes_, 4) != 2 ||
        word(bytes_, 8) != bytes_.size()) {
      problem("the header");
      return false;
    }
    const std::size_t length = word(bytes_, 12);
    if (bytes_.substr(16, 4) != "JSON" || length % 4 != 0 || 20 + length > bytes_.size()) {
      problem("the chunk JSON");
      return false;
    }
    out_.json = json::parse(bytes_.substr(20, length), nullptr, false);
    if (out_.json.is_discarded()) {
      problem("the JSON");
      return false;
    }
    const std::size_t at = 20 + length;
    if (at == bytes_.size()) return true;
    if (at + 8 > bytes_.size() || bytes_.substr(at + 4, 4) != std::string_view("BIN\0", 4) ||
        word(bytes_, at) != bytes_.size() - at - 8 || word(bytes_, at) % 4 != 0) {
      problem("the chunk BIN");
      return false;
    }
    out_.binary = bytes_.substr(at + 8);
    return true;
  }

  void check_views() {
    for (const json& buffer : list("buffers")) {
      const std::size_t length = buffer.at("byteLength");
      if (length == 0 || length > out_.binary.size() || out_.binary.size() - length > 3) problem("a buffer's length");
    }
    for (const json& view : list("bufferViews")) {
      const std::size_t offset = view.value("byteOffset", std::size_t{0}), length = view.at("byteLength");
      if (length == 0 || offset + length > out_.binary.size()) problem("a buffer view beyond its buffer");
      const std::size_t stride = view.value("byteStride", std::size_t{4});
      if (stride < 4 || stride > 252 || stride % 4 != 0) problem("a stride");
    }
  }

  [[nodiscard]] std::string_view view_bytes(std::size_t view) {
    const json& at = list("bufferViews").at(view);
    return std::string_view(out_.binary)
        .substr(at.value("byteOffset", std::size_t{0}), at.at("byteLength").get<std::size_t>());
  }

  // The components of an accessor, element after element.
  template <class T>
  std::vector<T> values(std::size_t accessor, int component_type, const char* type, std::size_t components) {
    const json& at = list("accessors").at(accessor);
    if (at.at("componentType") != component_type || at.at("type") != type) problem("the type of an accessor");
    const std::string_view bytes = view_bytes(at.at("bufferView"));
    const json& view = list("bufferViews").at(at.at("bufferView").get<std::size_t>());
    const std::size_t element = sizeof(T) * components, stride = view.value("byteStride", element);
    const std::size_t offset = at.value("byteOffset", std::size_t{0}), count = at.at("count");
    if (offset % sizeof(T) != 0 || view.value("byteOffset", std::size_t{0}) % sizeof(T) != 0) problem("an alignment");
    if (count == 0 || offset + stride * (count - 1) + element > bytes.size()) {
      problem("an accessor beyond its view");
      return {};
    }
    std::vector<T> out(count * components);
    for (std::size_t i = 0; i < count; ++i) {
      std::memcpy(&out[i * components], bytes.data() + offset + i * stride, element);
    }
    return out;
  }
  std::vector<Eigen::Vector3f> vectors(std::size_t accessor) {
    const auto flat = values<float>(accessor, 5126, "VEC3", 3);
    std::vector<Eigen::Vector3f> out;
    for (std::size_t i = 0; i < flat.size(); i += 3) out.emplace_back(flat[i], flat[i + 1], flat[i + 2]);
    return out;
  }

  void read_mesh(const json& mesh) {
    const json& primitive = mesh.at("primitives").at(0);
    if (mesh.at("primitives").size() != 1) problem("a mesh of several primitives");
    const json& attributes = primitive.at("attributes");
    Glb::Primitive& p = out_.meshes.emplace_back();
    p.mode = primitive.value("mode", 4);
    p.material = primitive.value("material", -1);
    if (p.material >= static_cast<int>(list("materials").size())) problem("a material that is not there");
    const std::size_t position = attributes.at("POSITION");
    p.positions = vectors(position);
    check_bounds(list("accessors").at(position), p.positions);
    if (attributes.contains("NORMAL")) p.normals = vectors(attributes["NORMAL"]);
    for (const Eigen::Vector3f& n : p.normals) {
      if (!(std::abs(n.norm() - 1.0F) < 1e-4F)) problem("a normal that is not of unit length");
    }
    if (attributes.contains("COLOR_0")) {
      for (const Eigen::Vector3f& c : vectors(attributes["COLOR_0"])) {
        p.colors.push_back({c[0], c[1], c[2]});
        if (!(c.minCoeff() >= 0.0F && c.maxCoeff() <= 1.0F)) problem("a colour beyond 0 to 1");
      }
    }
    if (attributes.contains("TEXCOORD_0")) {
      const auto flat = values<float>(attributes["TEXCOORD_0"], 5126, "VEC2", 2);
      for (std::size_t i = 0; i < flat.size(); i += 2) p.texture_coordinates.emplace_back(flat[i], flat[i + 1]);
    }
    for (const std::size_t size : {p.normals.size(), p.colors.size(), p.texture_coordinates.size()}) {
      if (size != 0 && size != p.positions.size()) problem("attributes of different counts");
    }
    read_corners(primitive, p);
  }

  void read_corners(const json& primitive, Glb::Primitive& p) {
    if (!primitive.contains("indices")) {
      for (std::uint32_t i = 0; i < p.positions.size(); ++i) p.corners.push_back(i);
    } else if (const std::size_t at = primitive["indices"]; list("accessors").at(at).at("componentType") == 5123) {
      const auto corners = values<std::uint16_t>(at, 5123, "SCALAR", 1);
      p.corners.assign(corners.begin(), corners.end());
      if (std::ranges::find(corners, 0xFFFF) != corners.end()) problem("an index that restarts a strip");
    } else {
      p.corners = values<std::uint32_t>(at, 5125, "SCALAR", 1);
    }
    for (const std::uint32_t corner : p.corners) {
      if (corner >= p.positions.size()) return problem("an index beyond the vertices");
    }
    const std::size_t of_one = p.mode == 4 ? 3 : p.mode == 1 ? 2 : 1;
    if (p.corners.size() % of_one != 0) problem("a number of indices");
  }

  void check_bounds(const json& accessor, const std::vector<Eigen::Vector3f>& all) {
    if (all.empty()) return;
    Eigen::Vector3f lo = all.front(), hi = lo;
    for (const Eigen::Vector3f& p : all) {
      lo = lo.cwiseMin(p);
      hi = hi.cwiseMax(p);
    }
    for (int k = 0; k < 3; ++k) {
      const auto number = static_cast<std::size_t>(k);
      const bool same =
          accessor.at("min").at(number).get<float>() == lo[k] && accessor.at("max").at(number).get<float>() == hi[k];
      if (!same) problem("bounds of positions");
    }
  }

  void check_material(const json& material) {
    const json& painted = material.at("pbrMetallicRoughness");
    for (const double part : painted.at("baseColorFactor")) {
      if (!(part >= 0.0 && part <= 1.0)) problem("a base colour");
    }
    if (painted.contains("baseColorTexture")) {
      const json& texture = list("textures").at(painted["baseColorTexture"].at("index").get<std::size_t>());
      if (texture.at("source") >= list("images").size()) problem("an image that is not there");
      if (texture.at("sampler") >= list("samplers").size()) problem("a sampler that is not there");
    }
    for (const double part : material.value("emissiveFactor", json::array())) {
      if (!(part >= 0.0 && part <= 1.0)) problem("an emissive colour");
    }
  }

  static Eigen::Affine3d place(const json& node) {
    Eigen::Affine3d out = Eigen::Affine3d::Identity();
    if (const auto t = node.find("translation"); t != node.end())
      out.translate(Eigen::Vector3d(t->at(0), t->at(1), t->at(2)));
    if (const auto r = node.find("rotation"); r != node.end()) {
      out.rotate(Eigen::Quaterniond(r->at(3), r->at(0), r->at(1), r->at(2)));
    }
    if (const auto s = node.find("scale"); s != node.end()) out.scale(Eigen::Vector3d(s->at(0), s->at(1), s->at(2)));
    return out;
  }

  void read_nodes() {
    for (const json& node : list("nodes")) {
      out_.nodes.push_back({place(node), -1, node.value("mesh", -1), node});
      if (out_.nodes.back().mesh >= static_cast<int>(out_.meshes.size())) problem("a mesh that is not there");
      if (const auto r = node.find("rotation"); r != node.end()) {
        double square = 0.0;
        for (const double part : *r) square += part * part;
        if (!(std::abs(square - 1.0) < 1e-6)) problem("a rotation that is not of unit length");
      }
      if (node.contains("matrix")) problem("a matrix, which this reader does not expect");
    }
    for (std::size_t i = 0; i < out_.nodes.size(); ++i) {
      for (const std::size_t child : out_.nodes[i].json.value("children", json::array())) {
        if (child >= out_.nodes.size() || out_.nodes[child].parent >= 0) {
          problem("a child that is not there, or has two parents");
        } else {
          out_.nodes[child].parent = static_cast<int>(i);
        }
      }
    }
    std::set<std::size_t> roots;
    for (const std::size_t root : list("scenes").at(0).at("nodes")) roots.insert(root);
    for (std::size_t i = 0; i < out_.nodes.size(); ++i) {
      if ((out_.nodes[i].parent < 0) != roots.contains(i))
        problem("a node that is in no scene, or a root with a parent");
    }
    std::vector<Eigen::Affine3d> local;
    for (const Glb::Node& node : out_.nodes) local.push_back(node.world);
    for (std::size_t i = 0; i < local.size(); ++i) {
      int steps = 0;
      for (int above = out_.nodes[i].parent; above >= 0 && steps < 1000; ++steps) {
        out_.nodes[i].world = local[static_cast<std::size_t>(above)] * out_.nodes[i].world;
        above = out_.nodes[static_cast<std::size_t>(above)].parent;
      }
      if (steps == 1000) problem("a circle of nodes");
    }
  }

  void check_extensions(const json& j) {
    const json used = j.value("extensionsUsed", json::array());
    const auto is_used = [&](const char* name) { return std::ranges::find(used, name) != used.end(); };
    const std::string text = j.dump();
    for (const char* name : {"KHR_lights_punctual", "KHR_materials_unlit"}) {
      const bool occurs = text.find("\"" + std::string(name) + "\":") != std::string::npos;
      if (occurs != is_used(name)) problem("extensionsUsed");
    }
  }

  std::string_view bytes_;
  Glb out_;
};

}  // namespace

int Glb::find(std::string_view path) const {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const auto extras = nodes[i].json.find("extras");
    if (extras != nodes[i].json.end() && extras->value("path", std::string()) == path) return static_cast<int>(i);
  }
  return -1;
}

std::vector<Glb::Triangle> Glb::triangles(int node) const {
  std::vector<Triangle> out;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    bool is_below = false;
    for (int at = static_cast<int>(i); at >= 0 && !is_below; at = nodes[static_cast<std::size_t>(at)].parent) {
      is_below = at == node;
    }
    if (!is_below || nodes[i].mesh < 0) continue;
    const Primitive& p = meshes[static_cast<std::size_t>(nodes[i].mesh)];
    if (p.mode != 4) continue;
    const auto at = [&](std::size_t corner) -> Eigen::Vector3d {
      return nodes[i].world * p.positions[p.corners[corner]].cast<double>();
    };
    for (std::size_t k = 0; k + 2 < p.corners.size(); k += 3) out.push_back({at(k), at(k + 1), at(k + 2)});
  }
  return out;
}

Glb read_glb(std::string_view bytes) { return Reader(bytes).read(); }

}  // namespace peerd::testing_support
