#pragma once
#include <deque>
#include <string>
#include <string_view>
#include <vector>

#include "core/formats/draft/reading.hpp"

namespace tinygltf {
class Model;
}

namespace peerd::formats::gltf {

// The bytes of a glTF's buffers, wherever they are: in the GLB file, in a data: URI, or in a file beside it.
class Buffers {
 public:
  // Reads the list `json` (CheckedJson::buffers); false where it is wrong, or a buffer cannot be read.
  bool read(std::string_view json, std::string_view binary, Reading& reading);

  [[nodiscard]] std::size_t count() const { return bytes_.size(); }
  [[nodiscard]] std::string_view operator[](std::size_t buffer) const { return bytes_[buffer]; }

 private:
  std::vector<std::string_view> bytes_;  // of each, as long as its byteLength says
  std::deque<std::string> decoded_;      // bytes of data: URIs
};

// An image of a glTF, as its JSON has it.
struct ImageSource {
  std::string uri, media_type;
  int buffer_view = -1;
};
// Reads the list `json` (CheckedJson::images).
bool read_images(std::string_view json, Reading& reading, std::vector<ImageSource>& images);

// Returns the bytes of a bufferView; none where there is no such one, or it reaches beyond its buffer.
[[nodiscard]] std::optional<std::string_view> bytes_of_view(const tinygltf::Model& model, const Buffers& buffers,
                                                            int view);

}  // namespace peerd::formats::gltf
