#include "peerd/peer/control/control_server.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/io_context.hpp>
#include <boost/asio/local/stream_protocol.hpp>
#include <boost/asio/read_until.hpp>
#include <boost/asio/write.hpp>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "peerd/peer/control/control_client.hpp"
#include "peerd/peer/control/request.hpp"
#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::control::control_server_test {

namespace asio = boost::asio;
using Protocol = asio::local::stream_protocol;
using testing::HasSubstr;

// A server that answers each line with that line, or with a very long one; after "events KIND" the client gets those.
class ControlServerTest : public testing::Test {
 protected:
  ControlServerTest() : path(folder / "c.sock") {}
  std::unique_ptr<ControlServer> open() {
    auto server = ControlServer::open(io, path, [](std::string_view line) {
      if (line == "quiet") return Answer{};
      Answer answer{line == "much" ? std::string(kMuch_bytes, 'x') : "got " + std::string(line)};
      if (line.starts_with("events ")) {
        EventKinds kinds;
        kinds.add(find_event_kind(line.substr(7)).value());
        answer.subscribe = kinds;
      }
      return answer;
    });
    if (!server) {
      ADD_FAILURE() << server.error().text;
      return nullptr;
    }
    return std::move(*server);
  }
  Protocol::socket connect() {
    Protocol::socket socket(io);
    socket.connect(Protocol::endpoint(path.string()));
    socket.non_blocking(true);
    return socket;
  }
  void send(Protocol::socket& socket, const std::string& bytes) {
    boost::system::error_code ignored;
    asio::write(socket, asio::buffer(bytes), ignored);
  }
  // Receives until that many lines are there, the end, or silence for a second.
  std::string receive(Protocol::socket& socket, int lines) {
    std::string all;
    char part[4096];
    for (int tries = 0; tries < 1000 && std::ranges::count(all, '\n') < lines; ++tries) {
      io.restart();
      io.run_for(std::chrono::milliseconds(1));
      boost::system::error_code error;
      const std::size_t size = socket.read_some(asio::buffer(part), error);
      all.append(part, size);
      if (error && error != asio::error::would_block) return all + "<end>";
    }
    return all;
  }
  // All that waits for the client, in the socket or in the server.
  std::string receive_all(Protocol::socket& socket) {
    std::string all;
    std::vector<char> part(1 << 16);
    for (int silent = 0; silent < 3;) {
      io.restart();
      io.run_for(std::chrono::milliseconds(1));
      boost::system::error_code error;
      const std::size_t size = socket.read_some(asio::buffer(part), error);
      all.append(part.data(), size);
      silent = size == 0 ? silent + 1 : 0;
    }
    return all;
  }
  static constexpr std::size_t kMuch_bytes = 4'000'000;

  testing_support::ScratchFolder folder;
  std::filesystem::path path;
  asio::io_context io;
};

TEST_F(ControlServerTest, OneLineInOneLineOut) {
  const auto server = open();
  Protocol::socket a = connect(), b = connect();
  send(a, "one\ntwo\nthr");
  EXPECT_EQ(receive(a, 2), "got one\ngot two\n");
  send(b, "quiet\nquiet\nloud\n");
  EXPECT_EQ(receive(b, 1), "got loud\n") << "no reply where none is wanted";
  send(b, "other\n");
  EXPECT_EQ(receive(b, 1), "got other\n");
  send(a, "ee\n");
  EXPECT_EQ(receive(a, 1), "got three\n");
  EXPECT_EQ(server->counters().requests, 7u);
}

TEST_F(ControlServerTest, OnlyThisUserMayConnect) {
  const auto server = open();
  struct stat found {};
  ASSERT_EQ(stat(path.c_str(), &found), 0);
  EXPECT_EQ(found.st_mode & 0777, 0600u);
}

// Whatever the file's mode says.
TEST_F(ControlServerTest, AnotherUserGetsNoAnswer) {
  if (geteuid() != 0) GTEST_SKIP() << "only the administrator can be another user";
  constexpr uid_t kOther = 65534;
  const auto server = open();
  std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
  std::filesystem::permissions(path, std::filesystem::perms::all);
  for (const bool is_other : {true, false}) {
    const pid_t child = fork();
    if (child == 0) {
      asio::io_context own;
      Protocol::socket socket(own);
      boost::system::error_code failed;
      if (is_other && setresuid(kOther, kOther, kOther) != 0) _exit(3);
      socket.connect(Protocol::endpoint(path.string()), failed);
      if (failed) _exit(2);
      asio::write(socket, asio::buffer(std::string("one\n")), failed);
      char answer = 0;
      _exit(socket.read_some(asio::buffer(&answer, 1), failed) == 1 ? 1 : 0);
    }
    int status = -1;
    for (int tries = 0; tries < 10'000 && waitpid(child, &status, WNOHANG) == 0; ++tries) {
      io.restart();
      io.run_for(std::chrono::milliseconds(1));
    }
    ASSERT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), is_other ? 0 : 1) << "1: it has an answer";
  }
  EXPECT_EQ(server->counters().clients, 2u);
  EXPECT_EQ(server->counters().strangers, 1u);
}

