#include "peerd/peer/control/pending_lines.hpp"

#include <gtest/gtest.h>

namespace peerd::control::pending_lines_test {

std::vector<std::string> all_of(PendingLines& lines) {
  std::vector<std::string> texts;
  while (!lines.empty()) texts.push_back(lines.take_front().text);
  return texts;
}

TEST(PendingLines, KeepTheirOrder) {
  PendingLines lines;
  EXPECT_TRUE(lines.add_event("e1"));
  lines.add_reply("r");
  EXPECT_TRUE(lines.has_reply());
  EXPECT_TRUE(lines.add_event("e2"));
  EXPECT_EQ(all_of(lines), (std::vector<std::string>{"e1", "r", "e2"}));
  EXPECT_FALSE(lines.has_reply());
}

TEST(PendingLines, EventsBeyondTheLimitAreDroppedAndSaid) {
  PendingLines lines;
  for (std::size_t i = 0; i < PendingLines::kEventsMax; ++i) EXPECT_TRUE(lines.add_event("e"));
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(lines.add_event("lost"));
  lines.add_reply("r");
  EXPECT_EQ(lines.take_front().text, "e");
  EXPECT_TRUE(lines.add_event("after"));
  const auto texts = all_of(lines);
  ASSERT_EQ(texts.size(), PendingLines::kEventsMax - 1 + 3);
  EXPECT_EQ(texts[PendingLines::kEventsMax - 1], "r") << "a reply is never dropped";
  EXPECT_EQ(texts[PendingLines::kEventsMax], R"({"v":1,"event":"dropped","count":3})");
  EXPECT_EQ(texts.back(), "after");
}

TEST(PendingLines, BytesCount) {
  PendingLines lines;
  const std::string half(PendingLines::kEventsMax_bytes / 2, 'x');
  EXPECT_TRUE(lines.add_event(half));
  EXPECT_TRUE(lines.add_event(half));
  EXPECT_FALSE(lines.add_event("x"));
  EXPECT_EQ(lines.take_front().text, half);
  EXPECT_EQ(lines.take_front().text, half);
  EXPECT_EQ(all_of(lines), (std::vector<std::string>{R"({"v":1,"event":"dropped","count":1})"}))
      << "said at the end at last";
  EXPECT_TRUE(lines.add_event("x"));
}

}  // namespace peerd::control::pending_lines_test
