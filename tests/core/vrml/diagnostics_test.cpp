#include "core/vrml/diagnostics.hpp"

#include <gtest/gtest.h>

#include "tests/core/read_text.hpp"

namespace peerd::diagnostics_test {

std::string rendered(const std::string& text) {
  std::string out;
  ReadOptions options;
  options.name = "w.wrl";
  const ReadResult result = read_world(text, options);
  for (const Diagnostic& d : result.diagnostics) out += render(result, d);
  return out;
}

TEST(Render, ShowsPlaceLineAndCaret) {
  EXPECT_EQ(rendered("#VRML V2.0 utf8\nTransform {\n  translaton 1 2 3\n}\n"),
            "w.wrl:3:3: error: Transform has no field 'translaton', did you mean 'translation'?\n"
            "  translaton 1 2 3\n"
            "  ^\n");
}

TEST(Render, PointsBehindTheLastLineToo) {
  EXPECT_EQ(rendered("#VRML V2.0 utf8\nDEF A"),
            "w.wrl:2:6: error: expected a node type, found the end of the file\n"
            "DEF A\n"
            "     ^\n");
}

TEST(Render, MarksWarnings) {
  EXPECT_EQ(rendered("#VRML V2.0 utf8\nTransform { scale -1 1 1 }"),
            "w.wrl:2:19: warning: a scale of 0 or less is outside VRML97; it is applied as written\n"
            "Transform { scale -1 1 1 }\n"
            "                  ^\n");
}

TEST(Render, CutsLongLinesAndHidesControlBytes) {
  const std::string text = "#VRML V2.0 utf8\n" + std::string(100000, ' ') + "\x01" + std::string(100000, ' ');
  const std::string out = rendered(text);
  EXPECT_LT(out.size(), 500u);
  EXPECT_TRUE(out.starts_with("w.wrl:2:100001: error: '?' cannot stand here")) << out;
  EXPECT_EQ(out.find('\x01'), std::string::npos);
}

TEST(Render, PointsAtTheFirstByteToo) {
  EXPECT_EQ(rendered("Group { }"),
            "w.wrl:1:1: error: the first line must begin with '#VRML V2.0 utf8', exactly so\nGroup { }\n^\n");
  EXPECT_EQ(rendered(""), "w.wrl:1:1: error: the file is empty; a world begins with the line '#VRML V2.0 utf8'\n\n^\n");
}

// Lines end with LF, CR or CR LF (4.3.1 has them all as line terminators); columns are bytes.
TEST(Locations, CountLinesOfAllThreeKinds) {
  EXPECT_EQ(rendered("#VRML V2.0 utf8\r\nGroup { }\r\n\r\n Shpae { }\r\n"),
            "w.wrl:4:2: error: unknown node type 'Shpae', did you mean 'Shape'?\n Shpae { }\n ^\n");
  EXPECT_EQ(rendered("#VRML V2.0 utf8\rGroup { }\r\r Shpae { }\r"),
            "w.wrl:4:2: error: unknown node type 'Shpae', did you mean 'Shape'?\n Shpae { }\n ^\n");
  EXPECT_EQ(rendered("#VRML V2.0 utf8\n\r\n\r\rShpae { }\n\r"),
            "w.wrl:5:1: error: unknown node type 'Shpae', did you mean 'Shape'?\nShpae { }\n^\n");
}

TEST(Locations, CountLinesInStringsAndComments) {
  EXPECT_EQ(problems_of("WorldInfo { title \"a\nb\r\nc\" } # x\rShpae { }"),
            (std::vector<std::string>{"5:1: unknown node type 'Shpae', did you mean 'Shape'?"}));
}

TEST(Locations, CountUtf8InBytesAndShowItInLetters) {
  EXPECT_EQ(rendered("#VRML V2.0 utf8\nDEF \xE2\x82\xAC\xF0\x9F\x98\x80 Grop { }"),
            "w.wrl:2:13: error: unknown node type 'Grop', did you mean 'Group'?\n"
            "DEF \xE2\x82\xAC\xF0\x9F\x98\x80 Grop { }\n       ^\n");
}

TEST(Locations, AreFoundByABruteForceCount) {
  const std::string text = "#VRML V2.0 utf8\n x\r y\r\n\n  z w\r\rv \n\r u";
  for (const Diagnostic& d : read_world(text).diagnostics) {
    std::uint32_t line = 1, column = 1;
    for (std::size_t i = 0; i < d.offset; ++i) {
      const bool ends = text[i] == '\n' || (text[i] == '\r' && (i + 1 == text.size() || text[i + 1] != '\n'));
      line += ends ? 1 : 0;
      column = ends ? 1 : column + 1;
    }
    EXPECT_EQ(d.where.line, line) << d.offset;
    EXPECT_EQ(d.where.column, column) << d.offset;
  }
}

TEST(Problems, KeepTheirTextsApart) {
  const std::string a = "one\ntwo", b = "", c = "\nthree";
  vrml::Problems problems;
  const vrml::Position at_a = problems.open({"a", a, nullptr}).value();
  const vrml::Position at_b = problems.open({"b", b, nullptr}).value();
  const vrml::Position at_c = problems.open({"c", c, nullptr}).value();
  EXPECT_EQ(problems.name_of(at_a + 7), "a") << "behind its last byte";
  EXPECT_EQ(problems.name_of(at_b), "b");
  EXPECT_EQ(problems.text_of(at_c + 3), c);
  problems.error(at_c + 1, "third");
  problems.warning(at_b, "second");
  problems.error(at_a + 4, "first");
  problems.error(at_a + 7, "end");
  const auto report = problems.take();
  ASSERT_EQ(report.diagnostics.size(), 4u);
  const char* const messages[] = {"first", "end", "second", "third"};
  const std::uint32_t sources[] = {0, 0, 1, 2}, lines[] = {2, 2, 1, 2}, columns[] = {1, 4, 1, 1};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(report.diagnostics[i].message, messages[i]);
    EXPECT_EQ(report.diagnostics[i].source, sources[i]);
    EXPECT_EQ(report.diagnostics[i].where.line, lines[i]) << i;
    EXPECT_EQ(report.diagnostics[i].where.column, columns[i]) << i;
  }
}

}  // namespace peerd::diagnostics_test
