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

World sealed_world(const std::string& name, std::uint64_t session) {
  World sealed = world(name, session);
  sealed.peers.front().beacon.sealed = true;
  return sealed;
}

using Chosen = std::vector<const World*>;

TEST(ChooseWorld, TakesTheOneThatIsNamed) {
  const std::vector<World> worlds{world("eq47", 1), world("town", 2)};
  EXPECT_EQ(must(choose_world(worlds, "town", true)), Chosen{&worlds[1]});
  EXPECT_EQ(must(choose_world(worlds, "town", false)), Chosen{&worlds[1]}) << "to say that it is open";
}

TEST(ChooseWorld, TakesTheOnlyOneWithoutAName) {
  const std::vector<World> worlds{world("town", 2)};
  EXPECT_EQ(must(choose_world(worlds, "", true)), Chosen{&worlds[0]});
}

TEST(ChooseWorld, KnowsWhenThereIsNone) {
  EXPECT_EQ(must(choose_world({}, "", true)), Chosen{});
  EXPECT_EQ(must(choose_world({world("town", 2)}, "village", true)), Chosen{});
}

TEST(ChooseWorld, AsksWhichOfSeveral) {
  const auto nameless = error_of(choose_world({world("eq47", 1), world("town", 2)}, "", true));
  EXPECT_EQ(nameless.exit_code, kNoSuchWorld);
  EXPECT_THAT(nameless.text, HasSubstr("which of these worlds?"));
  EXPECT_THAT(nameless.text, HasSubstr("town"));
  EXPECT_FALSE(choose_world({world("town", 1), world("town", 2)}, "town", true)) << "two sessions have that name";
}

// Anybody can answer that he is of a world of that name. Who has the key finds out.
TEST(ChooseWorld, TriesAllThatAreSealed) {
  const std::vector<World> worlds{world("town", 1), sealed_world("town", 1), sealed_world("town", 2)};
  EXPECT_EQ(must(choose_world(worlds, "town", false)), (Chosen{&worlds[1], &worlds[2]}));
  EXPECT_EQ(must(choose_world(worlds, "town", true)), Chosen{&worlds[0]});
}

// So that --from can say which of several worlds of one name is meant.
TEST(LineOf, HasTheAddressAndThePortThatGiveTheWorld) {
  World town = world("town", 1);
  EXPECT_THAT(line_of(town), HasSubstr("ada (id 1) at 192.0.2.7:40123\n"));
  EXPECT_THAT(error_of(choose_world({town, town}, "town", true)).text, HasSubstr("at 192.0.2.7:40123\n"));
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
