#include "peerd/net/settings/nats_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"

namespace peerd::net::nats_settings_test {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

struct Case {
  const char *name, *text;
  const char* shown;  // or what is wrong with it
};

class GoodUrl : public testing::TestWithParam<Case> {};
TEST_P(GoodUrl, IsShownWithoutUser) { EXPECT_EQ(must(parse_server_url(GetParam().text)).shown(), GetParam().shown); }
INSTANTIATE_TEST_SUITE_P(Table, GoodUrl,
                         testing::Values(Case{"Host", "nats://host", "nats://host:4222"},
                                         Case{"Port", "nats://host:4000", "nats://host:4000"},
                                         Case{"Tls", "tls://host.example", "tls://host.example:4222"},
                                         Case{"User", "nats://u:p@w@host:1", "nats://host:1"},
                                         Case{"V6", "nats://[2001:db8::7]", "nats://[2001:db8::7]:4222"},
                                         Case{"V6Port", "nats://t@[::1]:65535", "nats://[::1]:65535"}),
                         [](const auto& test) { return std::string(test.param.name); });

class BadUrl : public testing::TestWithParam<Case> {};
TEST_P(BadUrl, IsNamedWithoutItsPassword) {
  EXPECT_THAT(error_of(parse_server_url(GetParam().text)),
              AllOf(HasSubstr(GetParam().shown), Not(HasSubstr("secret"))));
}
INSTANTIATE_TEST_SUITE_P(
    Table, BadUrl,
    testing::Values(Case{"Empty", "", "begin with nats://"}, Case{"Scheme", "http://host", "begin with nats://"},
                    Case{"NoHost", "nats://", "no host"}, Case{"UserOnly", "nats://u:secret@", "no host"},
                    Case{"Blank", "nats://a host", "no host"}, Case{"Path", "nats://host/secret", "no host"},
                    Case{"Two", "nats://a,nats://b", "no host"}, Case{"Bracket", "nats://[::1", "bracket"},
                    Case{"AfterBracket", "nats://[::1]x", "port"}, Case{"Port0", "nats://host:0", "port"},
                    Case{"PortHuge", "nats://host:65536", "port"}, Case{"PortText", "nats://host:4x", "port"},
                    Case{"PortNone", "nats://host:", "port"}, Case{"BareV6", "nats://2001:db8::7", "port"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(IsSubject, TakesTokensWithDots) {
  for (const char* good : {"peerd", "a.b-c.D_9"}) EXPECT_TRUE(is_subject(good)) << good;
  for (const char* bad : {"", ".", "a.", ".a", "a..b", "a b", "a.*", ">", "\xc3\xa4"})
    EXPECT_FALSE(is_subject(bad)) << bad;
}

}  // namespace peerd::net::nats_settings_test
