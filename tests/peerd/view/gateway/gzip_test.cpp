#include "peerd/view/gateway/gzip.hpp"

#include <gtest/gtest.h>

namespace peerd::gateway::gzip_test {

// What gzip(1) of GNU makes of "hello\n" and of nothing, without a name and a time.
TEST(Gzip, UnpacksWhatTheBuildHasPacked) {
  const std::string hello(
      "\x1f\x8b\x08\x00\x00\x00\x00\x00\x00\x03\xcb\x48\xcd\xc9\xc9\xe7\x02\x00\x20\x30\x3a\x36\x06\x00\x00\x00", 26);
  EXPECT_EQ(gunzip(hello), "hello\n");
  const std::string nothing("\x1f\x8b\x08\x00\x00\x00\x00\x00\x00\x03\x03\x00\x00\x00\x00\x00\x00\x00\x00\x00", 20);
  EXPECT_EQ(gunzip(nothing), "");
}

}  // namespace peerd::gateway::gzip_test
