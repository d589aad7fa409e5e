// Joining peers and those who give them a snapshot, over TCP on lo.
#include "peerd/net/snapshot/snapshot_fetch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <fstream>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <random>
#include <thread>
#include <utility>

#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>

#include "peerd/net/keys/symmetric_key.hpp"
#include "peerd/net/snapshot/framed_stream.hpp"
#include "peerd/net/snapshot/snapshot_server.hpp"
#include "replication/edits/log/operation_log.hpp"
#include "replication/wire/codec.hpp"
#include "tests/must.hpp"
#include "tests/replication/peer/operations.hpp"

namespace peerd::snapshot::snapshot_fetch_test {

namespace asio = boost::asio;
using namespace std::chrono_literals;
using replication::AuthorId;
using replication::OperationId;
using replication::OperationLogs;
using testing::HasSubstr;

constexpr std::uint64_t kSession = 77;

std::string random_bytes(std::size_t size, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::string bytes(size, ' ');
  for (char& c : bytes) c = static_cast<char>(random());
  return bytes;
}

// The logs of two authors, with so many operations each, of which one is larger than a part.
OperationLogs some_logs(std::uint32_t operations, std::uint64_t seed = 1) {
  OperationLogs logs;
  for (const AuthorId author : {AuthorId{5}, AuthorId{6}}) {
    replication::test::OperationMaker maker(seed + author.value);
    std::uint64_t from = 0;
    for (std::uint32_t number = 1; number <= operations; ++number) {
      const OperationId id{author, number};
      const auto bytes = replication::encode(number == 3 ? maker.large(id, 3 * kPartMax_bytes) : maker.operation(id));
      EXPECT_TRUE(logs.receive({author, from, bytes}));
      from += bytes.size();
    }
  }
  return logs;
}

// A peer that gives a snapshot, in a thread of its own.
class ProvidingPeer {
 public:
  explicit ProvidingPeer(OperationLogs held, std::string packed = random_bytes(1'000'000, 1),
                         std::uint64_t session = kSession, const std::optional<keys::SymmetricKey>& key = {},
                         asio::ip::address_v4 at = asio::ip::address_v4::loopback())
      : archive(std::move(packed)), logs(std::move(held)) {
    for (const auto& [author, length] : logs.lengths()) bytes.emplace(author, logs.bytes({author, 0, length}));
    server = must(SnapshotServer::open(
        io, at, 0,
        {session, "town", "expansion = 1\n", 9, archive, digest(archive),
         [this]() -> const OperationLogs& { return logs; }, [] { return SimTime::max(); }, [key] { return key; }}));
    address = at;
    thread = std::thread([this] { io.run(); });
  }
  ProvidingPeer(const ProvidingPeer&) = delete;
  ProvidingPeer& operator=(const ProvidingPeer&) = delete;
  ~ProvidingPeer() {
    io.stop();
    thread.join();
  }
  [[nodiscard]] Provider provider(const std::string& name) const { return {name, {address, server->port()}}; }

  asio::ip::address address;
  std::string archive;
  OperationLogs logs;                                // the thread's: reading them unpacks
  std::map<AuthorId, std::vector<std::byte>> bytes;  // of these logs
  asio::io_context io{1};
  std::unique_ptr<SnapshotServer> server;
  std::thread thread;
};

// The archive and the logs outlive it.
SnapshotContent content_of(const std::string& archive, const OperationLogs& logs) {
  return {kSession,
          "town",
          "expansion = 1\n",
          9,
          archive,
          digest(archive),
          [&logs]() -> const OperationLogs& { return logs; },
          [] { return SimTime::max(); }};
}

// A peer in a thread of its own that asks `answers` before each reply, and waits as long as that does. Where it says
// no, the peer closes what is open, and listens no more.
class WilfulPeer {
 public:
  using MakeReply = std::function<Reply(const std::string&)>;
  WilfulPeer(const SnapshotContent& content, std::function<bool(const Request&)> answers)
      : WilfulPeer([&content](const std::string& request) { return reply_to(request, content); }, std::move(answers)) {}
  explicit WilfulPeer(
      MakeReply reply, std::function<bool(const Request&)> answers = [](const Request&) { return true; })
      : reply_(std::move(reply)), answers_(std::move(answers)) {
    acceptor_.listen();
    thread_ = std::thread([this] { serve(); });
  }
  WilfulPeer(const WilfulPeer&) = delete;
  WilfulPeer& operator=(const WilfulPeer&) = delete;
  ~WilfulPeer() {
    io_.stop();
    thread_.join();
  }
  [[nodiscard]] Provider provider(const std::string& name) const { return {name, acceptor_.local_endpoint()}; }

 private:
  void serve() {
    accept();
    io_.run();
  }
  void accept() {
    acceptor_.async_accept([this](const boost::system::error_code& failed, asio::ip::tcp::socket socket) {
      if (failed) return;
      const auto stream = std::make_shared<FramedStream>(
          std::move(socket), kRequestMax_bytes, 10s, [](const auto&) {}, std::nullopt);
      streams_.push_back(stream);
      answer(stream);
      accept();
    });
  }
  void answer(const std::shared_ptr<FramedStream>& stream) {
    stream->read([this, stream](const std::string& request) {
      if (!answers_(decode_request(request).value())) {
        boost::system::error_code ignored;
        acceptor_.close(ignored);
        for (const auto& each : streams_) each->close();
        return;
      }
      stream->write(encode(reply_(request)), [this, stream] { answer(stream); });
    });
  }

