#include "peerd/view/picture/image_kind.hpp"

#include <cstddef>
#include <cstdint>
#include <utility>

#include <zlib.h>

namespace peerd::view {
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

void put_word(std::string& out, std::uint32_t word) {
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(word >> static_cast<unsigned>(shift) & 0xFFU);
}

void put_chunk(std::string& out, const std::string& name, const std::string& content) {
  put_word(out, static_cast<std::uint32_t>(content.size()));
  const std::string counted = name + content;
  out += counted;
  const auto crc = crc32(0, reinterpret_cast<const Bytef*>(counted.data()), static_cast<uInt>(counted.size()));
  put_word(out, static_cast<std::uint32_t>(crc));
}

}  // namespace

std::expected<std::string, std::string> png_of_pixels(std::span<const std::int32_t> image) {
  constexpr std::uint32_t kSide_pixels = 4096;
  // The types of PNG by the number of components: grey, grey with alpha, colour, colour with alpha.
  constexpr char kColorTypes[] = {0, 4, 2, 6};
  if (image.size() < 3 || image[0] <= 0 || image[1] <= 0 || image[2] <= 0) return std::unexpected("it has no pixels");
  const auto width = static_cast<std::uint32_t>(image[0]), height = static_cast<std::uint32_t>(image[1]);
  const auto components = static_cast<std::uint32_t>(image[2]);
  if (width > kSide_pixels || height > kSide_pixels) return std::unexpected("it is larger than 4096 pixels a side");
  if (components > 4 || image.size() < 3 + std::size_t{width} * height) return std::unexpected("its image is damaged");
  std::string rows;
  rows.reserve(std::size_t{height} * (1 + std::size_t{width} * components));
  for (std::uint32_t y = height; y-- > 0;) {
    rows += '\0';  // no filter
    for (std::uint32_t x = 0; x < width; ++x) {
      const auto pixel = static_cast<std::uint32_t>(image[3 + std::size_t{y} * width + x]);
      for (std::uint32_t c = components; c-- > 0;) rows += static_cast<char>(pixel >> (8 * c) & 0xFFU);
    }
  }
  uLongf size = compressBound(static_cast<uLong>(rows.size()));
  std::string packed(size, '\0');
  const int failed = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                               reinterpret_cast<const Bytef*>(rows.data()), static_cast<uLong>(rows.size()), 6);
  if (failed != Z_OK) return std::unexpected("it cannot be packed");
  packed.resize(size);
  std::string head;
  put_word(head, width);
  put_word(head, height);
  head += '\x08';
  head += kColorTypes[components - 1];
  head += std::string(3, '\0');
  std::string out(kPngBegin);
  put_chunk(out, "IHDR", head);
  put_chunk(out, "IDAT", packed);
  put_chunk(out, "IEND", {});
  return out;
}

std::expected<DrawnImage, std::string> image_of(std::string bytes) {
  const std::string_view begin = bytes;
  if (begin.starts_with(kPngBegin)) return png(std::move(bytes));
  if (begin.starts_with("\xFF\xD8\xFF")) return jpeg(std::move(bytes));
  if (begin.starts_with("GIF8")) return std::unexpected("it is a GIF, which glTF does not take");
  return std::unexpected("it is neither PNG nor JPEG");
}

}  // namespace peerd::view
