#include "core/parser/included_file.hpp"

#include <gmock/gmock.h>

#include "tests/core/parser/text_fixture.hpp"

namespace peerd::vrml::included_file_test {

using testing::ElementsAre;
using testing::IsEmpty;

struct Files : TextFixture {
  Files() : TextFixture("first") {
    options.load = [this](std::string_view url, std::string_view base) -> std::expected<LoadedFile, std::string> {
      ++loads;
      last_base = base;
      if (url == "none.wrl") return std::unexpected("no such file");
      return LoadedFile{std::string(url), url == "bad.wrl" ? "no world" : "#VRML V2.0 utf8\nGroup { }"};
    };
  }
  ParseContext::File* open(std::string_view url) {
    why.clear();
    return open_file(state, url, 0, why);
  }
  int loads = 0;
  std::string last_base, why;
};

TEST(OpenFile, AddsTheFileToThoseThatAreOpen) {
  Files f;
  ParseContext::File* const file = f.open("a.wrl");
  ASSERT_NE(file, nullptr);
  EXPECT_THAT(f.context.open_files, ElementsAre("a.wrl"));
  EXPECT_EQ(f.last_base, "text.wrl");
  f.context.open_files.pop_back();
  EXPECT_EQ(f.open("a.wrl"), file);  // a file is one however often it is named
  EXPECT_THAT(f.messages(), IsEmpty());
}

}  // namespace peerd::vrml::included_file_test
