#include "peerd/net/snapshot/snapshot_message.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/must.hpp"

namespace peerd::snapshot::snapshot_message_test {

using replication::AuthorId;

const std::vector<Request>& requests() {
  static const std::vector<Request> all{
      {7, OfferRequest{}},
      {0, PartRequest{{AuthorId{3}, 10, 20}}},
      {1, PartRequest{{replication::kNoAuthor, 0, kPartMax_bytes}}},
      {2, DigestRequest{{{AuthorId{1}, 5}, {AuthorId{replication::kAuthorMax}, std::uint64_t{1} << 40}}}}};
  return all;
}

const std::vector<Reply>& replies() {
  static const std::vector<Reply> all{Refusal{"this peer does not hold that"},
                                      Offer{.protocol = 9,
                                            .session = 8,
                                            .world = "town",
                                            .settings = "expansion = 1\n",
                                            .genesis = 7,
                                            .archive_bytes = 100,
                                            .archive_digest = 6,
                                            .logs = {{AuthorId{4}, 3}}},
                                      Part{std::string(kPartMax_bytes, 'x')}, Digests{{0, 1, ~std::uint64_t{0}}}};
  return all;
}

TEST(SnapshotMessage, IsReadAsItWasWritten) {
  for (const Request& request : requests()) {
    EXPECT_EQ(must(decode_request(encode(request))), request);
  }
  for (const Reply& reply : replies()) {
    EXPECT_EQ(must(decode_reply(encode(reply))), reply);
  }
}

TEST(SnapshotMessage, WhatItCannotBeIsRefused) {
  EXPECT_FALSE(decode_request(""));
  EXPECT_FALSE(decode_request("nonsense"));
  EXPECT_FALSE(decode_request(encode(Request{1, PartRequest{{AuthorId{3}, 20, 20}}})));
  EXPECT_FALSE(decode_request(encode(Request{1, PartRequest{{AuthorId{3}, 0, kPartMax_bytes + 1}}})));
  EXPECT_FALSE(decode_request(encode(Request{1, PartRequest{{AuthorId{replication::kAuthorMax + 1}, 0, 1}}})));
  EXPECT_FALSE(decode_request(encode(Request{1, DigestRequest{{{AuthorId{2}, 1}, {AuthorId{1}, 1}}}})));
  EXPECT_FALSE(decode_request(encode(Request{1, DigestRequest{{{AuthorId{2}, 0}}}})));
  EXPECT_FALSE(decode_reply(""));
  EXPECT_FALSE(decode_reply(encode(Reply{Part{std::string(kPartMax_bytes + 1, 'x')}})));
}

TEST(SnapshotMessage, ChangedBytesAreReadOrRefused) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20'000; ++i) {
    std::string request = encode(requests()[random() % requests().size()]);
    std::string reply = encode(replies()[random() % replies().size()]);
    if (!request.empty()) request[random() % request.size()] = static_cast<char>(random());
    reply[random() % reply.size()] = static_cast<char>(random());
    (void)decode_request(request);
    const auto read = decode_reply(reply);
    if (const auto* part = read ? std::get_if<Part>(&*read) : nullptr) {
      EXPECT_LE(part->bytes.size(), kPartMax_bytes);
    }
  }
}

TEST(Digest, DependsOnEachByteAndTheLength) {
  const std::string bytes = "seventeen letters";
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::string changed = bytes;
    changed[i] ^= 1;
    EXPECT_NE(digest(changed), digest(bytes)) << i;
    EXPECT_NE(digest(bytes.substr(0, i)), digest(bytes)) << i;
  }
  EXPECT_NE(digest(std::string(8, '\0')), digest(std::string(16, '\0')));
  EXPECT_EQ(digest(bytes), digest(std::string(bytes)));
}

}  // namespace peerd::snapshot::snapshot_message_test
