#include "core/x3d/xml_reader.hpp"

#include <gmock/gmock.h>

#include "tests/core/x3d/x3d_fixture.hpp"

namespace peerd::vrml::xml_reader_test {

using testing::HasSubstr;

std::string times(int count, const std::string& text) {
  std::string all;
  for (int i = 0; i < count; ++i) all += text;
  return all;
}

TEST(XmlReader, ReadsWithAndWithoutDeclarationAndDoctype) {
  const ReadResult expected = read_vrml97("Group { }");
  for (const std::string head : {"", "\xEF\xBB\xBF<?xml version='1.0' encoding='UTF-8'?>\n", "\n <!-- a -->\n",
                                 "<?xml version='1.0'?><!DOCTYPE X3D PUBLIC 'a' 'b'>"}) {
    EXPECT_EQ(difference_of(expected, formats::read_file("a.x3d", head + "<X3D><Scene><Group/></Scene></X3D>")), "")
        << head;
  }
}

struct XmlCase {
  const char* name;
  std::string text;
  const char* error;
  std::uint32_t line;
};
class WrongXml : public testing::TestWithParam<XmlCase> {};
TEST_P(WrongXml, IsOneSentence) {
  const ReadResult result = formats::read_file("a.x3d", GetParam().text);
  EXPECT_THAT(error_of(result), HasSubstr(GetParam().error));
  EXPECT_EQ(result.diagnostics.at(0).where.line, GetParam().line);
}
INSTANTIATE_TEST_SUITE_P(
    Table, WrongXml,
    testing::Values(XmlCase{"Tags", "<X3D>\n<Scene>\n</X3D>", "no well-formed XML: start-end tags mismatch", 3},
                    XmlCase{"End", "<X3D>\n<Scene a='", "no well-formed XML", 2},
                    XmlCase{"TwoRoots", "<X3D><Scene/></X3D>\n<X3D/>", "there is a second root", 2},
                    XmlCase{"OtherRoot", "<html/>", "this XML is no X3D: its root is 'html'", 1},
                    XmlCase{"NoScene", "<X3D/>", "this X3D has no Scene", 1},
                    XmlCase{"Encoding", "<?xml version='1.0' encoding='ISO-8859-1'?><X3D/>", "only UTF-8 is read", 1},
                    XmlCase{"Nul", std::string("<X3D>\n\0</X3D>", 13), "no XML contains this byte", 2},
                    XmlCase{"Control", "<X3D>\x01</X3D>", "no XML contains this byte", 1},
                    XmlCase{"EntityBomb",
                            "<!DOCTYPE X3D [<!ENTITY a '1 1'><!ENTITY b "
                            "'&a;&a;'>]>\n<X3D><Scene><Shape><Box\nsize='&b;'/></Shape></Scene></X3D>",
                            "no entity is known that begins '&b;'", 3},
                    XmlCase{"Cycle", "<X3D><Scene><Group DEF='A'>\n<Group USE='A'/></Group></Scene></X3D>",
                            "a node cannot contain itself", 2},
                    XmlCase{"Number", "<X3D><Scene><Shape>\n<Sphere radius='1e400'/></Shape></Scene></X3D>",
                            "'1e400' is too large", 2},
                    XmlCase{"NumberInAList",
                            "<X3D><Scene><Shape><PointSet><Coordinate point='0 0 0\r\n1 1 1\r\n1 1e99 "
                            "1'/></PointSet></Shape></Scene></X3D>",
                            "'1e99' is too large", 3},
                    XmlCase{"DeepNodes",
                            "<X3D><Scene>" + times(300, "<Group>") + times(300, "</Group>") + "</Scene></X3D>",
                            "nodes are nested more than 256 deep", 1},
                    XmlCase{"DeepElements",
                            "<X3D><Scene>" + times(1000000, "<Group>") + times(1000000, "</Group>") + "</Scene></X3D>",
                            "elements are nested more than 1024 deep", 1},
                    XmlCase{"DeepAndOpen", "<X3D><Scene>" + times(100000, "<Group>"), "no well-formed XML", 1},
                    XmlCase{"ManyElements", "<X3D><Scene>" + times(1000000, "<a/>") + "</Scene></X3D>",
                            "more elements than a file of this size may have; the option expansion allows more", 1},
                    XmlCase{"Index",
                            "<X3D><Scene><Shape><IndexedTriangleSet index='0 1\n7'><Coordinate point='0 0 "
                            "0'/></IndexedTriangleSet></Shape></Scene></X3D>",
                            "index has 1, but coord has 1 points", 1}),
    [](const auto& of) { return std::string(of.param.name); });

TEST(XmlReader, PrototypesThatDoubleAreOneSentence) {
  std::string scene = "<ProtoDeclare name='P0'><ProtoBody><Group/></ProtoBody></ProtoDeclare>";
  for (int i = 0; i < 40; ++i) {
    const std::string inner = "<ProtoInstance name='P" + std::to_string(i) + "'/>";
    scene += "<ProtoDeclare name='P" + std::to_string(i + 1) + "'><ProtoBody><Group>" + inner + inner +
             "</Group></ProtoBody></ProtoDeclare>";
  }
  ReadOptions options;
  options.limits.nodes = 10000;
  const ReadResult result =
      formats::read_file("a.x3d", "<X3D><Scene>" + scene + "<ProtoInstance name='P40'/></Scene></X3D>", {}, options);
  EXPECT_THAT(error_of(result), HasSubstr("more than 10000 nodes"));
}

}  // namespace peerd::vrml::xml_reader_test
