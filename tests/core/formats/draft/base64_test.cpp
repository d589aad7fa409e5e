#include "core/formats/draft/base64.hpp"

#include <gtest/gtest.h>

namespace peerd::formats::base64_test {
namespace {

TEST(Base64, IsThatOfItsStandard) {  // RFC 4648, 10
  for (const auto& [bytes, text] :
       {std::pair{"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}}) {
    EXPECT_EQ(base64_encoded(bytes), text);
    EXPECT_EQ(base64_decoded(text), bytes);
  }
  EXPECT_EQ(base64_decoded("Zg"), "f");
  EXPECT_FALSE(base64_decoded("Z"));
  EXPECT_FALSE(base64_decoded("Zm 9v"));
}

TEST(Base64, AUrlOfDataIsItsBytes) {
  EXPECT_EQ(bytes_of_data_url(data_url("image/png", "\x89PNG")), "\x89PNG");
  EXPECT_EQ(bytes_of_data_url("data:;base64,Zm9v"), "foo");
  EXPECT_EQ(bytes_of_data_url("data:text/plain,f%6Fo+=%00"), std::string("foo+=\0", 6));
  for (const char* const bad :
       {"data:text/plain,%6", "data:,%", "data:,%g0", "data:,%+1", "data:;base64,A*", "data:x"}) {
    EXPECT_FALSE(bytes_of_data_url(bad)) << bad;
  }
  EXPECT_FALSE(bytes_of_data_url("foo.png"));
}

}  // namespace
}  // namespace peerd::formats::base64_test
