#include "peerd/config/nats_settings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "peerd/config/peer_settings.hpp"
#include "peerd/config/scenario.hpp"
#include "peerd/config/shared_settings.hpp"

namespace peerd::config::nats_settings_test {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

struct Case {
  const char* name;
  const char* text;
  const char* shown;  // or what is wrong with it
};

class GoodUrl : public testing::TestWithParam<Case> {};
TEST_P(GoodUrl, IsShownWithoutUser) {
  const auto url = parse_server_url(GetParam().text);
  ASSERT_TRUE(url) << url.error();
  EXPECT_EQ(url->shown(), GetParam().shown);
}
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
  const auto url = parse_server_url(GetParam().text);
  ASSERT_FALSE(url);
  EXPECT_THAT(url.error(), AllOf(HasSubstr(GetParam().shown), Not(HasSubstr("secret"))));
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

// The table [transport], or its error.
Result<TransportSettings> read(const std::string& text) {
  const toml::table table = toml::parse(text);
  std::optional<InputError> error;
  TransportSettings settings = read_transport(TomlReader(table, "transport", error));
  if (error) return std::unexpected(*error);
  return settings;
}

TEST(ReadNats, ReadsAllKeys) {
  const auto settings = read(R"(
nats = ["nats://one:4222", "tls://two"]
nats_subject = "worlds.peerd"
nats_credentials = "peer.creds"
nats_tls_ca = "ca.pem"
nats_tls_cert = "peer.pem"
nats_tls_key = "peer.key"
)");
  ASSERT_TRUE(settings) << settings.error().text;
  const NatsSettings& nats = settings->nats;
  EXPECT_THAT(nats.servers, ElementsAre("nats://one:4222", "tls://two"));
  EXPECT_EQ(nats.subject, "worlds.peerd");
  EXPECT_EQ(nats.credentials, "peer.creds");
  EXPECT_EQ(nats.tls_ca, "ca.pem");
  EXPECT_EQ(nats.tls_cert, "peer.pem");
  EXPECT_EQ(nats.tls_key, "peer.key");
  EXPECT_TRUE(read("")->nats.servers.empty());
}

// Captures and joining peers get these texts.
TEST(ReadNats, NoPasswordIsHandedOn) {
  ScenarioRequest request;
  request.text = R"(
world = "some.wrl"
[transport]
nats = ["nats://user:secret@one", "tls://two:5000"]
nats_subject = "worlds"
[peer.a]
id = 1
)";
  const auto scenario = read_scenario(request);
  ASSERT_TRUE(scenario) << scenario.error().text;
  const RunSettings& run = scenario->runs.front();
  EXPECT_THAT(run.transport.nats.servers, ElementsAre("nats://user:secret@one", "tls://two:5000"));
  EXPECT_THAT(run.toml, AllOf(HasSubstr("nats://one:4222"), Not(HasSubstr("secret"))));
  const std::string shared = shared_settings(run);
  EXPECT_THAT(shared, AllOf(HasSubstr("nats://one:4222"), HasSubstr("tls://two:5000"), HasSubstr("worlds"),
                            Not(HasSubstr("secret"))));
  EXPECT_TRUE(check_shared(shared));
}

TEST(ReadNats, NamesTheKeyThatIsWrong) {
  const auto error = [](const std::string& text) {
    const auto settings = read(text);
    if (settings) return std::string("none");
    EXPECT_EQ(settings.error().exit_code, 2);
    return settings.error().text;
  };
  const std::string server = "nats = [\"nats://host\"]\n";
  EXPECT_THAT(
      error("nats = [\"nats://host\", \"u:secret@host\"]"),
      AllOf(HasSubstr("transport.nats: server 2 of the list is no nats://HOST:PORT"), Not(HasSubstr("secret"))));
  EXPECT_THAT(error("nats = \"nats://host\""), HasSubstr("transport.nats"));
  EXPECT_THAT(error("nats_subject = \"a b\""), HasSubstr("transport.nats_subject"));
  EXPECT_THAT(error(server + "nats_tls_cert = \"a\""), HasSubstr("a certificate needs its key"));
  EXPECT_THAT(error("nats_credentials = \"a\""), HasSubstr("transport.nats_credentials: it is of no use"));
  EXPECT_THAT(error(server + "multicast = \"always\""), HasSubstr("transport.multicast contradicts transport.nats"));
  EXPECT_THAT(error(server + "peers = [\"a:1\"]"), HasSubstr("transport.peers contradicts transport.nats"));
  EXPECT_EQ(error(server + "multicast = \"auto\""), "none");
  EXPECT_EQ(error(server + "multicast = \"never\""), "none");
}

}  // namespace peerd::config::nats_settings_test
