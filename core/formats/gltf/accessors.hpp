#pragma once
#include <cstdint>
#include <expected>
#include <string>
#include <vector>

#include "core/formats/gltf/buffers.hpp"

namespace peerd::formats::gltf {

// Reads the values of accessors: dense ones, sparse ones, and integers that stand for numbers from -1 or 0 to 1. All
// that a file says about where values are is checked before any is read. The errors are sentences that begin with the
// accessor's path in the JSON. Each reading counts as values that the file asks for: many accessors may share bytes.
class Accessors {
 public:
  Accessors(const tinygltf::Model& model, const Buffers& buffers, Reading& reading)
      : model_(model), buffers_(buffers), reading_(reading) {}

  // Returns the values one behind the other, `width` numbers each; an error where the accessor's type is another.
  // Colours have three or four numbers: for these, `width` is 0, and the accessor's type decides.
  [[nodiscard]] std::expected<std::vector<float>, std::string> floats(int accessor, std::size_t width);
  // Returns indices, which are below `limit`.
  [[nodiscard]] std::expected<std::vector<std::uint32_t>, std::string> indices(int accessor, std::uint64_t limit);
  // Returns the number of values; 0 where there is no such accessor.
  [[nodiscard]] std::uint64_t count(int accessor) const;
  [[nodiscard]] std::size_t width(int accessor) const;  // numbers of one value; 0 where there is no such accessor

 private:
  struct Strided {  // values of one kind in a buffer
    std::string_view bytes;
    std::size_t stride = 0;  // [bytes]
  };
  [[nodiscard]] std::expected<Strided, std::string> strided(int view, std::uint64_t offset, std::uint64_t count,
                                                            std::size_t size) const;
  template <class T, class Decode>
  [[nodiscard]] std::expected<std::vector<T>, std::string> values(int accessor, Decode decode);

  const tinygltf::Model& model_;
  const Buffers& buffers_;
  Reading& reading_;
};

}  // namespace peerd::formats::gltf
