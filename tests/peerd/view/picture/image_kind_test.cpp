#include "peerd/view/picture/image_kind.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include <zlib.h>

#include "tests/must.hpp"

namespace peerd::view::image_kind_test {

std::string png(char color_type, const std::string& chunk = "IDAT") {
  return std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\10", 25) + color_type + std::string(7, '\0') +
         std::string("\0\0\0\0", 4) + chunk + std::string(4, '\0');
}
std::string jpeg(char components) {
  return std::string("\xFF\xD8\xFF\xE0\0\4ab\xFF\xC0\0\21\10\0\1\0\1", 17) + components + std::string(16, '\1');
}

TEST(ImageKind, SaysWhatAnImageIs) {
  struct Case {
    const char* name;
    std::string bytes;
    DrawnImage::Format format;
    bool has_color, has_alpha;
  };
  using enum DrawnImage::Format;
  for (const Case& c : {Case{"grey", png(0), kPng, false, false}, Case{"colours", png(2), kPng, true, false},
                        Case{"palette", png(3), kPng, true, false}, Case{"grey with alpha", png(4), kPng, false, true},
                        Case{"with alpha", png(6), kPng, true, true},
                        Case{"palette with transparent entries", png(3, "tRNS"), kPng, true, true},
                        Case{"grey JPEG", jpeg(1), kJpeg, false, false}, Case{"JPEG", jpeg(3), kJpeg, true, false}}) {
    const auto image = image_of(c.bytes);
    ASSERT_TRUE(image) << c.name << ": " << image.error();
    EXPECT_EQ(image->format, c.format) << c.name;
    EXPECT_EQ(image->has_color, c.has_color) << c.name;
    EXPECT_EQ(image->has_alpha, c.has_alpha) << c.name;
    EXPECT_EQ(image->bytes, c.bytes) << c.name;
  }
}

// Whatever the bytes are, nothing is read beyond them.
TEST(ImageKind, RefusesWhatIsNoImage) {
  for (const std::string& good : {png(6, "tRNS"), jpeg(3)}) {
    for (std::size_t size = 0; size < good.size(); ++size) {
      const auto image = image_of(good.substr(0, size));
      EXPECT_TRUE(image || image.error().starts_with("it is ")) << image.error();
    }
  }
  EXPECT_EQ(image_of("GIF89a").error(), "it is a GIF, which glTF does not take");
  EXPECT_EQ(image_of("").error(), "it is neither PNG nor JPEG");
  EXPECT_EQ(image_of(png(2).substr(0, 30)).error(), "it is a damaged PNG");
  EXPECT_EQ(image_of(jpeg(3).substr(0, 15)).error(), "it is a damaged JPEG");
}

// The pixels of a PNG without filters, row by row from the upper edge.
std::string pixels_of(const std::string& bytes) {
  const std::size_t head = 8 + 12 + 13;  // the magic, and IHDR
  const auto size = static_cast<uLong>(static_cast<unsigned char>(bytes[head + 2])) << 8U |
                    static_cast<unsigned char>(bytes[head + 3]);
  std::string out(1000, '\0');
  uLongf count = out.size();
  const int failed = uncompress(reinterpret_cast<Bytef*>(out.data()), &count,
                                reinterpret_cast<const Bytef*>(bytes.data() + head + 8), size);
  EXPECT_EQ(failed, Z_OK);
  out.resize(count);
  return out;
}

TEST(ImageKind, MakesPngsOfPixels) {
  const auto colors = must(png_of_pixels(std::vector<std::int32_t>{1, 2, 3, 0x112233, 0xFF8001}));
  EXPECT_EQ(pixels_of(colors), std::string("\0\xFF\x80\x01\0\x11\x22\x33", 8)) << "its first pixel is the lower one";
  const auto image = must(image_of(colors));
  EXPECT_TRUE(image.has_color);
  EXPECT_FALSE(image.has_alpha);
  const auto grey = must(png_of_pixels(std::vector<std::int32_t>{2, 1, 2, 0x1122, 0x3344}));
  EXPECT_EQ(pixels_of(grey), std::string("\0\x11\x22\x33\x44", 5));
  EXPECT_FALSE(image_of(grey)->has_color);
  EXPECT_TRUE(image_of(grey)->has_alpha);
  // Its last four bytes are the checksum of "IEND", which the standard gives.
  EXPECT_TRUE(grey.ends_with("IEND\xAE\x42\x60\x82"));
}

TEST(ImageKind, RefusesPixelsThatAreNoImage) {
  for (const std::vector<std::int32_t>& bad : std::vector<std::vector<std::int32_t>>{{},
                                                                                     {0, 0, 0},
                                                                                     {1, 1},
                                                                                     {-1, 1, 1, 0},
                                                                                     {1, 1, 5, 0},
                                                                                     {2, 2, 1, 0, 0, 0},
                                                                                     {5000, 1, 1},
                                                                                     {1 << 30, 1 << 30, 4}}) {
    EXPECT_FALSE(png_of_pixels(bad));
  }
}

}  // namespace peerd::view::image_kind_test
