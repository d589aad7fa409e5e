// Signatures of a log, with a signer whose digests and signatures everybody could find. What cannot be forged is a
// matter of the peer's own signer.
#include "replication/edits/log/signed_log.hpp"

#include <gtest/gtest.h>

#include <string_view>

#include "tests/replication/peer/operations.hpp"

namespace peerd::replication::signed_log_test {
namespace {

using Bytes = std::vector<std::byte>;
using test::OperationMaker;

constexpr AuthorId kOne{1};
constexpr const char* kRefused = "not_on_the_list";

class Signer final : public LogSigner {
 public:
  Digest digest(const Digest& before, std::span<const std::byte> bytes) const override {
    Digest out = before;
    std::uint32_t sum = 1;
    for (const std::byte b : bytes) {
      sum = sum * 31 + static_cast<std::uint32_t>(b);
      out[sum % out.size()] = static_cast<std::uint8_t>(out[sum % out.size()] * 7 + (sum >> 16));
    }
    return out;
  }
  Bytes own_key() const override { return Bytes(32, std::byte{0x77}); }
  std::array<std::byte, kSignature_bytes> sign(AuthorId author, const Digest& digest) const override {
    std::array<std::byte, kSignature_bytes> out{};
    for (std::size_t i = 0; i < digest.size(); ++i) out[i] = static_cast<std::byte>(digest[i] ^ author.value);
    return out;
  }
  const char* why_not_write() const override { return nullptr; }
  const char* refused(AuthorId, std::span<const std::byte>) const override { return refuses ? kRefused : nullptr; }
  bool is_good(AuthorId author, std::span<const std::byte> key, const Digest& digest,
               Signature signature) const override {
    return std::ranges::equal(key, own_key()) && std::ranges::equal(signature, sign(author, digest));
  }

  Writer writer(std::span<const std::byte>) const override { return {}; }

  bool refuses = false;
};

// A log of three operations, and where each ends.
struct SignedLogs : testing::Test {
  SignedLogs() {
    OperationMaker make(1);
    SignedLog writes;
    for (std::uint32_t number = 1; number <= 3; ++number) {
      Bytes next = encode_unsigned(make.operation({kOne, number}), writes.key_of_next(signer));
      writes.sign(signer, kOne, next);
      log.insert(log.end(), next.begin(), next.end());
      ends.push_back(log.size());
    }
  }
  void expect(const SignedLog::Checked& checked, std::size_t bytes, const char* wrong) const {
    EXPECT_EQ(checked.bytes, bytes);
    EXPECT_EQ(std::string_view(checked.wrong != nullptr ? checked.wrong : "nothing"),
              std::string_view(wrong != nullptr ? wrong : "nothing"));
  }

  Signer signer;
  Bytes log;
  std::vector<std::size_t> ends;
  SignedLog reads;
};

TEST_F(SignedLogs, AreGoodAsAWholeAndOneByOne) {
  SignedLog whole;
  expect(whole.check(signer, kOne, log), log.size(), nullptr);
  std::size_t from = 0;
  for (const std::size_t end : ends) {
    expect(reads.check(signer, kOne, std::span(log).subspan(from, end - from)), end - from, nullptr);
    from = end;
  }
}

TEST_F(SignedLogs, WhatIsNotWholeYetWaits) {
  expect(reads.check(signer, kOne, std::span(log).first(ends[0] - 1)), 0, nullptr);
  expect(reads.check(signer, kOne, std::span(log).first(ends[1] + 3)), ends[1], nullptr);
  expect(reads.check(signer, kOne, std::span(log).subspan(ends[1])), ends[2] - ends[1], nullptr);
}

// Its signatures are good all the same: the key is what this peer does not take.
TEST_F(SignedLogs, OfARefusedKeyNothingIsTaken) {
  signer.refuses = true;
  expect(reads.check(signer, kOne, log), 0, kRefused);
  expect(reads.check(signer, kOne, log), 0, kRefused);
  signer.refuses = false;
  expect(reads.check(signer, kOne, log), log.size(), nullptr);
}

TEST_F(SignedLogs, AreTakenUpToTheFirstForgedOperation) {
  Bytes forged = log;
  forged[ends[2] - 1] ^= std::byte{1};
  expect(reads.check(signer, kOne, forged), ends[1], kForgedOperation);
  expect(reads.check(signer, kOne, std::span(log).subspan(ends[1])), ends[2] - ends[1], nullptr);
}

TEST_F(SignedLogs, AnUnsignedOperationIsNamed) {
  OperationMaker make(2);
  const Bytes unsigned_one = encode(make.operation({kOne, 4}));
  log.insert(log.end(), unsigned_one.begin(), unsigned_one.end());
  expect(reads.check(signer, kOne, log), ends[2], kUnsignedOperation);
  expect(reads.check(signer, kOne, std::span(log).subspan(ends[2])), 0, kUnsignedOperation);
}

}  // namespace
}  // namespace peerd::replication::signed_log_test
