#pragma once
#include <string>
#include <utility>
#include <vector>

#include "core/formats/draft/base64.hpp"
#include "tests/core/formats/format_fixture.hpp"

namespace peerd::formats::gltf {

// Makes small glTF files. Values go into one buffer; each call of accessor() adds a bufferView and an accessor for
// them.
class GltfMaker {
 public:
  template <class T>
  int accessor(const std::vector<T>& values, const std::string& type, int component_type, std::size_t count,
               const std::string& more = {}) {
    while (buffer_.size() % 4 != 0) buffer_ += '\0';
    const std::size_t begin = buffer_.size();
    for (const T value : values) append(buffer_, value);
    const int view = add(views_, "{\"buffer\":0,\"byteOffset\":" + std::to_string(begin) +
                                     ",\"byteLength\":" + std::to_string(buffer_.size() - begin) + "}");
    return add(accessors_, "{\"bufferView\":" + std::to_string(view) +
                               ",\"componentType\":" + std::to_string(component_type) +
                               ",\"count\":" + std::to_string(count) + ",\"type\":\"" + type + "\"" + more + "}");
  }
  int points(const std::vector<float>& values) { return accessor(values, "VEC3", 5126, values.size() / 3); }
  int indices(const std::vector<std::uint16_t>& values) { return accessor(values, "SCALAR", 5123, values.size()); }
  int raw_accessor(const std::string& json) { return add(accessors_, json); }
  int raw_view(const std::string& json) { return add(views_, json); }

  // `rest` is what stands behind the buffer, the views and the accessors.
  [[nodiscard]] std::string json(const std::string& rest, const std::string& uri) const {
    const std::string buffer = "\"buffers\":[{\"byteLength\":" + std::to_string(buffer_.size()) +
                               (uri.empty() ? "" : ",\"uri\":\"" + uri + "\"") + "}],";
    return "{\"asset\":{\"version\":\"2.0\"}," + buffer + "\"bufferViews\":[" + views_ + "],\"accessors\":[" +
           accessors_ + "]," + rest + "}";
  }
  [[nodiscard]] std::string gltf(const std::string& rest) const {
    return json(rest, data_url("application/octet-stream", buffer_));
  }
  [[nodiscard]] std::string glb(const std::string& rest) const {
    std::string text = json(rest, ""), binary = buffer_;
    while (text.size() % 4 != 0) text += ' ';
    while (binary.size() % 4 != 0) binary += '\0';
    std::string bytes = "glTF";
    for (const std::size_t n : {std::size_t{2}, 28 + text.size() + binary.size(), text.size()}) {
      append(bytes, static_cast<std::uint32_t>(n));
    }
    bytes += "JSON" + text;
    append(bytes, static_cast<std::uint32_t>(binary.size()));
    return bytes + std::string("BIN\0", 4) + binary;
  }
  [[nodiscard]] const std::string& buffer() const { return buffer_; }

 private:
  static int add(std::string& list, const std::string& one) {
    int index = 0, depth = 0;
    for (const char c : list) {
      index += c == '{' && depth == 0 ? 1 : 0;
      depth += c == '{' ? 1 : c == '}' ? -1 : 0;
    }
    list += (list.empty() ? "" : ",") + one;
    return index;
  }

  std::string buffer_, views_, accessors_;
};

inline std::string triangle_mesh(int points, int indices, const std::string& more = {}) {
  return "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":" + std::to_string(points) + "}" +
         (indices < 0 ? "" : ",\"indices\":" + std::to_string(indices)) + more + "}]}]";
}

inline const std::vector<float> kTriangle{0, 0, 0, 1, 0, 0, 1, 1, 0};
inline const std::vector<float> kSquare{0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};

inline std::string one_node(const std::string& mesh, const std::string& more = {}) {
  return mesh + ",\"nodes\":[{\"name\":\"only\",\"mesh\":0" + more + "}],\"scenes\":[{\"nodes\":[0]}]";
}

}  // namespace peerd::formats::gltf
