#include "peerd/net/seal/sealed_greetings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string_view>

namespace peerd::seal {
namespace {

using boost::asio::ip::udp;
using Bytes = std::vector<std::byte>;
using testing::ElementsAre;

const udp::endpoint kFrom(boost::asio::ip::make_address("192.0.2.1"), 4000);
constexpr HostTime kBegin{std::chrono::seconds(1'000)};

Bytes bytes_of(std::string_view text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

class SealedGreetingsTest : public testing::Test {
 protected:
  [[nodiscard]] std::optional<Bytes> open(const Bytes& sealed, HostTime at = kBegin) {
    return there.open(sealed, at, kFrom);
  }
  const keys::SymmetricKey key = keys::SymmetricKey::random();
  std::vector<std::string> lines;
  SealedGreetings here{SealedGreetings::key_of(key), [](const std::string&) {}};
  SealedGreetings there{SealedGreetings::key_of(key), [this](const std::string& line) { lines.push_back(line); }};
};

TEST_F(SealedGreetingsTest, AreOpenedByTheSameKeyAlone) {
  const Bytes greeting = bytes_of("G, and what follows");
  const Bytes sealed = here.seal(greeting);
  EXPECT_EQ(sealed.size(), greeting.size() + SealedGreetings::kAdded_bytes);
  EXPECT_EQ(open(sealed), greeting);
  EXPECT_NE(here.seal(greeting), sealed) << "nobody sees that it is the same";
  EXPECT_EQ(open(here.seal({})), Bytes());
  EXPECT_THAT(lines, testing::IsEmpty());
  SealedGreetings other(keys::SymmetricKey::random(), [](const std::string&) {});
  EXPECT_FALSE(other.open(sealed, kBegin, kFrom));
}

TEST_F(SealedGreetingsTest, AreNotOpenedWhereABitIsAnotherOrTheyAreCut) {
  const Bytes sealed = here.seal(bytes_of("G"));
  for (std::size_t bit = 0; bit < 8 * sealed.size(); ++bit) {
    Bytes flipped = sealed;
    flipped[bit / 8] ^= std::byte{1} << bit % 8;
    EXPECT_FALSE(open(flipped)) << bit;
  }
  for (std::size_t size = 0; size < sealed.size(); ++size)
    EXPECT_FALSE(open({sealed.begin(), sealed.begin() + static_cast<std::ptrdiff_t>(size)}));
}

TEST_F(SealedGreetingsTest, NameOnceAMinuteWhoHasAnotherKeyOrNone) {
  EXPECT_FALSE(open(bytes_of("G, in the clear")));
  EXPECT_FALSE(open(bytes_of("G, once more"), kBegin + std::chrono::seconds(59)));
  EXPECT_FALSE(open(Bytes(100, SealedGreetings::kMark), kBegin + std::chrono::seconds(60)));
  EXPECT_THAT(lines, ElementsAre("192.0.2.1 port 4000 greets without a seal: it was started with --open",
                                 "192.0.2.1 port 4000 greets by another key, or forges"));
}

}  // namespace
}  // namespace peerd::seal
