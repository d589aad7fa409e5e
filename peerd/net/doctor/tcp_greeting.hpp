#pragma once
#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "peerd/net/doctor/pair_message.hpp"

namespace peerd::doctor {

// A greeting is 8 bytes by which both ends of a TCP connection know that the other is a doctor.
using TcpGreeting = std::array<char, 8>;

// Answers greetings of one other computer; closes connections of all others.
class GreetingListener {
 public:
  // Listens at `own`; problem() says why not.
  GreetingListener(boost::asio::io_context& io, const boost::asio::ip::tcp::endpoint& own,
                   boost::asio::ip::address other);
  [[nodiscard]] std::uint16_t port() const { return port_; }  // 0: it does not listen
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  void accept();

  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::ip::address other_;
  std::uint16_t port_ = 0;
  std::string problem_;
};

// Greets once, and reports what came of it within 3 s.
class Greeter {
 public:
  Greeter(boost::asio::io_context& io, std::function<void(TcpState)> report);
  void greet(const boost::asio::ip::tcp::endpoint& to);

 private:
  void end(TcpState state);

  boost::asio::ip::tcp::socket socket_;
  boost::asio::steady_timer timer_;
  std::function<void(TcpState)> report_;
  TcpGreeting answer_{};
  bool ended_ = false;
};

}  // namespace peerd::doctor
