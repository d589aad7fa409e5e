#include "peerd/net/doctor/tcp_greeting.hpp"

#include <gtest/gtest.h>

#include <boost/asio/write.hpp>
#include <optional>
#include <string>

namespace peerd::doctor::tcp_greeting_test {

namespace asio = boost::asio;
using asio::ip::tcp;

const auto kHere = asio::ip::make_address("127.0.0.1");

std::optional<TcpState> greet(asio::io_context& io, std::uint16_t port) {
  std::optional<TcpState> said;
  Greeter greeter(io, [&](TcpState state) { said = state; });
  greeter.greet({kHere, port});
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (!said && std::chrono::steady_clock::now() < give_up) io.run_one_for(std::chrono::milliseconds(20));
  return said;
}

TEST(TcpGreeting, WorksBetweenDoctors) {
  asio::io_context io(1);
  const GreetingListener listener(io, {kHere, 0}, kHere);
  ASSERT_NE(listener.port(), 0) << listener.problem();
  EXPECT_EQ(greet(io, listener.port()), TcpState::kWorks);
  EXPECT_EQ(greet(io, listener.port()), TcpState::kWorks) << "again";
}

TEST(TcpGreeting, OthersThanTheNamedOneAreNotAnswered) {
  asio::io_context io(1);
  const GreetingListener listener(io, {kHere, 0}, asio::ip::make_address("192.0.2.9"));
  EXPECT_EQ(greet(io, listener.port()), TcpState::kNoAnswer);
}

TEST(TcpGreeting, NobodyThereIsARefusal) {
  asio::io_context io(1);
  tcp::acceptor bound(io, {kHere, 0});
  const std::uint16_t port = bound.local_endpoint().port();
  bound.close();
  EXPECT_EQ(greet(io, port), TcpState::kRefused);
}

TEST(TcpGreeting, AnotherProgramIsNoDoctor) {
  asio::io_context io(1);
  tcp::acceptor other(io, {kHere, 0});
  tcp::socket accepted(io);
  const std::string words = "HTTP/1.1 400 Bad Request\r\n\r\n";
  other.async_accept(accepted, [&](const boost::system::error_code& ec) {
    ASSERT_FALSE(ec);
    asio::write(accepted, asio::buffer(words));
  });
  EXPECT_EQ(greet(io, other.local_endpoint().port()), TcpState::kNoAnswer);
}

TEST(TcpGreeting, ATakenPortIsSaid) {
  asio::io_context io(1);
  const tcp::acceptor taken(io, {kHere, 0});
  const GreetingListener listener(io, {kHere, taken.local_endpoint().port()}, kHere);
  EXPECT_EQ(listener.port(), 0);
  EXPECT_EQ(listener.problem(), "Address already in use");
}

}  // namespace peerd::doctor::tcp_greeting_test
