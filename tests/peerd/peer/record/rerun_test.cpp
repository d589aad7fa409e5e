#include "peerd/peer/record/rerun.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/must.hpp"

namespace peerd::record::rerun_test {

using testing::ElementsAre;
using testing::HasSubstr;

Rerun some_rerun() {
  return {.name = "eq47",
          .file = "/there/eq47.toml",
          .world = "/there/eq47.wrl",
          .world_hash = 0xFFFF'FFFF'FFFF'FFFE,
          .reading = {.inlines_when_needed = true, .expansion = 4, .name = "square"},
          .configurations = {"seed = 1\n", "seed = 2\n"}};
}

TEST(Rerun, IsReadAsItIsWritten) {
  const auto read = must(rerun_from(to_text(some_rerun())));
  EXPECT_EQ(read.name, "eq47");
  EXPECT_EQ(read.file, "/there/eq47.toml");
  EXPECT_EQ(read.world, "/there/eq47.wrl");
  EXPECT_EQ(read.world_hash, 0xFFFF'FFFF'FFFF'FFFE);
  EXPECT_TRUE(read.reading.inlines_when_needed);
  EXPECT_EQ(read.reading.expansion, 4u);
  EXPECT_EQ(read.reading.name, "square");
  EXPECT_THAT(read.configurations, ElementsAre("seed = 1\n", "seed = 2\n"));
}

TEST(Rerun, HostileTextIsRefused) {
  EXPECT_THAT(rerun_from("").error(), HasSubstr("can't be read"));
  EXPECT_THAT(rerun_from("[]").error(), HasSubstr("can't be read"));
  EXPECT_THAT(rerun_from(R"({"format":2})").error(), HasSubstr("it is of format 2"));
  EXPECT_THAT(rerun_from(R"({"format":1})").error(), HasSubstr("can't be read"));
  Rerun none = some_rerun();
  none.configurations.clear();
  EXPECT_EQ(rerun_from(to_text(none)).error(), "it names no run");
  const std::string text = to_text(some_rerun());
  for (std::size_t length = 0; length + 2 < text.size(); ++length) EXPECT_FALSE(rerun_from(text.substr(0, length)));
}

}  // namespace peerd::record::rerun_test
