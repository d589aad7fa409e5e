#include "peerd/cli/program/help_topics.hpp"

#include <gmock/gmock.h>

#include "tests/peerd/cli/program/program.hpp"

namespace peerd::help_topics_test {

using testing::HasSubstr;
using testing_support::Program;

constexpr HelpPage kPages[] = {{"wifi", "# Over Wi-Fi\nSlow.\n"}, {"vpn", "# Through a VPN\n"}};

TEST(HelpTopics, ArePlainTextInATerminal) {
  EXPECT_EQ(
      plain_text_of("# Title\nSee [the log](log.md) and **do** a[1] (x).\n<!-- note -->\n```sh\n$ a [b](c)\n```\nEnd"),
      "# Title\nSee the log and do a[1] (x).\n    $ a [b](c)\nEnd\n");
}

TEST(HelpTopics, AreListedWithTheirTitles) {
  EXPECT_EQ(list_of_topics(kPages), "  wifi                Over Wi-Fi\n  vpn                 Through a VPN\n");
}

TEST(HelpTopics, AreFoundByName) {
  EXPECT_EQ(help_on("wifi", kPages), "# Over Wi-Fi\nSlow.\n");
  EXPECT_EQ(help_on("wify", kPages), std::nullopt);
}

TEST_F(Program, HelpHasTheHowToPages) {
  const std::string topics = run("help topics").out;
  ASSERT_FALSE(help_pages().empty());
  for (const HelpPage& page : help_pages()) {
    EXPECT_THAT(topics, HasSubstr("  " + std::string(page.name) + " "));
    EXPECT_EQ(run("help " + std::string(page.name)).out, plain_text_of(page.text));
  }
  EXPECT_EQ(run("help nonsense").exit_code, 2);
}

}  // namespace peerd::help_topics_test