TEST_F(ControlServerTest, IsGoneWithItsFile) {
  auto server = open();
  EXPECT_TRUE(std::filesystem::exists(path));
  Protocol::socket a = connect();
  send(a, "one\n");
  EXPECT_EQ(receive(a, 1), "got one\n");
  server.reset();
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_EQ(receive(a, 1), "<end>");
}

TEST_F(ControlServerTest, AnothersFileAtItsPathStays) {
  auto server = open();
  std::filesystem::remove(path);
  folder.write("c.sock", "mine");
  server.reset();
  EXPECT_TRUE(std::filesystem::exists(path));
}

TEST_F(ControlServerTest, ADeadPeersSocketIsReplaced) {
  { Protocol::acceptor dead(io, Protocol::endpoint(path.string())); }
  ASSERT_TRUE(std::filesystem::exists(path));
  const auto server = open();
  Protocol::socket a = connect();
  send(a, "one\n");
  EXPECT_EQ(receive(a, 1), "got one\n");
}

TEST_F(ControlServerTest, ALivingPeersSocketIsNot) {
  const auto first = open();
  EXPECT_THAT(error_of(ControlServer::open(io, path, {})), IsError(3, HasSubstr("another peer listens there")));
  Protocol::socket a = connect();
  send(a, "one\n");
  EXPECT_EQ(receive(a, 1), "got one\n");
}

