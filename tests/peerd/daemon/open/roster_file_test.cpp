#include "peerd/daemon/open/roster_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/must.hpp"
#include "tests/peerd/scratch_folder.hpp"

namespace peerd::roster_file_test {
namespace {

using keys::Identity;
using keys::Role;
using keys::Roster;
using testing::HasSubstr;

class RosterFiles : public testing::Test {
 protected:
  testing_support::ScratchFolder folder;
  const std::filesystem::path file = folder / "keys/town.roster";
  const Identity anna = Identity::random();
  const Roster one = Roster::first("town", "anna", anna);
  const Roster two = one.with({"bo", Role::kEditor, Identity::random().public_key()}, anna).value();
};

TEST_F(RosterFiles, KeepTheOnesBefore) {
  const auto none = read_roster(file);
  ASSERT_TRUE(none && !*none);
  ASSERT_TRUE(save_roster(file, one));
  ASSERT_TRUE(save_roster(file, two));
  ASSERT_TRUE(save_roster(file, two)) << "the same once more";
  EXPECT_EQ(must(must(read_roster(file))).text(), two.text());
  EXPECT_EQ(only(read_earlier_rosters(file)).text(), one.text());
}

TEST_F(RosterFiles, AreNotReplacedByOlderOnesOrThoseOfOthers) {
  ASSERT_TRUE(save_roster(file, two));
  for (const Roster& other : {one, Roster::first("town", "cy", Identity::random())}) {
    EXPECT_THAT(error_of(save_roster(file, other)).text,
                HasSubstr("is a later one, or of another world, or by other administrators"));
  }
  EXPECT_EQ((*read_roster(file))->text(), two.text());
}

TEST_F(RosterFiles, AreErrorsWhereTheyAreDamaged) {
  ASSERT_TRUE(save_roster(file, one));
  folder.write("keys/town.roster", one.text() + "x");
  EXPECT_EQ(error_of(read_roster(file)).exit_code, 1);
  EXPECT_FALSE(save_roster(file, two)) << "nor written over";
}

}  // namespace
}  // namespace peerd::roster_file_test
