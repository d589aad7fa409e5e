// The keys of the table [transport] that begin with `nats`.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "peerd/peer/config/peer_settings.hpp"
#include "peerd/peer/config/scenario.hpp"
#include "peerd/peer/config/shared_settings.hpp"
#include "tests/must.hpp"

namespace peerd::config::read_nats_test {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

// The table [transport], or its error.
Result<net::TransportSettings> read(const std::string& text) {
  const toml::table table = toml::parse(text);
  std::optional<InputError> error;
  net::TransportSettings settings = read_transport(TomlReader(table, "transport", error));
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
  const net::NatsSettings& nats = settings->nats;
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
  const auto scenario = must(read_scenario(request));
  const RunSettings& run = scenario.runs.front();
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

}  // namespace peerd::config::read_nats_test
