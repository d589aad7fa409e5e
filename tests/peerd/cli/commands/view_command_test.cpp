#include "peerd/cli/commands/view_command.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iostream>
#include <sstream>
#include <string>

#include "peerd/cli/lab/view_recorded.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::view_command_test {

using testing::HasSubstr;
using testing_support::ScratchFolder;

struct Said {
  int code;
  std::string error;
};

Said view(const ViewOptions& options) {
  std::ostringstream text;
  std::streambuf* const before = std::cerr.rdbuf(text.rdbuf());
  const int code = run_view(options, view_recorded);
  std::cerr.rdbuf(before);
  return {code, text.str()};
}

// A recording is shown until a signal comes: tests/browser/recorded_page_test.mjs asks for that.
TEST(View, SaysWhyThereIsNothingToShow) {
  const ScratchFolder folder;
  const Said nothing = view({.what = folder / "nothing", .listen = "127.0.0.1:0"});
  EXPECT_EQ(nothing.code, 2);
  EXPECT_THAT(nothing.error, HasSubstr("there is no "));
  const Said empty = view({.what = folder.path(), .listen = "127.0.0.1:0"});
  EXPECT_EQ(empty.code, 2);
  EXPECT_THAT(empty.error, HasSubstr("it is no output folder of peerd sim"));
  const Said text = view({.what = folder.write("a.txt", "text"), .listen = "127.0.0.1:0"});
  EXPECT_EQ(text.code, 1);
  EXPECT_THAT(text.error, HasSubstr("this is no pcapng file"));
  const Said beyond = view({.what = folder.path(), .listen = "192.0.2.1:0"});
  EXPECT_NE(beyond.code, 0) << "other computers are not served";
}

}  // namespace peerd::view_command_test
