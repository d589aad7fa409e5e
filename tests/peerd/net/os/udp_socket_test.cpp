#include "peerd/net/os/udp_socket.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <boost/asio/io_context.hpp>
#include <cerrno>

#include "tests/must.hpp"

namespace peerd::net::udp_socket_test {

using asio::ip::udp;
using testing::HasSubstr;

int option(const udp::socket& socket, int level, int name) {
  int value = -1;
  socklen_t size = sizeof value;
  EXPECT_EQ(getsockopt(const_cast<udp::socket&>(socket).native_handle(), level, name, &value, &size), 0);
  return value;
}

struct UdpSocket : testing::Test {
  asio::io_context io;
  udp::socket a{io}, b{io};
};

TEST_F(UdpSocket, IsOpenedWithAllThatTheKernelCanTell) {
  ASSERT_TRUE(open_udp(a, {.v4 = true, .dscp = 46, .receive_buffer_bytes = 8192}));
  EXPECT_EQ(option(a, SOL_SOCKET, SO_RXQ_OVFL), 1);
  EXPECT_EQ(option(a, SOL_SOCKET, SO_TIMESTAMPNS), 1);
  EXPECT_EQ(option(a, IPPROTO_IP, IP_PKTINFO), 1);
  EXPECT_EQ(option(a, IPPROTO_IP, IP_TOS), 46 << 2) << "the DSCP is the upper six bits (RFC 2474)";
  EXPECT_NE(fcntl(a.native_handle(), F_GETFL) & O_NONBLOCK, 0);
}

TEST_F(UdpSocket, OfIpv6LeavesIpv4ToOthers) {
  const auto opened = open_udp(a, {.v4 = false, .dscp = 10, .receive_buffer_bytes = 8192});
  if (!opened && opened.error().sentence.find("IPv6 switched off") != std::string::npos) GTEST_SKIP();
  ASSERT_TRUE(opened) << opened.error().sentence;
  EXPECT_EQ(option(a, IPPROTO_IPV6, IPV6_V6ONLY), 1);
  EXPECT_EQ(option(a, IPPROTO_IPV6, IPV6_RECVPKTINFO), 1);
  EXPECT_EQ(option(a, IPPROTO_IPV6, IPV6_TCLASS), 10 << 2);
}

TEST_F(UdpSocket, TheGrantedBufferIsWhatWasAskedUpToTheSystemsLimit) {
  ASSERT_TRUE(open_udp(a, {.v4 = true, .dscp = 0, .receive_buffer_bytes = 16'384}));
  EXPECT_EQ(granted_receive_buffer(a), 16'384);
  ASSERT_TRUE(open_udp(b, {.v4 = true, .dscp = 0, .receive_buffer_bytes = 1 << 30}));
  EXPECT_LT(granted_receive_buffer(b), 1 << 30);
  EXPECT_EQ(granted_receive_buffer(udp::socket(io)), 0) << "a closed socket has none";
}

TEST_F(UdpSocket, APortThatAnotherHoldsIsNamedWithTheAdvice) {
  for (udp::socket* socket : {&a, &b})
    ASSERT_TRUE(open_udp(*socket, {.v4 = true, .dscp = 0, .receive_buffer_bytes = 8192}));
  ASSERT_TRUE(bind_udp(a, 0, ""));
  const std::uint16_t port = a.local_endpoint().port();
  ASSERT_NE(port, 0);
  const auto bound = error_of(bind_udp(b, port, "take another one"));
  EXPECT_EQ(bound.kind, NetError::Kind::kPortBusy);
  EXPECT_THAT(bound.sentence, HasSubstr("UDP port " + std::to_string(port) + " is held by another program"));
  EXPECT_THAT(bound.sentence, HasSubstr("take another one"));
}

TEST_F(UdpSocket, AnOptionThatTheSystemRefusesIsNamed) {
  ASSERT_TRUE(open_udp(a, {.v4 = true, .dscp = 0, .receive_buffer_bytes = 8192}));
  const std::array<SocketOption, 2> options{
      {{SOL_SOCKET, SO_REUSEADDR, 1, "SO_REUSEADDR"}, {IPPROTO_IP, 9999, 1, "SO_NONE"}}};
  EXPECT_THAT(error_of(set_options(a.native_handle(), options)).sentence,
              HasSubstr("the system refuses socket option SO_NONE: " + text_of(ENOPROTOOPT)));
  EXPECT_EQ(option(a, SOL_SOCKET, SO_REUSEADDR), 1) << "the one before it is set";
}

}  // namespace peerd::net::udp_socket_test
