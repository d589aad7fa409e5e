// Locks in a world with a roster, among whole peers whose operations are signed.
#include <gtest/gtest.h>

#include "core/vrml/document.hpp"
#include "peerd/net/seal/operation_signer.hpp"
#include "tests/replication/peer/lan.hpp"

namespace peerd::seal::locks_test {
namespace {

using namespace replication;
using namespace replication::test;

// Anna is the administrator, Bo an editor. Cy becomes another administrator by a later roster.
class RosterLocks : public testing::Test {
 protected:
  struct Member {
    keys::Identity identity = keys::Identity::random();
    Author author = fresh_author(identity.public_key());
    const keys::Roster* roster = nullptr;  // that it knows
    std::unique_ptr<OperationSigner> signer;
  };

  RosterLocks() {
    for (Member* member : {&anna, &bo, &cy}) {
      member->roster = &early;
      member->signer = std::make_unique<OperationSigner>(
          0xC0FFEE, member->identity, member->author.salt,
          [member](const keys::PublicKey& key) { return member->roster->may_write(key); },
          [member](const keys::PublicKey& key) { return writer_by(*member->roster, key); });
      PeerConfig c = replication::test::config(static_cast<std::uint32_t>(1 + lan.size()));
      c.author = member->author.id;
      c.signer = member->signer.get();
      lan.add(c);
    }
    lan.run_until(3s);
  }
  void run_on(Duration d) { lan.run_until(lan.now() + d); }
  // Why it is not made; empty: it is.
  std::string edit(std::size_t i, OperationBody body) {
    const auto id = lan.peer(i).edit(lan.host_now(i), std::move(body));
    run_on(1s);
    return id ? "" : id.error();
  }
  void learn(std::size_t i, Member& member) {
    member.roster = &late;
    lan.peer(i).follow_writers();
  }
  [[nodiscard]] NodeId car() const {
    const Scene& scene = lan.peer(0).scene();
    return scene.document->ids.id_of(scene.at(*scene.find("CAR")).node);
  }
  [[nodiscard]] std::string colour(std::size_t i) const {
    const std::string* const value = lan.peer(i).data().find(car(), "colour");
    return value == nullptr ? "none" : *value;
  }

  Member anna, bo, cy;
  const keys::Roster early = keys::Roster::first("town", "anna", anna.identity)
                                 .with({"bo", keys::Role::kEditor, bo.identity.public_key()}, anna.identity)
                                 .value();
  const keys::Roster late =
      early.with({"cy", keys::Role::kAdministrator, cy.identity.public_key()}, anna.identity).value();
  const World world{box("CAR", "1 1 1", "0 0 0"), {"CAR"}};
  Lan lan{world};
};

TEST_F(RosterLocks, AdministratorsAloneLock) {
  EXPECT_EQ(edit(1, LockObject{world["CAR"]}), "administrators alone lock and unlock");
  EXPECT_EQ(edit(0, LockObject{world["CAR"]}), "");
  EXPECT_EQ(edit(1, SetData{car(), "colour", "red"}), "it is locked by anna");
  EXPECT_EQ(edit(1, LockObject{world["CAR"], true}), "administrators alone lock and unlock");
  EXPECT_EQ(edit(0, SetData{car(), "colour", "blue"}), "");
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(colour(i), "blue");
    ASSERT_EQ(lan.peer(i).locks().size(), 1u);
    EXPECT_EQ(lan.peer(i).locks().front().by, "anna");
  }
  EXPECT_EQ(edit(0, LockObject{world["CAR"], true}), "");
  EXPECT_EQ(edit(1, SetData{car(), "colour", "red"}), "");
  EXPECT_EQ(colour(0), "red");
}

TEST_F(RosterLocks, ANewAdministratorOverrulesThem) {
  EXPECT_EQ(edit(0, LockObject{world["CAR"]}), "");
  learn(0, anna);
  learn(2, cy);
  EXPECT_EQ(edit(2, SetData{car(), "colour", "green"}), "");
  EXPECT_EQ(edit(2, LockObject{world["CAR"], true}), "");
  EXPECT_EQ(colour(0), "green");
  EXPECT_EQ(colour(1), "none") << "who does not know it yet takes nothing of its";
  EXPECT_EQ(lan.peer(1).locks().size(), 1u);
  learn(1, bo);
  run_on(5s);
  EXPECT_EQ(colour(1), "green");
  EXPECT_TRUE(lan.peer(1).locks().empty());
  EXPECT_EQ(edit(1, SetData{car(), "colour", "red"}), "");
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(colour(i), "red");
}

TEST_F(RosterLocks, WritersAreUsers) {
  const keys::PublicKey key = anna.identity.public_key();
  EXPECT_EQ(writer_by(early, key).name, "anna");
  EXPECT_TRUE(writer_by(early, key).overrules);
  EXPECT_FALSE(writer_by(early, bo.identity.public_key()).may_lock);
  EXPECT_FALSE(writer_by(early, cy.identity.public_key()).may_lock);
  EXPECT_TRUE(writer_by(late, cy.identity.public_key()).may_lock);
  EXPECT_TRUE(writer_without_roster(key).may_lock);
  EXPECT_FALSE(writer_without_roster(key).overrules);
  const OperationSigner other_start(0xC0FFEE, anna.identity, anna.author.salt + 1,
                                    [](const keys::PublicKey&) { return true; });
  EXPECT_EQ(other_start.writer(other_start.own_key()).user, anna.signer->writer(anna.signer->own_key()).user);
  EXPECT_NE(other_start.writer(other_start.own_key()).user, bo.signer->writer(bo.signer->own_key()).user);
}

}  // namespace
}  // namespace peerd::seal::locks_test
