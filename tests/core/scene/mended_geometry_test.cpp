#include "core/scene/mended_geometry.hpp"

#include <gmock/gmock.h>

#include "core/parser/parser.hpp"
#include "core/scene/reader.hpp"

namespace peerd::mended_geometry_test {

using testing::ElementsAre;
using testing::HasSubstr;

// A world of one geometry node, read leniently.
struct Mended {
  explicit Mended(const std::string& geometry)
      : text("#VRML V2.0 utf8\nShape { geometry " + geometry + " }"),
        document(vrml::parse({"w.wrl", text, nullptr}, problems)) {
    vrml::mend_geometry(*document, problems);
  }

  template <class T>
  [[nodiscard]] std::vector<T> values(std::string_view type, std::string_view field) const {
    const auto node = std::ranges::find(document->nodes, type, [](const vrml::Node& n) { return n.type->name; });
    const auto elements = node->find(field)->template as<T>();
    return {elements.begin(), elements.end()};
  }

  std::string text;
  vrml::Problems problems{true};
  std::shared_ptr<vrml::Document> document;
};

Mended faces(const std::string& corners) {
  return Mended("IndexedFaceSet { coord Coordinate { point [ 0 0 0 1 0 0 0 1 0 ] } coordIndex [ " + corners + " ] }");
}

TEST(MendedGeometry, KeepsThePlaceOfEachCornerAndTheNumberOfEachPolygon) {
  EXPECT_THAT(faces("9 0 1 -1 -7 -1 0 8 2 -1").values<std::int32_t>("IndexedFaceSet", "coordIndex"),
              ElementsAre(0, 0, 1, -1, 0, -1, 0, 0, 2, -1));
}

TEST(MendedGeometry, SaysWhichIndexAndHowManyMore) {
  Mended mended = faces("0 1 9 -1 8 7 1");
  const auto report = mended.problems.take();
  ASSERT_EQ(report.diagnostics.size(), 1u);
  EXPECT_THAT(report.diagnostics[0].message, HasSubstr("coordIndex 9 is out of range"));
  EXPECT_THAT(report.diagnostics[0].message, HasSubstr("and 2 more of this list are"));
}

TEST(MendedGeometry, LeavesASetWithoutPointsToItsReader) {
  const Mended mended("IndexedFaceSet { coordIndex [ 0 1 2 ] }");
  EXPECT_EQ(mended.problems.faults(), 0u);
}

TEST(MendedGeometry, LeavesAGridWithoutHeightsToItsReader) {
  const Mended mended("ElevationGrid { xDimension 2 zDimension 2 }");
  EXPECT_EQ(mended.problems.faults(), 0u);
}

TEST(MendedGeometry, MakesUpNoMillionsOfHeights) {
  const std::string_view world =
      "#VRML V2.0 utf8\nShape { geometry ElevationGrid { xDimension 2000 zDimension 2000 height [ 1 2 ] } }";
  for (const bool lenient : {false, true}) {
    const ReadResult read = read_world(world, {.lenient = lenient});
    ASSERT_EQ(read.diagnostics.size(), 1U);
    EXPECT_EQ(read.diagnostics[0].severity, Severity::kError);
    EXPECT_FALSE(read.diagnostics[0].is_fault) << "--lenient would not help";
  }
}

TEST(MendedGeometry, GivesAnExtrusionOfNoScalesTheDefault) {
  const Mended mended("Extrusion { spine [ 0 0 0 0 1 0 0 2 0 ] scale [ ] }");
  EXPECT_THAT(mended.values<float>("Extrusion", "scale"), ElementsAre(1, 1));
}

}  // namespace peerd::mended_geometry_test
