#include "peerd/daemon/join/worlds_here.hpp"

#include <gmock/gmock.h>

#include "replication/wire/codec.hpp"
#include "tests/must.hpp"

namespace peerd::worlds_here_test {

using testing::HasSubstr;

World world(const std::string& name, std::uint64_t session) {
  discovery::Found found{};
  found.beacon.world = name;
  found.beacon.name = "ada";
  found.beacon.session = session;
  found.beacon.protocol = replication::kProtocolVersion;
  found.beacon.snapshot_port = 40'123;
  found.address = boost::asio::ip::make_address("192.0.2.7");
  return {name, session, {found}};
}

TEST(ChooseWorld, TakesTheOneThatIsNamed) {
  const std::vector<World> worlds{world("eq47", 1), world("town", 2)};
  EXPECT_EQ(must(choose_world(worlds, "town")), &worlds[1]);
}

TEST(ChooseWorld, TakesTheOnlyOneWithoutAName) {
  const std::vector<World> worlds{world("town", 2)};
  ASSERT_TRUE(choose_world(worlds, ""));
  EXPECT_EQ(*choose_world(worlds, ""), &worlds[0]);
}

TEST(ChooseWorld, KnowsWhenThereIsNone) {
  ASSERT_TRUE(choose_world({}, ""));
  EXPECT_EQ(*choose_world({}, ""), nullptr);
  EXPECT_EQ(*choose_world({world("town", 2)}, "village"), nullptr);
}

TEST(ChooseWorld, AsksWhichOfSeveral) {
  const auto nameless = error_of(choose_world({world("eq47", 1), world("town", 2)}, ""));
  EXPECT_EQ(nameless.exit_code, kNoSuchWorld);
  EXPECT_THAT(nameless.text, HasSubstr("which of these worlds?"));
  EXPECT_THAT(nameless.text, HasSubstr("town"));
  EXPECT_FALSE(choose_world({world("town", 1), world("town", 2)}, "town")) << "two sessions have that name";
}

// So that --from can say which of several worlds of one name is meant.
TEST(LineOf, HasTheAddressAndThePortThatGiveTheWorld) {
  World town = world("town", 1);
  EXPECT_THAT(line_of(town), HasSubstr("ada (id 1) at 192.0.2.7:40123\n"));
  EXPECT_THAT(error_of(choose_world({town, town}, "town")).text, HasSubstr("at 192.0.2.7:40123\n"));
  town.peers.front().address = boost::asio::ip::make_address("2001:db8::7");
  EXPECT_THAT(line_of(town), HasSubstr("at [2001:db8::7]:40123\n"));
  town.peers.front().beacon.snapshot_port = 0;
  EXPECT_THAT(line_of(town), HasSubstr("at 2001:db8::7, which gives its world to nobody\n"));
}

TEST(LineOf, NamesAnotherProtocolAndAnOpenSession) {
  World old = world("town", 0xabc);
  EXPECT_THAT(line_of(old), HasSubstr("town  (session 0000000000000abc, open): ada (id 1) at "));
  old.peers.front().beacon.protocol = 1;
  old.peers.front().beacon.sealed = true;
  EXPECT_THAT(line_of(old), HasSubstr("it speaks version 1 of the protocol"));
  EXPECT_THAT(line_of(old), testing::Not(HasSubstr("open")));
}

}  // namespace peerd::worlds_here_test
