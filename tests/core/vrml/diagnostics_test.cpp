#include "core/vrml/diagnostics.hpp"

#include <gtest/gtest.h>

#include "tests/core/read_text.hpp"

namespace peerd {
namespace {

std::string rendered(const std::string& text) {
  std::string out;
  for (const Diagnostic& d : read_world(text).diagnostics) out += render(d, "w.wrl", text);
  return out;
}

TEST(Render, ShowsPlaceLineAndCaret) {
  EXPECT_EQ(rendered("#VRML V2.0 utf8\nTransform {\n  translaton 1 2 3\n}\n"),
            "w.wrl:3:3: error: Transform has no field 'translaton', did you mean 'translation'?\n"
            "  translaton 1 2 3\n"
            "  ^\n");
}

TEST(Render, PutsTheCaretBehindTabsAndWideLetters) {
  EXPECT_EQ(rendered("#VRML V2.0 utf8\n\tDEF \xC3\xA4 Shpae {}\n"),
            "w.wrl:2:9: error: unknown node type 'Shpae', did you mean 'Shape'?\n"
            "\tDEF \xC3\xA4 Shpae {}\n"
            "\t      ^\n");
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

TEST(Problems, StopAtTheirLimitAndSaySo) {
  std::string body;
  for (int i = 0; i < 5000; ++i) body += "Grop {}\n";
  const auto problems = problems_of(body);
  ASSERT_EQ(problems.size(), vrml::Problems::kLimit);
  EXPECT_EQ(problems[998], "1000:1: unknown node type 'Grop', did you mean 'Group'?");
  EXPECT_TRUE(problems.back().ends_with("the reader stops here, after 1000 errors")) << problems.back();
}

}  // namespace
}  // namespace peerd
