#include "core/formats/mesh/ply_header.hpp"

#include <gtest/gtest.h>

#include <string>

namespace peerd::formats::ply_header_test {
namespace {

TEST(PlyHeader, NamesElementsAndTheirProperties) {
  const std::string text =
      "ply\r\nformat binary_big_endian 1.0\r\ncomment a\r\nelement face 7\r\nproperty list uint8 int32 "
      "vertex_indices\r\n"
      "property float64 q\r\nend_header\r\nBODY";
  const auto header = read_ply_header(text);
  ASSERT_TRUE(header);
  EXPECT_EQ(header->encoding, PlyEncoding::kBigEndian);
  ASSERT_EQ(header->elements.size(), 1U);
  EXPECT_EQ(header->elements[0].count, 7U);
  EXPECT_EQ(header->elements[0].properties[0].count_type, PlyType::kUint8);
  EXPECT_EQ(header->elements[0].properties[1].type, PlyType::kFloat64);
  EXPECT_EQ(text.substr(header->end), "BODY");
}

TEST(PlyHeader, HasBoundedLists) {
  std::string text = "ply\nformat ascii 1.0\n";
  for (int i = 0; i < 100; ++i) text += "element e 1\n";
  EXPECT_FALSE(read_ply_header(text + "end_header\n"));
  EXPECT_FALSE(read_ply_header("ply\nformat ascii 1.0\nelement e 1\nproperty list float int x\nend_header\n"));
  EXPECT_FALSE(read_ply_header("ply\nformat ascii 1.0\nproperty int x\nend_header\n"));
  EXPECT_FALSE(read_ply_header("ply\nformat ascii 1.0\nelement e -1\nend_header\n"));
}

}  // namespace
}  // namespace peerd::formats::ply_header_test
