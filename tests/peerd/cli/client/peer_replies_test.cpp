#include "peerd/cli/client/peer_replies.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <thread>
#include <utility>

#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::peer_replies_test {

namespace asio = boost::asio;
using Protocol = asio::local::stream_protocol;
using testing::HasSubstr;

// A peer that gives one reply to each client, in their order, and notes what they asked.
class PeerReplies : public testing::Test {
 protected:
  ~PeerReplies() override {
    if (peer.joinable()) peer.join();
  }
  void reply_with(std::vector<std::string> replies) {
    peer = std::thread([this, replies = std::move(replies)] {
      for (const std::string& reply : replies) {
        Protocol::socket socket(io);
        acceptor.accept(socket);
        std::string line;
        asio::read_until(socket, asio::dynamic_buffer(line), '\n');
        requests.push_back(line);
        asio::write(socket, asio::buffer(reply + "\n"));
      }
    });
  }

  testing_support::ScratchFolder folder;
  std::filesystem::path path = folder / "p.sock";
  asio::io_context io;
  Protocol::acceptor acceptor{io, Protocol::endpoint(path.string())};
  std::vector<std::string> requests;
  std::thread peer;
};

TEST_F(PeerReplies, AListIsAskedForUntilItIsWhole) {
  reply_with({R"({"v":1,"ok":true,"objects":[{"id":1},{"id":2}],"next":7})",
              R"({"v":1,"ok":true,"objects":[{"id":7}],"next":9})",
              R"({"v":1,"ok":true,"objects":[{"id":9}],"next":null})"});
  const auto reply = ask_peer(path, R"({"do":"objects"})");
  peer.join();
  ASSERT_TRUE(reply) << reply.error().text;
  EXPECT_EQ(reply->at("objects").dump(), R"([{"id":1},{"id":2},{"id":7},{"id":9}])");
  EXPECT_EQ(requests, (std::vector<std::string>{"{\"do\":\"objects\"}\n", "{\"do\":\"objects\",\"from\":7}\n",
                                                "{\"do\":\"objects\",\"from\":9}\n"}));
}

TEST_F(PeerReplies, AStatusStaysAsItCame) {
  reply_with({R"({"v":1,"ok":true,"objects":[],"next":7,"counters":{}})"});
  EXPECT_EQ(must(ask_peer(path, R"({"do":"status"})")).at("next"), 7);
}

TEST_F(PeerReplies, ARefusalIsWrongUse) {
  reply_with({R"({"v":1,"ok":false,"error":"no such request"})"});
  EXPECT_THAT(error_of(ask_peer(path, R"({"do":"dance"})")), IsError(2, "error: no such request"));
}

TEST(ReadReply, SaysThatItIsNoPeerOfThisVersion) {
  for (const char* const line : {"", "hello", "[]", "{}", R"({"v":2,"ok":true})", R"({"v":1,"ok":"yes"})"}) {
    const auto reply = read_reply("p.sock", line);
    ASSERT_FALSE(reply) << line;
    EXPECT_EQ(reply.error().exit_code, 3);
    EXPECT_THAT(reply.error().text, HasSubstr("p.sock is no peer of this version"));
  }
}

}  // namespace peerd::peer_replies_test
