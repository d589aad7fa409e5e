#include "peerd/net/seal/stream_seal.hpp"

#include <gtest/gtest.h>

namespace peerd::seal {
namespace {

std::string_view text(const StreamSeal::Hello& hello) {
  return {reinterpret_cast<const char*>(hello.data()), hello.size()};
}

class SealedStreams : public testing::Test {
 protected:
  // Lets the two exchange their keys.
  static void meet(StreamSeal& one, StreamSeal& other) {
    ASSERT_TRUE(one.take_hello(text(other.hello())));
    ASSERT_TRUE(other.take_hello(text(one.hello())));
  }
  const keys::SymmetricKey key = keys::SymmetricKey::random();
  StreamSeal client{key, StreamSeal::End::kClient}, server{key, StreamSeal::End::kServer};
};

TEST_F(SealedStreams, CarryFramesInOrder) {
  meet(client, server);
  for (const char* const frame : {"one", "", "three"}) EXPECT_EQ(server.open(client.seal(frame)), frame);
  const std::string long_one(1 << 20, 'x');
  EXPECT_EQ(client.open(server.seal(long_one)), long_one);
}

TEST_F(SealedStreams, NoFrameIsChangedRepeatedLeftOutOrTurnedBack) {
  meet(client, server);
  const std::string first = client.seal("first"), second = client.seal("second");
  for (std::size_t at = 0; at < first.size(); ++at) {
    std::string bad = first;
    bad[at] = static_cast<char>(bad[at] ^ 1);
    EXPECT_FALSE(server.open(bad)) << at;
    EXPECT_FALSE(server.open(first.substr(0, at))) << at;
  }
  EXPECT_FALSE(server.open(second)) << "the first is left out";
  EXPECT_FALSE(client.open(first)) << "its own";
  EXPECT_EQ(server.open(first), "first");
  EXPECT_FALSE(server.open(first)) << "once more";
  EXPECT_EQ(server.open(second), "second");
}

TEST_F(SealedStreams, AClientProvesThatItHasTheKey) {
  const std::string hello = client.proven_hello();
  EXPECT_EQ(hello.substr(0, StreamSeal::kHello_bytes), text(client.hello()));
  EXPECT_TRUE(StreamSeal::has_proof(hello));
  EXPECT_TRUE(StreamSeal::is_proven(key, hello));
  EXPECT_FALSE(StreamSeal::is_proven(keys::SymmetricKey::random(), hello));
  for (std::size_t at = 0; at < hello.size(); ++at) {
    std::string bad = hello;
    bad[at] = static_cast<char>(bad[at] ^ 1);
    EXPECT_FALSE(StreamSeal::is_proven(key, bad)) << at;
    EXPECT_FALSE(StreamSeal::is_proven(key, hello.substr(0, at)));
  }
}

TEST_F(SealedStreams, AnotherKeyOpensNothing) {
  StreamSeal outsider(keys::SymmetricKey::random(), StreamSeal::End::kClient);
  meet(outsider, server);
  EXPECT_FALSE(server.open(outsider.seal("hello")));
  EXPECT_FALSE(outsider.open(server.seal("hello")));
}

// Somebody between the two gives each a key of their own.
TEST_F(SealedStreams, WhoStandsBetweenOpensNothing) {
  StreamSeal to_client(keys::SymmetricKey::random(), StreamSeal::End::kServer);
  StreamSeal to_server(keys::SymmetricKey::random(), StreamSeal::End::kClient);
  meet(client, to_client);
  meet(to_server, server);
  EXPECT_FALSE(to_client.open(client.seal("a request")));
  EXPECT_FALSE(server.open(to_server.seal("a request")));
}

// The same secret bits, and what was recorded: the fresh keys are what it lacks.
TEST_F(SealedStreams, ARecordIsNotOpenedByTheKeyAlone) {
  meet(client, server);
  const std::string recorded = client.seal("a secret");
  StreamSeal later(key, StreamSeal::End::kServer);
  ASSERT_TRUE(later.take_hello(text(client.hello())));
  EXPECT_FALSE(later.open(recorded));
}

TEST_F(SealedStreams, SomePointsAreNoKeys) {
  EXPECT_FALSE(client.take_hello(std::string(StreamSeal::kHello_bytes, '\0'))) << "a point of low order";
  EXPECT_FALSE(client.take_hello(std::string(StreamSeal::kHello_bytes - 1, 'a')));
  EXPECT_FALSE(client.take_hello(std::string(StreamSeal::kHello_bytes + 1, 'a')));
}

}  // namespace
}  // namespace peerd::seal
