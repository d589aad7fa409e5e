#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace peerd::formats {

enum class PlyType : std::uint8_t { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };
[[nodiscard]] std::size_t size_of(PlyType type);  // [bytes]

enum class PlyEncoding : std::uint8_t { kText, kLittleEndian, kBigEndian };

struct PlyProperty {
  std::string_view name;
  PlyType type = PlyType::kFloat32;
  std::optional<PlyType> count_type;  // of a list
};

struct PlyElement {
  std::string_view name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
  std::size_t begin = 0;  // of its line in the header
};

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::kText;
  std::vector<PlyElement> elements;
  std::size_t end = 0;  // where the body begins
};

struct PlyHeaderError {
  std::size_t offset = 0;
  std::string why;
};

[[nodiscard]] std::expected<PlyHeader, PlyHeaderError> read_ply_header(std::string_view bytes);

}  // namespace peerd::formats