// Any user may lock a folder that is open to all.
TEST_F(ControlServerTest, DoesNotWaitForWhoHoldsTheFolder) {
  const int folder_fd = ::open(path.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  ASSERT_GE(folder_fd, 0);
  ASSERT_EQ(flock(folder_fd, LOCK_EX), 0);
  const auto server = open();
  close(folder_fd);
  EXPECT_FALSE(std::filesystem::exists(path.string() + ".lock")) << "its holder removes it";
}

TEST_F(ControlServerTest, WaitsForWhoHoldsTheLockFileAndFollowsNoLink) {
  const std::string lock = path.string() + ".lock";
  std::filesystem::create_symlink(folder / "elsewhere", lock);
  EXPECT_THAT(error_of(ControlServer::open(io, path, {})).text, HasSubstr("c.sock.lock can't be made"));
  EXPECT_FALSE(std::filesystem::exists(folder / "elsewhere"));
  std::filesystem::remove(lock);
  const int lock_fd = ::open(lock.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  ASSERT_GE(lock_fd, 0);
  ASSERT_EQ(flock(lock_fd, LOCK_EX), 0);
  const auto held = ControlServer::open(io, path, {});
  close(lock_fd);
  ASSERT_FALSE(held);
  EXPECT_THAT(held.error().text, HasSubstr("is held by another program"));
}

TEST_F(ControlServerTest, WhatIsNoSocketIsLeftAlone) {
  folder.write("c.sock", "precious");
  EXPECT_EQ(error_of(ControlServer::open(io, path, {})).exit_code, 2);
  EXPECT_EQ(testing_support::text_of(path), "precious");
}

TEST_F(ControlServerTest, PathsThatCannotBe) {
  EXPECT_THAT(error_of(ControlServer::open(io, folder / std::string(120, 'x'), {})),
              IsError(2, HasSubstr("107 bytes")));
  EXPECT_EQ(error_of(ControlServer::open(io, folder / "no/c.sock", {})).exit_code, 3);
}

TEST_F(ControlServerTest, ALineWithoutAnEndIsRefused) {
  const auto server = open();
  Protocol::socket a = connect();
  send(a, std::string(kLineMax_bytes, 'x'));
  EXPECT_THAT(receive(a, 2), AllOf(HasSubstr("may have 65536 bytes"), HasSubstr("<end>")));
  EXPECT_EQ(server->counters().too_long, 1u);
  Protocol::socket b = connect();
  send(b, std::string(kLineMax_bytes - 1, 'x') + "\n");
  EXPECT_EQ(receive(b, 1).size(), 4 + kLineMax_bytes) << "the longest";
}

TEST_F(ControlServerTest, ClientsAreCounted) {
  const auto server = open();
  std::vector<Protocol::socket> clients;
  for (std::size_t i = 0; i < ControlServer::kClientsMax; ++i) {
    clients.push_back(connect());
    send(clients.back(), "one\n");
    EXPECT_EQ(receive(clients.back(), 1), "got one\n") << i;
  }
  Protocol::socket late = connect();
  EXPECT_THAT(receive(late, 2), AllOf(HasSubstr("16 clients already"), HasSubstr("<end>")));
  EXPECT_EQ(server->counters().refused, 1u);
  clients.pop_back();
  io.restart();
  io.run_for(std::chrono::milliseconds(20));
  Protocol::socket next = connect();
  send(next, "one\n");
  EXPECT_EQ(receive(next, 1), "got one\n") << "who leaves makes room";
}

TEST_F(ControlServerTest, WhoDoesNotReadIsDroppedAndHoldsNobodyUp) {
  const auto server = open();
  Protocol::socket slow = connect(), quick = connect();
  send(slow, "much\nmuch\nmuch\n");
  const auto begun = std::chrono::steady_clock::now();
  send(quick, "one\n");
  EXPECT_EQ(receive(quick, 1), "got one\n");
  EXPECT_LT(std::chrono::steady_clock::now() - begun, ControlServer::kReplyWithin);
  EXPECT_EQ(server->counters().requests, 2u) << "the next request of who has not read the last reply waits";
  io.restart();
  io.run_for(ControlServer::kReplyWithin + std::chrono::milliseconds(200));
  EXPECT_EQ(server->counters().too_slow, 1u);
  send(quick, "two\n");
  EXPECT_EQ(receive(quick, 1), "got two\n");
}

TEST_F(ControlServerTest, EventsGoToWhoHasSubscribed) {
  const auto server = open();
  Protocol::socket a = connect(), b = connect();
  server->publish(EventKind::kData, "nobody wants it");
  send(a, "events data\n");
  send(b, "events peers\n");
  EXPECT_EQ(receive(a, 1), "got events data\n");
  EXPECT_EQ(receive(b, 1), "got events peers\n");
  server->publish(EventKind::kData, "1");
  server->publish(EventKind::kPeers, "2");
  server->publish(EventKind::kEdits, "3");
  server->publish(EventKind::kData, "4");
  EXPECT_EQ(receive(a, 2), "1\n4\n");
  EXPECT_EQ(receive(b, 1), "2\n");
  send(a, "one\n");
  EXPECT_EQ(receive(a, 1), "got one\n") << "it may go on to ask";
  send(a, "events edits\n");
  EXPECT_EQ(receive(a, 1), "got events edits\n");
  server->publish(EventKind::kData, "5");
  server->publish(EventKind::kEdits, "6");
  EXPECT_EQ(receive(a, 1), "6\n");
  a.close();
  b.close();
  io.restart();
  io.run_for(std::chrono::milliseconds(20));
  EXPECT_TRUE(server->wanted().empty());
}

TEST_F(ControlServerTest, WhoReadsTooSlowlyIsToldWhatWasDropped) {
  const auto server = open();
  Protocol::socket slow = connect(), quick = connect();
  for (Protocol::socket* client : {&slow, &quick}) {
    send(*client, "events contacts\n");
    EXPECT_EQ(receive(*client, 1), "got events contacts\n");
  }
  constexpr int kEvents = 3000;
  const std::string padding(1000, '.');
  int read = 0;
  for (int k = 0; k < kEvents; ++k) {
    server->publish(EventKind::kContacts, std::to_string(k) + " " + padding);
    if (k % 100 == 99) read += static_cast<int>(std::ranges::count(receive(quick, 100), '\n'));
  }
  EXPECT_EQ(read, kEvents) << "who reads gets all";
  EXPECT_GT(server->counters().events_dropped, 500u);
  std::istringstream lines(receive_all(slow));
  server->publish(EventKind::kContacts, "last");
  int last = -1, dropped = 0, got = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('{')) {
      dropped += nlohmann::json::parse(line).at("count").get<int>();
    } else {
      EXPECT_GT(std::stoi(line), last) << "in order";
      last = std::stoi(line);
      ++got;
    }
  }
  EXPECT_EQ(got + dropped, kEvents);
  EXPECT_GE(got, 1000);
  EXPECT_EQ(static_cast<std::uint64_t>(dropped), server->counters().events_dropped);
  EXPECT_EQ(receive(slow, 1), "last\n");
}

TEST_F(ControlServerTest, AReplyLargerThanTheSocketsBufferArrives) {
  const auto server = open();
  std::atomic<bool> over = false;
  std::thread serves([&] {
    while (!over) {
      io.restart();
      io.run_for(std::chrono::milliseconds(5));
    }
  });
  const auto reply = ask(path, "much");
  over = true;
  serves.join();
  ASSERT_TRUE(reply) << reply.error().text;
  EXPECT_EQ(reply->size(), kMuch_bytes);
}

// A stopped peer: the system accepts as many clients as the queue holds.
TEST_F(ControlServerTest, WhoseQueueIsFullLivesAndIsBusy) {
  Protocol::acceptor stopped(io);
  stopped.open();
  stopped.bind(Protocol::endpoint(path.string()));
  stopped.listen(1);
  std::vector<Protocol::socket> waiting;
  boost::system::error_code error;
  while (!error && waiting.size() < 10) {
    waiting.emplace_back(io, Protocol()).non_blocking(true);
    waiting.back().connect(Protocol::endpoint(path.string()), error);
  }
  ASSERT_TRUE(error) << "the queue is full";
  EXPECT_THAT(error_of(ask(path, "one")), IsError(3, HasSubstr("it is stopped, or busy")));
  EXPECT_THAT(error_of(ControlServer::open(io, path, {})).text, HasSubstr("another peer listens there"));
}

}  // namespace peerd::control::control_server_test
