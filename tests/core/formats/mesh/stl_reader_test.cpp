#include "core/formats/mesh/stl_reader.hpp"

#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/mixed_bits.hpp"
#include "tests/core/formats/format_fixture.hpp"

namespace peerd::formats::stl_reader_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kTwoSolids =
    "solid left hand\n"
    "facet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1 0 0\n vertex 0 1e0 0\n endloop\nendfacet\n"
    "facet normal nan 0 1\n outer loop\n vertex 1 0 0\n vertex +1 1 -0\n vertex 0 1 0\n endloop\nendfacet\n"
    "endsolid left hand\n"
    "solid\nfacet normal 0 0 1 outer loop vertex 0 0 2 vertex 1 0 2 vertex 1 1 2 vertex 0 1 2 endloop endfacet\n"
    "endsolid\n";

std::string binary(std::uint32_t facets, std::uint16_t attribute = 0) {
  std::string bytes(80, ' ');
  append(bytes, facets);
  for (std::uint32_t f = 0; f < facets; ++f) {
    for (int i = 0; i < 3; ++i) append(bytes, 0.0F);
    for (int corner = 0; corner < 3; ++corner) {
      append(bytes, static_cast<float>(corner == 1));
      append(bytes, static_cast<float>(corner == 2));
      append(bytes, static_cast<float>(f));
    }
    append(bytes, attribute);
  }
  return bytes;
}

TEST(StlText, EachSolidIsATransformOfItsNameAndEachFacetAPolygon) {
  const ReadResult result = read_file("a.stl", kTwoSolids);
  const auto shapes = shapes_of(result);
  ASSERT_EQ(shapes.size(), 2U);
  EXPECT_EQ(result.scene->instances[0].def, "left hand");
  EXPECT_THAT(shapes[0].polygons, ElementsAre(ElementsAre(0, 1, 2), ElementsAre(1, 3, 2)));  // equal corners are one
  EXPECT_EQ(shapes[0].points.size(), 4U);
  EXPECT_THAT(shapes[1].polygons, ElementsAre(ElementsAre(0, 1, 2, 3)));
  EXPECT_EQ(shapes[1].points[2], Vec3(1, 1, 2));
}

TEST(StlText, SaysWhereItIsWrong) {
  const ReadResult result = read_file("a.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 zero 0\n");
  EXPECT_EQ(error_of(result), "expected a coordinate, found 'zero'");
  EXPECT_EQ(result.diagnostics[0].where.line, 4U);
  EXPECT_EQ(error_of(read_file("a.stl", "solid\nfacet normal 0 0 1 outer loop vertex 0 0 0")),
            "expected 'vertex' or 'endloop', found the end of the file");
  EXPECT_THAT(error_of(read_file("a.stl", "solid\nfacet normal 0 0 1 outer loop vertex 1e39 0 0")),
              HasSubstr("binary32"));
}

TEST(StlBinary, HasItsFacetsAndNamesItsAttributes) {
  const auto shapes = shapes_of(read_file("a.stl", binary(3)));
  ASSERT_EQ(shapes.size(), 1U);
  EXPECT_EQ(shapes[0].polygons.size(), 3U);
  EXPECT_EQ(shapes[0].points.size(), 9U);
  EXPECT_EQ(shapes[0].points.back(), Vec3(0, 1, 2));
  EXPECT_THAT(warnings_of(read_file("a.stl", binary(2, 31))),
              ElementsAre(HasSubstr("a.stl: the attribute bytes of 2 facets")));
}

TEST(StlBinary, OfTheWrongLengthIsOneSentence) {
  std::string cut = binary(3);
  cut.pop_back();
  EXPECT_EQ(error_of(read_file("a.stl", cut)), "this STL file of 3 facets must have 234 bytes, and it has 233");
  std::string claims(84, '\xff');
  EXPECT_THAT(error_of(read_file("a.stl", claims)), HasSubstr("4294967295 facets"));
}

// Undoes x ^ (x >> shift).
std::uint64_t without_shift(std::uint64_t x, int shift) {
  std::uint64_t out = x;
  for (int bits = shift; bits < 64; bits += shift) out = x ^ (out >> shift);
  return out;
}
// Returns the number of which mixed_bits() makes `mixed`.
std::uint64_t unmixed(std::uint64_t mixed) {
  std::uint64_t x = without_shift(mixed, 31) * 0x3196'42B2'D24D'8EC3;  // the factors' inverses modulo 2^64
  x = without_shift(x, 27) * 0x96DE'1B17'3F11'9089;
  return without_shift(x, 30);
}

// The PointWelder's hash is the same for all of these points. A search along its table would take minutes.
TEST(StlBinary, PointsThatAHashWouldPutAtOnePlaceCostNoMore) {
  constexpr std::uint32_t kFacets = 130'000;
  std::string bytes(80, ' ');
  append(bytes, kFacets);
  std::uint64_t next = 0;
  for (std::uint32_t f = 0; f < kFacets; ++f) {
    for (int i = 0; i < 3; ++i) append(bytes, 0.0F);
    for (int corner = 0; corner < 3;) {
      const std::uint64_t first_two = unmixed(unmixed(++next << 32));
      const auto x = std::bit_cast<float>(static_cast<std::uint32_t>(first_two));
      const auto y = std::bit_cast<float>(static_cast<std::uint32_t>(first_two >> 32));
      if (!std::isfinite(x) || !std::isfinite(y)) continue;
      for (const float coordinate : {x, y, 0.0F}) append(bytes, coordinate);
      ++corner;
    }
    append(bytes, std::uint16_t{0});
  }
  ASSERT_EQ(mixed_bits(unmixed(12345)), 12345U);
  const ReadResult result = read_file("a.stl", bytes);
  ASSERT_TRUE(result.scene);
  EXPECT_EQ(std::get<FaceSetGeometry>(result.scene->geometries.at(0)).points.size(), 3 * kFacets);
}

TEST(StlBinary, UnitsAndAxesAreConvertedBeforeTheOnlyRounding) {
  ReadOptions options;
  options.conversion = {.metres_per_unit = 0.001, .z_up = true};
  const auto shapes = shapes_of(read_file("a.stl", binary(3), {}, options));
  ASSERT_EQ(shapes.size(), 1U);
  EXPECT_EQ(shapes[0].points.back(), Vec3(0, double{0.002F}, double{-0.001F}));
}

}  // namespace
}  // namespace peerd::formats::stl_reader_test
