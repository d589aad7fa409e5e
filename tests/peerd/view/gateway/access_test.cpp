#include "peerd/view/gateway/access.hpp"

#include <gtest/gtest.h>

#include <set>

namespace peerd::gateway::access_test {

struct HostCase {
  const char* host;
  bool own;
};
class OwnHost : public testing::TestWithParam<HostCase> {};
TEST_P(OwnHost, IsAnAddressOrLocalhostWithItsPort) {
  EXPECT_EQ(is_own_host(GetParam().host, 8080), GetParam().own) << GetParam().host;
}
INSTANTIATE_TEST_SUITE_P(
    Table, OwnHost,
    testing::Values(HostCase{"127.0.0.1:8080", true}, HostCase{"192.168.1.7:8080", true}, HostCase{"[::1]:8080", true},
                    HostCase{"localhost:8080", true}, HostCase{"LocalHost:8080", true}, HostCase{"localhost", false},
                    HostCase{"127.0.0.1", false}, HostCase{"127.0.0.1:8081", false}, HostCase{"127.0.0.1:08080", false},
                    HostCase{"127.0.0.1:8080 ", false}, HostCase{"attacker.example:8080", false},
                    HostCase{"localhost.attacker.example:8080", false}, HostCase{"127.0.0.1.nip.io:8080", false},
                    HostCase{"localhost.:8080", false}, HostCase{"::1:8080", false},
                    HostCase{"[127.0.0.1]:8080", false}, HostCase{"[::1]", false},
                    HostCase{"user@127.0.0.1:8080", false}, HostCase{"0x7f.1:8080", false}, HostCase{"", false},
                    HostCase{":8080", false}, HostCase{"[]:8080", false}, HostCase{":", false}));

TEST(OwnHost, LeavesOutThePortOfHttp) {
  EXPECT_TRUE(is_own_host("127.0.0.1", 80));
  EXPECT_TRUE(is_own_host("[::1]", 80));
  EXPECT_TRUE(is_own_host("localhost:80", 80));
  EXPECT_FALSE(is_own_host("example.com", 80));
}

TEST(OwnOrigin, IsThePageOfThatHost) {
  EXPECT_TRUE(is_own_origin("http://127.0.0.1:8080", "127.0.0.1:8080"));
  EXPECT_TRUE(is_own_origin("http://LOCALHOST:8080", "localhost:8080"));
  for (const char* other : {"https://127.0.0.1:8080", "http://127.0.0.1:8081", "http://localhost:8080", "null", "",
                            "http://127.0.0.1:8080.attacker.example", "http://127.0.0.1:8080/", "file://"}) {
    EXPECT_FALSE(is_own_origin(other, "127.0.0.1:8080")) << other;
  }
}

TEST(Origin, IsASchemeAHostAndAPort) {
  for (const char* good : {"http://localhost:5173", "https://a.example", "http://[::1]:80"}) {
    EXPECT_TRUE(is_origin(good)) << good;
  }
  for (const char* wrong : {"", "null", "*", "http://", "https://", "localhost:5173", "http://localhost:5173/",
                            "file://", "http://A.example", "http://a b", "http://a?b", "http://*.example"}) {
    EXPECT_FALSE(is_origin(wrong)) << wrong;
  }
}

TEST(Token, IsRandomAndCompared) {
  std::set<std::string> tokens;
  for (int i = 0; i < 100; ++i) tokens.insert(make_token());
  EXPECT_EQ(tokens.size(), 100U);
  const std::string token = *tokens.begin();
  EXPECT_EQ(token.size(), 22U) << "128 bits in base64url";
  EXPECT_EQ(token.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_"),
            std::string::npos);
  EXPECT_TRUE(is_token(token, token));
  for (std::size_t i = 0; i < token.size(); ++i) {
    std::string other = token;
    other[i] = other[i] == 'A' ? 'B' : 'A';
    EXPECT_FALSE(is_token(other, token)) << i;
  }
  EXPECT_FALSE(is_token("", token));
  EXPECT_FALSE(is_token(token.substr(1), token));
  EXPECT_FALSE(is_token(token + "A", token));
  EXPECT_FALSE(is_token("", "")) << "no token lets nobody in";
}

TEST(Token, ComesWithTheBearerScheme) {
  EXPECT_EQ(bearer_token("Bearer abc"), "abc");
  EXPECT_EQ(bearer_token("bearer abc"), "abc");
  for (const char* other : {"", "abc", "Basic abc", "Bearer", "Bearerabc"}) EXPECT_EQ(bearer_token(other), "") << other;
}

}  // namespace peerd::gateway::access_test
