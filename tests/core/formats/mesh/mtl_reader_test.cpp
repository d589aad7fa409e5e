#include "core/formats/mesh/mtl_reader.hpp"

#include <gmock/gmock.h>

#include "tests/core/formats/format_fixture.hpp"

namespace peerd::formats::mtl_reader_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

ReadResult with_materials(const std::string& materials) {
  return read_file("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n", {{"a.mtl", materials}});
}

TEST(Mtl, SaysColoursOpacityAndShine) {
  const ReadResult result = with_materials(
      "# c\nnewmtl m # not a comment\nnewmtl m\nKd 0.5 0 2\nKe 0 1 0\nKs 1 1 1\nTr 0.25\nNs 1000\nillum 2\n");
  ASSERT_TRUE(result.scene);
  const vrml::Document& document = *result.scene->document;
  EXPECT_THAT(vrml::floats_of(document, "Material", "diffuseColor"), ElementsAre(ElementsAre(0.5F, 0, 1)));
  EXPECT_THAT(vrml::floats_of(document, "Material", "emissiveColor"), ElementsAre(ElementsAre(0, 1, 0)));
  EXPECT_THAT(vrml::floats_of(document, "Material", "transparency"), ElementsAre(ElementsAre(0.25F)));
  EXPECT_THAT(vrml::floats_of(document, "Material", "shininess"), ElementsAre(ElementsAre(1)));
}

TEST(Mtl, NamesWhatIsNotShown) {
  EXPECT_THAT(warnings_of(with_materials("newmtl m\nPr 0.5\nPr 1\nmap_Kd -s 2 2 2 a.png\nKd red\n")),
              ElementsAre(HasSubstr("'Pr'"), HasSubstr("'map_Kd'"), HasSubstr("'Kd'")));
  EXPECT_THAT(error_of(with_materials("Kd 1 0 0\n")), HasSubstr("expected newmtl"));
}

TEST(Mtl, NamesValuesThatVrmlCannotSay) {
  EXPECT_THAT(warnings_of(with_materials("newmtl m\nKd 2 0 0\nKs 0 -1 0\nNs 1000\nNs 500\nd 1.5\n")),
              ElementsAre(HasSubstr("'Kd' is outside of a Material's range, and is clamped"), HasSubstr("'Ks'"),
                          HasSubstr("'Ns'"), HasSubstr("'d'")));
  EXPECT_THAT(warnings_of(with_materials("newmtl m\nKd 1 0 0\nNs 128\nd 1\nTr 0\n")), testing::IsEmpty());
  EXPECT_THAT(warnings_of(with_materials("newmtl m\nKd 1 0 0 1\nNs 1 2\n")),
              ElementsAre(HasSubstr("'Kd'"), HasSubstr("'Ns'")));
}

TEST(Mtl, OfManyUnknownStatementsTheLastNamedOneStandsForTheRest) {
  std::string text = "newmtl m\n";
  for (int i = 0; i < 60; ++i) text += "word" + std::to_string(i % 30) + " 1\n";
  const auto warnings = warnings_of(with_materials(text));
  ASSERT_EQ(warnings.size(), 21U);
  EXPECT_THAT(warnings[20], HasSubstr("what 'word20' and others say"));
}

TEST(Mtl, AnImageOfSeveralMaterialsIsThereOnce) {
  const ReadResult result =
      read_file("a.obj",
                "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\nusemtl "
                "n\nf 1/1 2/1 3/1\n",
                {{"a.mtl", "newmtl m\nmap_Kd a.png\nnewmtl n\nmap_Kd a.png\nKs 1 1 1\n"}, {"a.png", "\x89PNG..."}});
  ASSERT_TRUE(result.scene);
  EXPECT_EQ(vrml::nodes_of_type(*result.scene->document, "Appearance").size(), 2U);
  EXPECT_EQ(vrml::nodes_of_type(*result.scene->document, "ImageTexture").size(), 1U);
}

}  // namespace
}  // namespace peerd::formats::mtl_reader_test
