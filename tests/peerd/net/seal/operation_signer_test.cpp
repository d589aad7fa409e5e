// Logs of operations whose authors sign them, and those who pretend to be them.
#include "peerd/net/seal/operation_signer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "replication/edits/log/operation_log.hpp"
#include "tests/must.hpp"
#include "tests/replication/peer/operations.hpp"

namespace peerd::seal::operation_signer_test {
namespace {

using replication::Author;
using replication::AuthorId;
using replication::OperationLogs;
using replication::OperationPart;
using replication::test::OperationMaker;
using Bytes = std::vector<std::byte>;

constexpr std::uint64_t kWorld = 77;

bool all_write(const keys::PublicKey&) { return true; }

// Somebody who writes a log.
struct Writer {
  explicit Writer(std::uint32_t operations = 0, std::uint64_t world = kWorld, std::uint64_t seed = 1)
      : signer(world, identity, author.salt, all_write), logs(author.id, &signer), make(seed) {
    for (std::uint32_t i = 0; i < operations; ++i) write();
  }
  void write() { EXPECT_TRUE(logs.append(make.operation({author.id, logs.last(author.id).number + 1}))); }
  [[nodiscard]] Bytes log() const { return logs.bytes({author.id, 0, logs.length(author.id)}); }

  keys::Identity identity = keys::Identity::random();
  Author author = fresh_author(identity.public_key());
  OperationSigner signer;
  OperationLogs logs;
  OperationMaker make;
};

// The reason why a reader does not take them, and how many it has taken.
std::string taken(OperationLogs& reader, AuthorId author, std::uint64_t from, const Bytes& bytes) {
  const auto operations = reader.receive({author, from, bytes});
  return operations ? std::to_string(operations->size()) : operations.error();
}

TEST(SignedLogs, AreTakenWholeAndInParts) {
  Writer writer(40);
  const Bytes log = writer.log();
  std::mt19937 random(2);
  for (int round = 0; round < 50; ++round) {
    Writer reader;
    std::size_t operations = 0;
    std::vector<OperationPart> parts;
    for (std::size_t from = 0; from < log.size();) {
      const std::size_t to = std::min(log.size(), from + 1 + random() % 700);
      parts.push_back(
          {writer.author.id,
           from,
           {log.begin() + static_cast<std::ptrdiff_t>(from), log.begin() + static_cast<std::ptrdiff_t>(to)}});
      from = to;
    }
    std::ranges::shuffle(parts, random);
    for (const OperationPart& part : parts) {
      const auto read = must(reader.logs.receive(part));
      operations += read.size();
    }
    EXPECT_EQ(operations, 40u);
    EXPECT_EQ(reader.logs.bytes({writer.author.id, 0, log.size()}), log);
  }
}

// Any byte of a log: what comes before it is taken, and what is behind it once it is right again.
TEST(SignedLogs, NoChangedByteIsTaken) {
  Writer writer(6);
  const Bytes log = writer.log();
  for (std::size_t at = 0; at < log.size(); ++at) {
    Writer reader;
    Bytes changed = log;
    changed[at] ^= std::byte{1};
    const auto read = reader.logs.receive({writer.author.id, 0, changed});
    ASSERT_TRUE(!read || read->size() < 6) << at;
    ASSERT_LE(reader.logs.whole(writer.author.id), at);
    ASSERT_EQ(reader.logs.unreadable(writer.author.id), nullptr) << at;
    (void)reader.logs.receive({writer.author.id, 0, log});  // what waits for its end goes, and comes once more
    (void)reader.logs.receive({writer.author.id, 0, log});
    ASSERT_EQ(reader.logs.whole(writer.author.id), log.size()) << at;
  }
}

// Each keeps the operations in their order and their number: a signature is over all before it.
TEST(SignedLogs, NoOperationIsLeftOutOrStandsElsewhere) {
  Writer writer(1);
  std::vector<Bytes> operations;
  std::uint64_t end = 0;
  for (int i = 0; i < 4; ++i) {
    operations.push_back(writer.logs.bytes({writer.author.id, end, writer.logs.length(writer.author.id)}));
    end = writer.logs.length(writer.author.id);
    writer.write();
  }
  std::vector<std::size_t> order{0, 1, 2, 3};
  do {
    Writer reader;
    Bytes log;
    for (const std::size_t i : order) log.insert(log.end(), operations[i].begin(), operations[i].end());
    const auto right = static_cast<std::size_t>(std::ranges::mismatch(order, std::vector<std::size_t>{0, 1, 2, 3}).in1 -
                                                order.begin());
    const auto read = reader.logs.receive({writer.author.id, 0, log});
    EXPECT_EQ(read ? read->size() : 0, right);
  } while (std::ranges::next_permutation(order).found);
}

// A signature that is bad goes with what is behind it, though the last one is good.
TEST(SignedLogs, AGoodSignatureVouchesForThoseBeforeIt) {
  Writer writer(3);
  Bytes log = writer.log();
  const std::size_t second = writer.logs.length(writer.author.id);
  writer.write();
  log[second - 1] ^= std::byte{1};  // the third one's signature
  const Bytes last = writer.logs.bytes({writer.author.id, second, writer.logs.length(writer.author.id)});
  log.insert(log.end(), last.begin(), last.end());
  Writer reader;
  EXPECT_EQ(taken(reader.logs, writer.author.id, 0, log), "2");
}

TEST(SignedLogs, NobodyElseBeginsTheLogOfAnAuthor) {
  Writer writer(1), other(1);
  Writer reader;
  EXPECT_EQ(taken(reader.logs, writer.author.id, 0, other.log()), replication::kForgedOperation);
  EXPECT_EQ(taken(reader.logs, writer.author.id, 0, writer.log()), "1");
}

TEST(SignedLogs, WhatNobodyHasSignedIsNotTaken) {
  OperationLogs open(AuthorId{9});
  ASSERT_TRUE(open.append(OperationMaker(1).operation({AuthorId{9}, 1})));
  Writer reader;
  EXPECT_EQ(taken(reader.logs, AuthorId{9}, 0, open.bytes({AuthorId{9}, 0, open.length(AuthorId{9})})),
            replication::kUnsignedOperation);
  EXPECT_TRUE(reader.logs.empty());
}

TEST(SignedLogs, AreOfOneWorld) {
  Writer elsewhere(1, kWorld + 1);
  Writer reader;
  EXPECT_EQ(taken(reader.logs, elsewhere.author.id, 0, elsewhere.log()), replication::kForgedOperation);
}

TEST(SignedLogs, OfThoseWhoMayOnlyLookAreNotTaken) {
  Writer writer(1), observer(1);
  const OperationSigner strict(kWorld, keys::Identity::random(), 1,
                               [&](const keys::PublicKey& key) { return key == writer.identity.public_key(); });
  OperationLogs reader(replication::kNoAuthor, &strict);
  EXPECT_EQ(taken(reader, observer.author.id, 0, observer.log()), kObserversOperation);
  EXPECT_EQ(taken(reader, writer.author.id, 0, writer.log()), "1");
}

// Forged bytes that claim to begin a large operation do not stand in the way of the real one.
TEST(SignedLogs, UnfinishedForgeriesGiveWay) {
  Writer writer(2);
  const Bytes log = writer.log();
  writer.write();
  const Bytes next = writer.logs.bytes({writer.author.id, log.size(), writer.logs.length(writer.author.id)});
  Writer reader;
  ASSERT_EQ(taken(reader.logs, writer.author.id, 0, log), "2");
  const Bytes forged{std::byte{0xFF}, std::byte{0xFF}, std::byte{0x3F}, std::byte{1}};  // the largest size
  ASSERT_EQ(taken(reader.logs, writer.author.id, log.size(), forged), "0");
  EXPECT_EQ(taken(reader.logs, writer.author.id, log.size(), next), "forked_log") << "and both are dropped";
  EXPECT_EQ(taken(reader.logs, writer.author.id, log.size(), next), "1") << "it is asked for again";
}

// A log that comes back from the store is checked in the same way, and goes on.
TEST(SignedLogs, GoOnAfterARestart) {
  Writer writer(5);
  OperationLogs again(writer.author.id, &writer.signer);
  ASSERT_TRUE(again.restore({writer.author.id, 0, writer.log()}));
  ASSERT_TRUE(again.append(writer.make.operation({writer.author.id, 6})));
  Writer reader;
  EXPECT_EQ(taken(reader.logs, writer.author.id, 0, again.bytes({writer.author.id, 0, again.length(writer.author.id)})),
            "6");
}

TEST(SignedLogs, CostSixtySevenBytesAnOperation) {
  Writer writer;
  OperationLogs open(AuthorId{9});
  const auto operation = OperationMaker(1).operation({writer.author.id, 1});
  ASSERT_TRUE(writer.logs.append(operation));
  const std::uint64_t first = writer.logs.length(writer.author.id);
  writer.write();
  const auto second = writer.logs.operation({writer.author.id, 2});
  EXPECT_LE(first - replication::encode(operation).size(), 67u + 42u + 1u) << "with the author's key";
  EXPECT_LE(writer.logs.length(writer.author.id) - first - replication::encode(second).size(), 67u + 1u);
}

}  // namespace
}  // namespace peerd::seal::operation_signer_test
