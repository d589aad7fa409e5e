#include "peerd/picture/image_kind.hpp"

#include <cstddef>
#include <cstdint>
#include <utility>

namespace peerd::picture {
namespace {

constexpr std::string_view kPngBegin = "\x89PNG\r\n\x1a\n";

std::uint32_t byte(std::string_view bytes, std::size_t at) { return static_cast<unsigned char>(bytes[at]); }
std::uint32_t two_bytes(std::string_view bytes, std::size_t at) { return byte(bytes, at) << 8 | byte(bytes, at + 1); }

// Whether a chunk of that name stands before the pixels. A chunk is its size, its name, its content and four bytes
// more.
bool has_chunk(std::string_view bytes, std::string_view name) {
  for (std::size_t at = kPngBegin.size(); at + 12 <= bytes.size();) {
    const std::string_view found = bytes.substr(at + 4, 4);
    if (found == name) return true;
    if (found == "IDAT") return false;
    at += 12 + (std::size_t{two_bytes(bytes, at)} << 16 | two_bytes(bytes, at + 2));
  }
  return false;
}

// IHDR comes first: width, height, depth, and then the type of colour at byte 25.
std::expected<DrawnImage, std::string> png(std::string bytes) {
  if (bytes.size() < 33 || std::string_view(bytes).substr(12, 4) != "IHDR")
    return std::unexpected("it is a damaged PNG");
  const std::uint32_t type = byte(bytes, 25);
  const bool has_alpha = (type & 4U) != 0 || has_chunk(bytes, "tRNS");
  return DrawnImage{DrawnImage::Format::kPng, std::move(bytes), (type & 2U) != 0, has_alpha};
}

// The number of components stands in the frame header, behind other segments.
std::expected<DrawnImage, std::string> jpeg(std::string bytes) {
  for (std::size_t at = 2; at + 10 <= bytes.size();) {
    if (byte(bytes, at) != 0xFF) break;
    const std::uint32_t marker = byte(bytes, at + 1);
    if (marker == 0xFF) {  // a byte of filling
      ++at;
      continue;
    }
    const bool is_frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (is_frame) {
      const bool has_color = byte(bytes, at + 9) >= 3;
      return DrawnImage{DrawnImage::Format::kJpeg, std::move(bytes), has_color, false};
    }
    at += 2 + std::size_t{two_bytes(bytes, at + 2)};
  }
  return std::unexpected("it is a damaged JPEG");
}

}  // namespace

std::expected<DrawnImage, std::string> image_of(std::string bytes) {
  const std::string_view begin = bytes;
  if (begin.starts_with(kPngBegin)) return png(std::move(bytes));
  if (begin.starts_with("\xFF\xD8\xFF")) return jpeg(std::move(bytes));
  if (begin.starts_with("GIF8")) return std::unexpected("it is a GIF, which glTF does not take");
  return std::unexpected("it is neither PNG nor JPEG");
}

}  // namespace peerd::picture
