#include "peerd/net/seal/relay_key.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "peerd/net/seal/sealed_greetings.hpp"
#include "tests/must.hpp"
#include "tests/peerd/net/relay/relay_fixture.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::seal::relay_key_test {

using namespace relay::testing_support;
using testing::HasSubstr;

using RelayKeyTest = RelayFixture;

// The key that opens greetings is not the session's.
TEST(RelayKey, ComesBackFromItsFileAndIsNotTheSessions) {
  const peerd::testing_support::ScratchFolder folder;
  const auto session = keys::SymmetricKey::random();
  folder.write("relay.key", relay_key_text(session) + "\n");
  std::filesystem::permissions(folder / "relay.key", std::filesystem::perms::owner_read);
  const auto read = must(read_relay_key(folder / "relay.key"));
  EXPECT_EQ(read, SealedGreetings::key_of(session));
  EXPECT_FALSE(read == session);
}

TEST(RelayKey, AnythingElseIsRefusedByASentence) {
  const peerd::testing_support::ScratchFolder folder;
  const auto refused = [&](const std::string& text, std::filesystem::perms perms) {
    const auto file = folder / "wrong.key";
    std::filesystem::remove(file);
    folder.write("wrong.key", text);
    std::filesystem::permissions(file, perms);
    const auto read = read_relay_key(file);
    return read ? std::string("read") : read.error().text;
  };
  using std::filesystem::perms;
  const std::string good = relay_key_text(keys::SymmetricKey::random());
  EXPECT_THAT(refused(keys::SymmetricKey::random().text(), perms::owner_read), HasSubstr("no line of peerd invite"));
  EXPECT_THAT(refused(good.substr(0, good.size() - 4), perms::owner_read), HasSubstr("no line of peerd invite"));
  EXPECT_NE(refused(good, perms::owner_read | perms::others_read), "read");
  EXPECT_FALSE(read_relay_key(folder / "none.key"));
}

TEST_F(RelayKeyTest, SealedGreetingsMeetByTheRelaysKeyAlone) {
  const auto session = keys::SymmetricKey::random();
  const auto sealed_by = [](const keys::SymmetricKey& key) {
    return std::make_shared<seal::SealedGreetings>(seal::SealedGreetings::key_of(key), [](const std::string&) {});
  };
  RelayUnderTest relay(io, 0, {}, sealed_by(session));
  relay.join_island(0);
  relay.relay->start();
  Peer a(by_relay({0}, sealed_by(session))), b(on_island(0, sealed_by(session))), open(by_relay({0})),
      other(by_relay({0}, sealed_by(keys::SymmetricKey::random())));
  ASSERT_TRUE(run_until(io, [&] {
    if (a.can_send(0)) a.send(0, "sealed");
    return !b.heard.empty();
  }));
  EXPECT_EQ(relay.peers(), 1u);
  EXPECT_EQ(open.through().relay(), nullptr);
  EXPECT_EQ(other.through().relay(), nullptr);
  EXPECT_GT(relay.relay->traffic().greetings_unopened, 0u);
}

}  // namespace peerd::seal::relay_key_test
