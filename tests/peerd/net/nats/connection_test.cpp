// The library's connection by itself; what a peer does with it is in nats_transport_test.cpp.
#include "peerd/net/nats/connection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"
#include "tests/net/listener.hpp"
#include "tests/peerd/net/nats/nats_server.hpp"

namespace peerd::nats::connection_test {

using net::testing_support::bytes_of;
using net::testing_support::clock;
using peerd::testing_support::NatsServer;
using peerd::testing_support::ScratchFolder;
using testing::HasSubstr;

struct ConnectionTest : testing::Test {
  void SetUp() override {
    if (!peerd::testing_support::has_nats_server()) GTEST_SKIP() << "nats-server is not installed";
  }
  [[nodiscard]] static NatsOptions by(const std::string& server) {
    NatsOptions options;
    options.settings.servers = {server};
    options.world = "town";
    return options;
  }
  ScratchFolder folder;
  boost::asio::io_context io;
  std::shared_ptr<Mailbox> mailbox = std::make_shared<Mailbox>(io, clock(), 1 << 20);
  std::shared_ptr<ConnectionState> state = std::make_shared<ConnectionState>();
};

TEST_F(ConnectionTest, IsUpAndShowsItsServerWithoutThePassword) {
  NatsServer server(folder, "server", "authorization { user: u, password: p }\n");
  const auto connection = must(Connection::open(by(server.url("u:p")), mailbox, state));
  EXPECT_TRUE(state->is_up());
  EXPECT_EQ(connection->server(), server.url());
  EXPECT_EQ(connection->subscribe(RegionId{3}), NATS_OK);
  EXPECT_EQ(connection->subscribe(RegionId{3}), NATS_OK) << "without effect";
  EXPECT_EQ(connection->publish(RegionId{3}, bytes_of("text")), NATS_OK);
  EXPECT_EQ(connection->unsubscribe(RegionId{3}), NATS_OK);
  EXPECT_EQ(connection->unsubscribe(RegionId{3}), NATS_OK) << "without effect";
  EXPECT_EQ(connection->thrown_away(), 0u);
}

TEST_F(ConnectionTest, TellsARefusalFromASilence) {
  NatsServer server(folder, "server", "authorization { user: u, password: p }\n");
  const auto refused = error_of(Connection::open(by(server.url()), mailbox, state));
  EXPECT_TRUE(refused.is_final);
  EXPECT_EQ(refused.error.kind, net::NetError::Kind::kPermission);
  server.kill();
  const auto silent = error_of(Connection::open(by(server.url()), mailbox, state));
  EXPECT_FALSE(silent.is_final);
  EXPECT_THAT(silent.error.sentence, HasSubstr("no NATS server answers at " + server.url()));
  EXPECT_FALSE(state->is_up());
}

}  // namespace peerd::nats::connection_test
