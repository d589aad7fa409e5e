#include "peerd/peer/control/control_client.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <thread>

#include "tests/peerd/scratch_folder.hpp"

namespace peerd::control::control_client_test {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using Protocol = asio::local::stream_protocol;
using testing::HasSubstr;

// A peer that answers one client with the bytes of a test.
class ControlClient : public testing::Test {
 protected:
  ControlClient() : path(folder / "c.sock"), acceptor(io, Protocol::endpoint(path.string())) {}
  ~ControlClient() override {
    if (peer.joinable()) peer.join();
  }
  // Reads one line, then writes `reply` and closes.
  void answer_with(std::string reply) {
    peer = std::thread([this, reply = std::move(reply)] {
      boost::system::error_code ignored;
      Protocol::socket socket(io);
      acceptor.accept(socket, ignored);
      asio::read_until(socket, asio::dynamic_buffer(request), '\n', ignored);
      asio::write(socket, asio::buffer(reply), ignored);
    });
  }
  std::string error_of(const Result<std::string>& reply) {
    EXPECT_FALSE(reply);
    if (reply) return *reply;
    EXPECT_EQ(reply.error().exit_code, 3);
    return reply.error().text;
  }

  testing_support::ScratchFolder folder;
  std::filesystem::path path;
  asio::io_context io;
  Protocol::acceptor acceptor;
  std::string request;
  std::thread peer;
};

TEST_F(ControlClient, SendsOneLineAndReturnsOneLine) {
  answer_with("{\"ok\":true}\nmore");
  EXPECT_EQ(ask(path, "{\"do\":\"status\"}").value(), "{\"ok\":true}");
  peer.join();
  EXPECT_EQ(request, "{\"do\":\"status\"}\n");
}

TEST_F(ControlClient, ALongReplyArrivesWhole) {
  const std::string reply(1 << 20, 'x');
  answer_with(reply + "\n");
  EXPECT_EQ(ask(path, "x").value(), reply);
}

TEST_F(ControlClient, AReplyWithoutALineEndIsNone) {
  answer_with("half a line");
  EXPECT_THAT(error_of(ask(path, "x")), HasSubstr("no peer answers at " + path.string() + ": End of file"));
}

TEST_F(ControlClient, ASilentPeerIsGivenUp) {
  EXPECT_THAT(error_of(ask(path, "x", 50ms)), HasSubstr("it is silent for 50 ms"));
}

TEST_F(ControlClient, ASocketThatNobodyServesIsNoPeer) {
  acceptor.close();
  EXPECT_THAT(error_of(ask(path, "x")), HasSubstr("Connection refused"));
  EXPECT_THAT(error_of(ask(folder / "none.sock", "x")), HasSubstr("No such file"));
}

TEST_F(ControlClient, APathBeyondTheLimitOfSocketsIsAnError) {
  EXPECT_THAT(error_of(ask(folder / std::string(120, 'x'), "x")), HasSubstr("too long for a socket's"));
}

}  // namespace peerd::control::control_client_test
