#include "peerd/net/os/udp_port.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>

#include "tests/must.hpp"
#include "tests/net/listener.hpp"

namespace peerd::net::udp_port_test {

namespace asio = boost::asio;
using asio::ip::udp;
using testing::ElementsAre;
using testing::HasSubstr;

struct Text {
  const char *name, *text;
  const char* address;  // empty: none
  int port;
};
class UdpAddress : public testing::TestWithParam<Text> {};
TEST_P(UdpAddress, IsReadOrRefused) {
  const auto endpoint = parse_udp_address(GetParam().text);
  EXPECT_EQ(endpoint ? endpoint->address().to_string() : "", GetParam().address);
  if (endpoint) {
    EXPECT_EQ(endpoint->port(), GetParam().port);
  }
}
INSTANTIATE_TEST_SUITE_P(
    Table, UdpAddress,
    testing::Values(Text{"PortAlone", "5000", "127.0.0.1", 5000}, Text{"V4", "127.0.0.1:0", "127.0.0.1", 0},
                    Text{"Any", "0.0.0.0:65535", "0.0.0.0", 65535}, Text{"V6", "[::1]:7", "::1", 7},
                    Text{"Nothing", "", "", 0}, Text{"NoPort", "127.0.0.1", "", 0}, Text{"EmptyPort", "::1:", "", 0},
                    Text{"V6WithoutBrackets", "::1:7", "", 0}, Text{"PortTooLarge", "127.0.0.1:65536", "", 0},
                    Text{"PortIsNegative", "127.0.0.1:-1", "", 0}, Text{"PortAndMore", "127.0.0.1:7x", "", 0},
                    Text{"AName", "localhost:7", "", 0}),
    [](const auto& c) { return std::string(c.param.name); });

class UdpPortTest : public testing::Test {
 protected:
  std::unique_ptr<UdpPort> open(const std::string& address) {
    auto port = UdpPort::open(io, address, "key", [this](std::string_view text) { heard.emplace_back(text); });
    if (!port) {
      ADD_FAILURE() << port.error().text;
      return nullptr;
    }
    return std::move(*port);
  }
  bool until(std::size_t count) {
    return net::testing_support::run_until(io, [&] { return heard.size() >= count; });
  }
  asio::io_context io{1};
  udp::socket program{io, udp::v4()};
  std::vector<std::string> heard;
};

TEST_F(UdpPortTest, HearsEveryDatagramWhole) {
  const auto port = open("127.0.0.1:0");
  ASSERT_NE(port->endpoint().port(), 0);
  const std::string longest(65'507, 'x');
  for (const std::string& text : {std::string("one"), std::string(), longest, std::string("two")}) {
    program.send_to(asio::buffer(text), port->endpoint());
  }
  ASSERT_TRUE(until(4));
  EXPECT_THAT(heard, ElementsAre("one", "", longest, "two"));
  EXPECT_EQ(port->counters().datagrams, 4u);
  EXPECT_EQ(port->counters().bytes, 6 + longest.size());
}

TEST_F(UdpPortTest, CountsWhatTheSystemLosesForWantOfRoom) {
  const auto port = open("127.0.0.1:0");
  const std::string large(60'000, 'x');
  for (int i = 0; i < 100; ++i) program.send_to(asio::buffer(large), port->endpoint());
  ASSERT_TRUE(until(1));
  io.restart();
  io.poll();
  const std::size_t before = heard.size();
  ASSERT_LT(before, 100u) << "6 MB fit nowhere";
  program.send_to(asio::buffer(std::string("marker")), port->endpoint());
  ASSERT_TRUE(until(before + 1));
  EXPECT_EQ(heard.back(), "marker");
  EXPECT_EQ(port->counters().lost, 100 - before);
}

TEST_F(UdpPortTest, APortThatIsTakenOrNoAddressIsOneSentence) {
  const auto port = open("127.0.0.1:0");
  const std::string taken = "127.0.0.1:" + std::to_string(port->endpoint().port());
  EXPECT_THAT(error_of(UdpPort::open(io, taken, "peer.a.feed.udp", [](std::string_view) {})),
              IsError(3, HasSubstr("peer.a.feed.udp = \"" + taken + "\": another program listens there")));
  EXPECT_EQ(error_of(UdpPort::open(io, "nonsense", "peer.a.feed.udp", [](std::string_view) {})).exit_code, 2);
}

TEST_F(UdpPortTest, MayGoWhileItListens) {
  auto port = open("127.0.0.1:0");
  const auto endpoint = port->endpoint();
  program.send_to(asio::buffer(std::string("late")), endpoint);
  port.reset();
  io.run();
  EXPECT_TRUE(heard.empty());
}

}  // namespace peerd::net::udp_port_test