  MakeReply reply_;
  std::function<bool(const Request&)> answers_;
  asio::io_context io_{1};
  asio::ip::tcp::acceptor acceptor_{io_, {asio::ip::address_v4::loopback(), 0}, false};
  std::vector<std::shared_ptr<FramedStream>> streams_;
  std::thread thread_;
};

void expect_all_of(const Snapshot& snapshot, const ProvidingPeer& peer) {
  EXPECT_EQ(snapshot.archive, peer.archive);
  EXPECT_EQ(snapshot.offer.world, "town");
  EXPECT_EQ(snapshot.offer.settings, "expansion = 1\n");
  ASSERT_EQ(snapshot.logs.size(), peer.bytes.size());
  for (const auto& part : snapshot.logs) EXPECT_EQ(part.bytes, peer.bytes.at(part.author)) << part.author.value;
}

TEST(SnapshotFetch, IsSealedWhereBothHaveTheKey) {
  const auto key = keys::SymmetricKey::random();
  const ProvidingPeer a(some_logs(20), random_bytes(1'000'000, 1), kSession, key);
  const ProvidingPeer b(some_logs(20), random_bytes(1'000'000, 1), kSession, key);
  const auto snapshot = must(fetch_snapshot({a.provider("a"), b.provider("b")}, kSession, {.key = key}));
  expect_all_of(snapshot, a);
  EXPECT_FALSE(snapshot.checked_with.empty());
}

TEST(SnapshotFetch, GivesNothingToWhoHasAnotherKeyOrNone) {
  const auto key = keys::SymmetricKey::random();
  const ProvidingPeer sealed(some_logs(20), random_bytes(1'000'000, 1), kSession, key), open(some_logs(20));
  const auto refused = [](const ProvidingPeer& peer, const std::optional<keys::SymmetricKey>& with) {
    // Nobody waits until patience ends: a peer that waited would do so for longer than a test may take.
    const auto got = fetch_snapshot({peer.provider("a")}, kSession, {.patience = 1h, .key = with});
    return got ? "" : got.error();
  };
  EXPECT_THAT(refused(sealed, keys::SymmetricKey::random()),
              testing::EndsWith("it has another key; --key FILE says one"));
  const auto says = [](const std::string& why) {
    return AllOf(testing::StartsWith("a at 127.0.0.1:"), testing::EndsWith(": " + why));
  };
  EXPECT_THAT(refused(open, key), says("it is open, and does not have the key"));
  EXPECT_THAT(refused(sealed, std::nullopt), says("it is sealed, and begins with a key: leave out --open"));
}

TEST(SnapshotFetch, GetsAllFromOnePeer) {
  const ProvidingPeer a(some_logs(20));
  const auto snapshot = must(fetch_snapshot({a.provider("a")}, kSession));
  expect_all_of(snapshot, a);
  EXPECT_EQ(snapshot.provided_by, "a");
  EXPECT_EQ(snapshot.checked_with, "");
  EXPECT_GT(snapshot.connections, 1u);
}

TEST(SnapshotFetch, AWorldWithoutOperationsIsCompared) {
  const ProvidingPeer a(OperationLogs{}), b(OperationLogs{});
  const auto snapshot = must(fetch_snapshot({a.provider("a"), b.provider("b")}, 0));
  expect_all_of(snapshot, a);
  EXPECT_EQ(snapshot.checked_with, snapshot.provided_by == "a" ? "b" : "a");
}

// The first peer to answer offers what it has; the other one is asked about as much as both have.
TEST(SnapshotFetch, ComparesWithAPeerThatHasLess) {
  const ProvidingPeer a(some_logs(20)), b(some_logs(10));
  const auto snapshot = must(fetch_snapshot({a.provider("a"), b.provider("b")}, kSession));
  expect_all_of(snapshot, snapshot.provided_by == "a" ? a : b);
  EXPECT_NE(snapshot.checked_with, "");
}

TEST(SnapshotFetch, TellsThatTwoPeersDiffer) {
  const ProvidingPeer a(some_logs(20, 1)), b(some_logs(20, 2));
  EXPECT_THAT(error_of(fetch_snapshot({a.provider("a"), b.provider("b")}, kSession)),
              HasSubstr("have different operations of author 5 "));
}

// A log that one peer has given is compared with another one, also where that other one has made the offer: a makes the
// offer and gives nothing before b has given everything.
TEST(SnapshotFetch, ComparesWithAPeerThatHasNotGivenIt) {
  const std::string archive = random_bytes(1000, 1);
  const OperationLogs of_a = some_logs(20, 1), of_b = some_logs(30, 2);  // each of one thread; b has all places
  const SnapshotContent content_a = content_of(archive, of_a), content_b = content_of(archive, of_b);
  std::promise<void> a_is_first, b_has_given;
  const auto a_answers = [&, is_first = true](const Request& request) mutable {
    if (!std::holds_alternative<PartRequest>(request.what) || !std::exchange(is_first, false)) return true;
    a_is_first.set_value();
    b_has_given.get_future().wait();
    return true;
  };
  const auto b_answers = [&](const Request& request) {
    if (std::holds_alternative<OfferRequest>(request.what)) a_is_first.get_future().wait();
    const auto* part = std::get_if<PartRequest>(&request.what);
    // Another peer is asked last for what a has been asked for first.
    if (part != nullptr && part->range.author == replication::kNoAuthor) b_has_given.set_value();
    return true;
  };
  FetchOptions options;
  options.connections = 2;  // one to each
  const WilfulPeer a(content_a, a_answers), b(content_b, b_answers);
  EXPECT_THAT(error_of(fetch_snapshot({a.provider("a"), b.provider("b")}, kSession, options)),
              HasSubstr("b and a have different operations of author 5 "));
}

TEST(SnapshotFetch, APeerThatFailsIsReplaced) {
  const ProvidingPeer a(some_logs(20));
  const OperationLogs same = some_logs(20);  // of another thread
  const SnapshotContent content = content_of(a.archive, same);
  for (int replies = 0; replies < 12; ++replies) {
    const WilfulPeer failing(content, [left = replies](const Request&) mutable { return left-- > 0; });
    const auto snapshot = must(fetch_snapshot({failing.provider("failing"), a.provider("a")}, kSession));
    expect_all_of(snapshot, a);
    if (replies == 0) {  // a later one may fail when all is there
      EXPECT_FALSE(snapshot.notes.empty());
    }
  }
}

TEST(SnapshotFetch, SaysWhyNobodyGives) {
  const ProvidingPeer elsewhere(OperationLogs{}, "archive", kSession + 1);
  FetchOptions options;
  options.patience = 1s;
  EXPECT_THAT(error_of(fetch_snapshot({elsewhere.provider("elsewhere")}, kSession, options)),
              AllOf(testing::StartsWith("elsewhere at 127.0.0.1:"), HasSubstr(": this peer is in another world")));
  EXPECT_FALSE(fetch_snapshot({}, kSession));
  // A port at which nobody listens any more.
  Provider gone{"gone", {}};
  {
    const ProvidingPeer peer(OperationLogs{});
    gone.at = peer.provider("").at;
  }
  EXPECT_THAT(error_of(fetch_snapshot({gone}, kSession, options)), testing::StartsWith("gone at 127.0.0.1:"));
}

TEST(SnapshotFetch, APeerWithAnotherArchiveGivesNothing) {
  const ProvidingPeer a(OperationLogs{}, "one archive"), b(OperationLogs{}, "another archive");
  const auto snapshot = must(fetch_snapshot({a.provider("a"), b.provider("b")}, kSession));
  expect_all_of(snapshot, snapshot.provided_by == "a" ? a : b);
  EXPECT_THAT(snapshot.notes, testing::Contains(HasSubstr("has packed the world's files in another way")));
}

TEST(SnapshotServer, OffersNoLogOfABrokenClock) {
  const ProvidingPeer a(some_logs(3));
  SnapshotContent content = content_of(a.archive, a.logs);
  const auto offered = [&] {
    return std::get<Offer>(reply_to(encode(Request{kSession, OfferRequest{}}), content)).logs;
  };
  EXPECT_EQ(offered().size(), 2u);
  const SimTime last = a.logs.last_stamp(AuthorId{5});
  content.latest_stamp = [last] { return last - Duration{1}; };
  EXPECT_TRUE(offered().empty());
}

TEST(SnapshotServer, SaysNothingToNonsense) {
  const ProvidingPeer a(some_logs(3));
  const SnapshotContent content = content_of(a.archive, a.logs);
  EXPECT_TRUE(std::holds_alternative<Refusal>(reply_to("nonsense", content)));
  const auto ask = [&](std::variant<OfferRequest, PartRequest, DigestRequest> what) {
    return reply_to(encode(Request{kSession, std::move(what)}), content);
  };
  EXPECT_TRUE(std::holds_alternative<Refusal>(ask(PartRequest{{AuthorId{999}, 0, 1}})));
  EXPECT_TRUE(std::holds_alternative<Refusal>(
      ask(PartRequest{{replication::kNoAuthor, a.archive.size(), a.archive.size() + 1}})));
  EXPECT_TRUE(std::holds_alternative<Refusal>(
      ask(PartRequest{{replication::kNoAuthor, a.archive.size() - 1, a.archive.size() + 1}})));
  const Reply end = ask(PartRequest{{replication::kNoAuthor, a.archive.size() - 1, a.archive.size()}});
  ASSERT_TRUE(std::holds_alternative<Part>(end));
  EXPECT_EQ(std::get<Part>(end).bytes, a.archive.substr(a.archive.size() - 1));
  const Reply digests = ask(DigestRequest{{{AuthorId{5}, std::uint64_t{1} << 40}}});
  ASSERT_TRUE(std::holds_alternative<Digests>(digests));
  EXPECT_EQ(std::get<Digests>(digests).digests, std::vector<std::uint64_t>{0});
}

// A reply that takes many steps delays those of its own address alone.
TEST(SnapshotServer, AddressesTakeTurns) {
  const ProvidingPeer a(some_logs(2000));
  asio::io_context io;
  const auto connected = [&](const char* from) {
    asio::ip::tcp::socket socket(io, {asio::ip::make_address(from), 0});
    socket.connect(a.provider("").at);
    return socket;
  };
  const auto ask = [](asio::ip::tcp::socket& socket, const Request& request) {
    const std::string content = encode(request);
    std::string frame;
    for (int shift = 0; shift < 32; shift += 8) frame += static_cast<char>(content.size() >> shift & 0xff);
    asio::write(socket, asio::buffer(frame + content));
  };
  std::vector<asio::ip::tcp::socket> greedy;
  for (int i = 0; i < 64; ++i) greedy.push_back(connected("127.0.0.1"));
  asio::ip::tcp::socket other = connected("127.0.0.2");
  DigestRequest all;
  for (const auto& [author, bytes] : a.bytes) all.logs.push_back({author, bytes.size()});
  for (asio::ip::tcp::socket& each : greedy) ask(each, {kSession, all});
  ask(other, {kSession, OfferRequest{}});
  std::array<char, 1> byte{};
  EXPECT_EQ(other.read_some(asio::buffer(byte)), 1u);
  EXPECT_TRUE(std::ranges::any_of(greedy, [](const auto& each) { return each.available() == 0; }));
}

// Connections to the server that say nothing, as many as there are places and some more.
std::vector<asio::ip::tcp::socket> silent_connections(asio::io_context& io, const asio::ip::tcp::endpoint& to) {
  std::vector<asio::ip::tcp::socket> all;
  for (std::size_t i = 0; i < SnapshotServer::kUnprovenMax + 50; ++i) all.emplace_back(io).connect(to);
  return all;
}

// Waits until the other side has closed it; false: it has said something.
bool is_closed(asio::ip::tcp::socket& socket) {
  std::array<char, 1> byte{};
  boost::system::error_code closed;
  socket.read_some(asio::buffer(byte), closed);
  return closed.failed();
}
bool is_open(asio::ip::tcp::socket& socket) {
  std::array<char, 1> byte{};
  boost::system::error_code closed;
  socket.non_blocking(true);
  socket.read_some(asio::buffer(byte), closed);
  return !closed || closed == asio::error::would_block;
}

TEST(SnapshotServer, TakesFewConnectionsAndGoesOn) {
  const ProvidingPeer a(OperationLogs{});
  asio::io_context io;
  auto silent = silent_connections(io, a.provider("").at);
  EXPECT_TRUE(is_closed(silent.front())) << "the oldest one makes room";
  EXPECT_TRUE(is_open(silent.back()));
  const auto snapshot = must(fetch_snapshot({a.provider("a")}, kSession));
  expect_all_of(snapshot, a);
}

// Passes one connection on, and what comes back only after so many others have connected to the server, as on a path
// that takes longer than a stranger needs for that.
class LongPath {
 public:
  explicit LongPath(asio::ip::tcp::endpoint to) : to_(std::move(to)) {
    acceptor_.listen();
    thread_ = std::thread([this] { pass_on(); });
  }
  LongPath(const LongPath&) = delete;
  LongPath& operator=(const LongPath&) = delete;
  ~LongPath() { thread_.join(); }
  [[nodiscard]] Provider provider(const std::string& name) const { return {name, acceptor_.local_endpoint()}; }

 private:
  void pass_on() {
    asio::ip::tcp::socket client = acceptor_.accept(), server(io_);
    server.connect(to_);
    std::array<char, 4 + seal::StreamSeal::kHello_bytes + seal::StreamSeal::kProof_bytes> hello{};
    asio::write(server, asio::buffer(hello, asio::read(client, asio::buffer(hello))));
    auto silent = silent_connections(io_, to_);
    (void)is_closed(silent.front());  // by then the server has taken so many that some had to go
    std::thread back([&] { copy(server, client); });
    copy(client, server);
    back.join();
  }
  static void copy(asio::ip::tcp::socket& from, asio::ip::tcp::socket& to) {
    std::array<char, 4096> bytes{};
    boost::system::error_code over;
    for (;;) {
      const std::size_t size = from.read_some(asio::buffer(bytes), over);
      if (!over) asio::write(to, asio::buffer(bytes, size), over);
      if (over) break;
    }
    to.shutdown(asio::ip::tcp::socket::shutdown_send, over);
  }

  asio::io_context io_;
  asio::ip::tcp::acceptor acceptor_{io_, {asio::ip::address_v4::loopback(), 0}, false};
  asio::ip::tcp::endpoint to_;
  std::thread thread_;
};

TEST(SnapshotServer, WhoHasTheKeyKeepsItsPlaceOnALongPath) {
  const auto key = keys::SymmetricKey::random();
  const ProvidingPeer a(OperationLogs{}, random_bytes(1'000'000, 1), kSession, key);
  const LongPath path(a.provider("").at);
  const auto snapshot =
      must(fetch_snapshot({path.provider("a")}, kSession, {.connections = 1, .patience = 1h, .key = key}));
  expect_all_of(snapshot, a);
}

std::string frame_of(const std::string& content) {
  std::string frame;
  for (int shift = 0; shift < 32; shift += 8) frame += static_cast<char>(content.size() >> shift & 0xff);
  return frame + content;
}

TEST(SnapshotServer, ARecordedHelloKeepsNoPlace) {
  const auto key = keys::SymmetricKey::random();
  const ProvidingPeer a(OperationLogs{}, random_bytes(1000, 1), kSession, key);
  asio::io_context io;
  const std::string hello = frame_of(seal::StreamSeal(key, seal::StreamSeal::End::kClient).proven_hello());
  const auto say = [&](asio::ip::tcp::socket& socket) {
    socket.connect(a.provider("").at);
    asio::write(socket, asio::buffer(hello));
    std::array<char, 4 + seal::StreamSeal::kHello_bytes> answer{};
    asio::read(socket, asio::buffer(answer));
  };
  asio::ip::tcp::socket first(io), again(io);
  say(first);
  say(again);
  const auto silent = silent_connections(io, a.provider("").at);
  EXPECT_TRUE(is_closed(again));
  EXPECT_TRUE(is_open(first));
}

TEST(SnapshotServer, WhoHasAnotherKeyIsToldSo) {
  const ProvidingPeer a(OperationLogs{}, random_bytes(1000, 1), kSession, keys::SymmetricKey::random());
  asio::io_context io;
  asio::ip::tcp::socket socket(io);
  socket.connect(a.provider("").at);
  const seal::StreamSeal other(keys::SymmetricKey::random(), seal::StreamSeal::End::kClient);
  asio::write(socket, asio::buffer(frame_of(other.proven_hello())));
  std::string answer(5, ' ');
  asio::read(socket, asio::buffer(answer));
  EXPECT_EQ(answer, frame_of(std::string{static_cast<char>(FramedStream::Refused::kOtherKey)}));
  EXPECT_TRUE(is_closed(socket));
}

// Somebody may have recorded the hello at another peer.
TEST(SnapshotServer, AHelloAloneKeepsAPlaceForThreeSeconds) {
  const auto key = keys::SymmetricKey::random();
  const ProvidingPeer a(OperationLogs{}, random_bytes(1000, 1), kSession, key);
  asio::io_context io;
  asio::ip::tcp::socket socket(io);
  socket.connect(a.provider("").at);
  const auto began = std::chrono::steady_clock::now();
  asio::write(socket, asio::buffer(frame_of(seal::StreamSeal(key, seal::StreamSeal::End::kClient).proven_hello())));
  std::array<char, 4 + seal::StreamSeal::kHello_bytes> answer{};
  asio::read(socket, asio::buffer(answer));
  EXPECT_TRUE(is_closed(socket));
  const auto took = std::chrono::steady_clock::now() - began;
  EXPECT_GT(took, 2s);
  EXPECT_LT(took, 15s) << "whoever sends a sealed frame has 30 s for the next one";
}

// An older client would read a byte as the first one of an open peer's answer.
TEST(FramedStream, AClientWithoutAProofIsNotToldWhyItIsRefused) {
  const seal::StreamSeal client(keys::SymmetricKey::random(), seal::StreamSeal::End::kClient);
  const std::string proven = client.proven_hello(), plain = proven.substr(0, seal::StreamSeal::kHello_bytes);
  for (const auto& [hello, told] : std::map<std::string, std::string>{
           {plain, ""}, {proven, frame_of(std::string{static_cast<char>(FramedStream::Refused::kNoPlace)})}}) {
    asio::io_context io(1);
    asio::ip::tcp::acceptor acceptor(io, {asio::ip::address_v4::loopback(), 0});
    asio::ip::tcp::socket socket(io);
    socket.connect(acceptor.local_endpoint());
    std::string failure;
    const auto server = std::make_shared<FramedStream>(
        acceptor.accept(), kRequestMax_bytes, 10s, [&](const std::string& why) { failure = why; }, std::nullopt);
    server->read_hello([&](const std::string& read) { server->refuse(FramedStream::Refused::kNoPlace, read); });
    asio::write(socket, asio::buffer(frame_of(hello)));
    io.run();
    EXPECT_EQ(failure, "it was refused");
    std::string answer;
    boost::system::error_code closed;
    asio::read(socket, asio::dynamic_buffer(answer), closed);
    EXPECT_EQ(answer, told);
  }
}

// All places are those of one computer, whose connections have asked for something each.
TEST(SnapshotServer, ABusyAddressMakesRoomForAnother) {
  const ProvidingPeer a(OperationLogs{}, random_bytes(1000, 1));
  asio::io_context io;
  std::vector<asio::ip::tcp::socket> busy;
  for (std::size_t i = 0; i < SnapshotServer::kProvenMax; ++i) {
    busy.emplace_back(io, asio::ip::tcp::endpoint(asio::ip::make_address("127.0.0.2"), 0)).connect(a.provider("").at);
    asio::write(busy.back(), asio::buffer(frame_of(encode(Request{kSession, OfferRequest{}}))));
    std::array<char, 4> answer{};
    asio::read(busy.back(), asio::buffer(answer));
  }
  const auto snapshot = must(fetch_snapshot({a.provider("a")}, kSession, {.connections = 4, .patience = 1h}));
  expect_all_of(snapshot, a);
}

// ---- providers that mean ill ----

asio::ip::address_v4 at(const char* address) { return asio::ip::make_address_v4(address); }

TEST(SnapshotFetch, TakesTheFilesThatMostAddressesOffer) {
  const std::string good = random_bytes(100'000, 1), bad = random_bytes(100'000, 2);
  const ProvidingPeer liar(OperationLogs{}, bad), twice(OperationLogs{}, bad);
  const ProvidingPeer a(OperationLogs{}, good, kSession, {}, at("127.0.0.2"));
  const ProvidingPeer b(OperationLogs{}, good, kSession, {}, at("127.0.0.3"));
  const auto snapshot = must(
      fetch_snapshot({liar.provider("liar"), twice.provider("twice"), a.provider("a"), b.provider("b")}, kSession));
  expect_all_of(snapshot, a);
  EXPECT_EQ(snapshot.provided_by, "a");
  EXPECT_THAT(snapshot.notes, testing::Contains(HasSubstr("liar at 127.0.0.1"))) << "and who";
}

std::uint64_t resident_bytes() {
  std::uint64_t all = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> all >> resident;
  return resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

Offer offer_of(std::uint64_t archive_bytes) {
  return {.protocol = replication::kProtocolVersion,
          .session = kSession,
          .world = "town",
          .settings = "",
          .genesis = 9,
          .archive_bytes = archive_bytes,
          .archive_digest = 1,
          .logs = {},
          .line = 0};
}

TEST(SnapshotFetch, AnOfferAloneTakesNoMemory) {
  std::atomic<std::uint64_t> most = 0;
  std::atomic<bool> is_asked = false;
  const std::uint64_t before = resident_bytes();
  const WilfulPeer liar(WilfulPeer::MakeReply([&](const std::string& request) -> Reply {
    if (std::holds_alternative<OfferRequest>(decode_request(request)->what)) return offer_of(std::uint64_t{1} << 30);
    is_asked = true;
    const std::uint64_t now = resident_bytes();
    most = std::max<std::uint64_t>(most, now - std::min(before, now));
    return Refusal{"no more"};
  }));
  EXPECT_THAT(error_of(fetch_snapshot({liar.provider("liar")}, kSession)), HasSubstr("no more"));
  EXPECT_TRUE(is_asked);
  EXPECT_LT(most, 200'000'000u);
}

Reply zeros_for(const std::string& request) {
  const Request asked = decode_request(request).value();
  if (std::holds_alternative<OfferRequest>(asked.what)) return offer_of(std::uint64_t{1} << 30);
  const auto& range = std::get<PartRequest>(asked.what).range;
  return Part{std::string(range.to - range.from, '\0')};
}

// Replies as an honest peer does, but for its offer.
WilfulPeer::MakeReply with_offer(const SnapshotContent& content, std::function<void(Offer&)> change) {
  return [&content, change = std::move(change)](const std::string& request) {
    Reply reply = reply_to(request, content);
    if (auto* offer = std::get_if<Offer>(&reply)) change(*offer);
    return reply;
  };
}

TEST(SnapshotFetch, TheSettingsTheLineAndTheNameAreThoseOfMost) {
  const std::string archive = random_bytes(100'000, 1);
  const OperationLogs none;
  const SnapshotContent content = content_of(archive, none);
  const ProvidingPeer a(OperationLogs{}, archive, kSession, {}, at("127.0.0.2"));
  const ProvidingPeer b(OperationLogs{}, archive, kSession, {}, at("127.0.0.3"));
  for (void (*const change)(Offer&) :
       {+[](Offer& offer) { offer.settings = "expansion = 2\n"; }, +[](Offer& offer) { offer.line = 7; },
        +[](Offer& offer) { offer.world = "village"; }}) {
    const WilfulPeer liar(with_offer(content, change));
    const auto snapshot = must(fetch_snapshot({liar.provider("liar"), a.provider("a"), b.provider("b")}, kSession));
    expect_all_of(snapshot, a);
    EXPECT_EQ(snapshot.offer.line, 0u);
    EXPECT_EQ(snapshot.provided_by, "a");
    EXPECT_THAT(snapshot.notes, testing::Contains(HasSubstr("liar at 127.0.0.1")));
  }
}

TEST(SnapshotFetch, ALogThatOneAddressAloneOffersIsNotFetched) {
  const std::string archive = random_bytes(100'000, 1);
  const OperationLogs held = some_logs(20);
  const SnapshotContent content = content_of(archive, held);
  std::atomic<bool> is_asked_for_invented = false;
  const auto change = [](Offer& offer) { offer.logs.push_back({AuthorId{99}, 900'000'000}); };
  const WilfulPeer liar(with_offer(content, change), [&](const Request& request) {
    const auto* part = std::get_if<PartRequest>(&request.what);
    if (part != nullptr && part->range.author == AuthorId{99}) is_asked_for_invented = true;
    return true;
  });
  const ProvidingPeer a(some_logs(20), archive, kSession, {}, at("127.0.0.2"));
  const ProvidingPeer b(some_logs(20), archive, kSession, {}, at("127.0.0.3"));
  const auto snapshot = must(fetch_snapshot({liar.provider("liar"), a.provider("a"), b.provider("b")}, kSession));
  expect_all_of(snapshot, a);
  EXPECT_FALSE(is_asked_for_invented);
}

// Logs grow meanwhile, so that one of two peers may have more of one.
TEST(SnapshotFetch, OfALogAsMuchIsFetchedAsTwoAddressesHave) {
  const std::string archive = random_bytes(100'000, 1);
  const ProvidingPeer a(some_logs(30), archive), b(some_logs(20), archive, kSession, {}, at("127.0.0.2"));
  const auto snapshot = must(fetch_snapshot({a.provider("a"), b.provider("b")}, kSession));
  expect_all_of(snapshot, b);
}

TEST(SnapshotFetch, AnotherSessionIsNotFetched) {
  const std::string archive = random_bytes(1000, 1);
  const OperationLogs none;
  const SnapshotContent content = content_of(archive, none);
  const WilfulPeer liar(with_offer(content, [](Offer& offer) { offer.session = kSession + 1; }));
  EXPECT_THAT(error_of(fetch_snapshot({liar.provider("liar")}, kSession)), HasSubstr("of another session"));
}

TEST(SnapshotFetch, NonsenseOfOnePeerEndsNothing) {
  const WilfulPeer liar{WilfulPeer::MakeReply(zeros_for)};
  const ProvidingPeer a(some_logs(20), random_bytes(100'000, 1), kSession, {}, at("127.0.0.2"));
  const auto snapshot = must(fetch_snapshot({liar.provider("liar"), a.provider("a")}, kSession));
  expect_all_of(snapshot, a);
  EXPECT_THAT(snapshot.notes, testing::Contains(HasSubstr("only nonsense is packed")));
}

TEST(SnapshotFetch, ASlowPeerEndsNothing) {
  const WilfulPeer slow(WilfulPeer::MakeReply([](const std::string& request) {
    std::this_thread::sleep_for(20ms);
    return zeros_for(request);
  }));
  const ProvidingPeer a(some_logs(20), random_bytes(100'000, 1), kSession, {}, at("127.0.0.2"));
  const FetchOptions options{.connections = 2, .patience = 2s, .slowest_bytes_per_s = 1e12};
  const auto snapshot = must(fetch_snapshot({slow.provider("slow"), a.provider("a")}, kSession, options));
  expect_all_of(snapshot, a);
  EXPECT_THAT(snapshot.notes, testing::Contains(HasSubstr("comes too slowly")));
}

// The liar is faster, so that its archive is the one that is compared with what was offered.
TEST(SnapshotFetch, AnotherArchiveThanWasOfferedIsGotFromOthers) {
  const std::string archive = random_bytes(1000, 1), other = random_bytes(1000, 2);
  const OperationLogs none;
  const SnapshotContent content = content_of(archive, none);
  std::promise<void> lied;
  const WilfulPeer liar(WilfulPeer::MakeReply([&, is_first = true](const std::string& request) mutable -> Reply {
    const Reply reply = reply_to(request, content);
    if (!std::holds_alternative<Part>(reply)) return reply;
    if (std::exchange(is_first, false)) lied.set_value();
    return Part{other};
  }));
  auto has_lied = lied.get_future().share();
  const WilfulPeer honest(content, [&](const Request& request) {
    if (!std::holds_alternative<PartRequest>(request.what)) return true;
    has_lied.wait();
    std::this_thread::sleep_for(300ms);
    return true;
  });
  const FetchOptions options{.connections = 2};
  const auto snapshot = must(fetch_snapshot({liar.provider("liar"), honest.provider("honest")}, kSession, options));
  EXPECT_EQ(snapshot.archive, archive);
  EXPECT_THAT(snapshot.notes, testing::Contains(HasSubstr("liar at 127.0.0.1")));
}

// A sealed peer in a thread of its own that takes each hello as it likes.
class HelloPeer {
 public:
  using Stream = std::shared_ptr<FramedStream>;
  using TakeHello = std::function<void(HelloPeer& self, const Stream& stream, const std::string& hello)>;
  HelloPeer(const SnapshotContent& content, const keys::SymmetricKey& key, TakeHello take_hello)
      : content_(content), key_(key), take_hello_(std::move(take_hello)) {
    acceptor_.listen();
    thread_ = std::thread([this] {
      accept();
      io_.run();
    });
  }
  HelloPeer(const HelloPeer&) = delete;
  HelloPeer& operator=(const HelloPeer&) = delete;
  ~HelloPeer() {
    io_.stop();
    thread_.join();
  }
  [[nodiscard]] Provider provider(const std::string& name) const { return {name, acceptor_.local_endpoint()}; }

  void answer_hello(const Stream& stream, const std::string& hello, FramedStream::OnDone done) {
    stream->answer_hello({key_, seal::StreamSeal::End::kServer}, hello, std::move(done));
  }
  void answer_request(const Stream& stream, FramedStream::OnDone done) {
    stream->read([this, stream, done = std::move(done)](const std::string& request) {
      stream->write(encode(reply_to(request, content_)), done);
    });
  }

 private:
  void accept() {
    acceptor_.async_accept([this](const boost::system::error_code& failed, asio::ip::tcp::socket socket) {
      if (failed) return;
      const auto stream = std::make_shared<FramedStream>(
          std::move(socket), kRequestMax_bytes, 10s, [](const auto&) {}, std::nullopt);
      stream->read_hello([this, stream](const std::string& hello) { take_hello_(*this, stream, hello); });
      accept();
    });
  }

  const SnapshotContent& content_;
  keys::SymmetricKey key_;
  TakeHello take_hello_;
  asio::io_context io_{1};
  asio::ip::tcp::acceptor acceptor_{io_, {asio::ip::address_v4::loopback(), 0}, false};

 public:
  std::vector<Stream> kept;  // the thread's

 private:
  std::thread thread_;
};

// A peer of before proofs closes the connection of a client that sends one. This one closes each after a reply, too.
TEST(SnapshotFetch, AnOlderPeerIsSentNoProofAgain) {
  const auto key = keys::SymmetricKey::random();
  const std::string archive = random_bytes(4 * kPartMax_bytes, 1);
  const OperationLogs none;
  const SnapshotContent content = content_of(archive, none);
  std::atomic<bool> has_replied = false;
  std::atomic<int> proofs_after_a_reply = 0;
  const HelloPeer older(content, key, [&](HelloPeer& self, const HelloPeer::Stream& stream, const std::string& hello) {
    const bool has_proof = seal::StreamSeal::has_proof(hello);
    if (has_proof && has_replied) ++proofs_after_a_reply;
    self.answer_hello(stream, hello, [&, stream, has_proof] {
      if (has_proof) return stream->close();
      self.answer_request(stream, [&, stream] {
        has_replied = true;
        stream->close();
      });
    });
  });
  const auto snapshot =
      must(fetch_snapshot({older.provider("older")}, kSession, FetchOptions{.connections = 1, .key = key}));
  EXPECT_EQ(snapshot.archive, archive);
  EXPECT_EQ(proofs_after_a_reply, 0);
}

// The first peer makes an offer and is found out to be of no use before offers are compared; the second one makes its
// offer after that, and the third one never does.
TEST(SnapshotFetch, OffersAreComparedWithoutAPeerThatMakesNone) {
  const auto key = keys::SymmetricKey::random();
  const std::string archive = random_bytes(1000, 1);
  const OperationLogs none;
  const SnapshotContent content = content_of(archive, none);
  const auto say_no_key = [](const HelloPeer::Stream& stream) { stream->write("no key", [] {}); };
  const HelloPeer useless(content, key,
                          [&, is_first = true, has_offered = std::make_shared<bool>(false)](
                              HelloPeer& self, const HelloPeer::Stream& stream, const std::string& hello) mutable {
                            if (!std::exchange(is_first, false))
                              return *has_offered ? say_no_key(stream) : self.kept.push_back(stream);
                            self.answer_hello(stream, hello, [&, stream, has_offered] {
                              self.answer_request(stream, [&, has_offered] {
                                std::this_thread::sleep_for(200ms);
                                *has_offered = true;
                                for (const auto& each : self.kept) say_no_key(each);
                              });
                            });
                          });
  ProvidingPeer good(OperationLogs{}, archive, kSession, key, at("127.0.0.2"));
  asio::post(good.io, [] { std::this_thread::sleep_for(1500ms); });
  asio::io_context io;
  const asio::ip::tcp::acceptor mute(io, {at("127.0.0.3"), 0});
  const FetchOptions options{.connections = 6, .patience = 8s, .key = key};
  const auto began = std::chrono::steady_clock::now();
  const auto snapshot =
      must(fetch_snapshot({useless.provider("useless"), good.provider("good"), Provider{"mute", mute.local_endpoint()}},
                          kSession, options));
  EXPECT_EQ(snapshot.provided_by, "good");
  EXPECT_LT(std::chrono::steady_clock::now() - began, 8s);
  EXPECT_THAT(snapshot.notes, testing::Contains(HasSubstr("it is open, and does not have the key")));
}

TEST(SnapshotFetch, WhatComesIsNotUnpackedWithoutLimit) {
  const std::uint64_t before = resident_bytes();
  const WilfulPeer liar{WilfulPeer::MakeReply(zeros_for)};
  EXPECT_THAT(error_of(fetch_snapshot({liar.provider("liar")}, kSession)), HasSubstr("only nonsense is packed"));
  const std::uint64_t now = resident_bytes();
  EXPECT_LT(now - std::min(before, now), 400'000'000u);
}

TEST(SnapshotFetch, NobodyHoldsItForEver) {
  const WilfulPeer slow(WilfulPeer::MakeReply([](const std::string& request) {
    std::this_thread::sleep_for(20ms);
    return zeros_for(request);
  }));
  const FetchOptions options{.connections = 1, .patience = 300ms, .slowest_bytes_per_s = 1e12};
  EXPECT_THAT(error_of(fetch_snapshot({slow.provider("slow")}, kSession, options)),
              AllOf(HasSubstr("slow at 127.0.0.1"), HasSubstr("comes too slowly")));
}

}  // namespace peerd::snapshot::snapshot_fetch_test
