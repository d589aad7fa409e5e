#include "peerd/net/os/interfaces.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/must.hpp"

namespace peerd::net::interfaces_test {

using testing::HasSubstr;

Interface lo() {
  return {.name = "lo", .index = 1, .up = true, .running = true, .loopback = true, .has_ipv4 = true, .has_ipv6 = true};
}

Interface card(const char* name, unsigned index) {
  return {
      .name = name, .index = index, .up = true, .running = true, .multicast = true, .has_ipv4 = true, .has_ipv6 = true};
}

Interface changed(Interface interface, auto change) {
  change(interface);
  return interface;
}

struct Good {
  const char* name;
  std::string wanted;
  IpFamily family;
  std::string chosen;
  std::vector<Interface> here;
};
class Choice : public testing::TestWithParam<Good> {};
TEST_P(Choice, Is) {
  const Good& c = GetParam();
  const auto chosen = must(choose_interface(c.here, c.wanted, c.family));
  EXPECT_EQ(chosen.interface.name, c.chosen);
  EXPECT_THAT(chosen.why, HasSubstr(c.chosen));
}
INSTANTIATE_TEST_SUITE_P(
    Table, Choice,
    testing::Values(Good{"ByName", "eth1", IpFamily::kV4, "eth1", {lo(), card("eth0", 2), card("eth1", 3)}},
                    Good{"LoByName", "lo", IpFamily::kV4, "lo", {lo(), card("eth0", 2)}},
                    Good{"ByNameThoughUnplugged",
                         "eth0",
                         IpFamily::kV4,
                         "eth0",
                         {lo(), changed(card("eth0", 2), [](Interface& i) { i.running = false; })}},
                    Good{"TheOnlyOne", "", IpFamily::kV4, "eth0", {lo(), card("eth0", 2)}},
                    Good{"TheOnlyOneV6", "", IpFamily::kV6, "eth0", {lo(), card("eth0", 2)}},
                    Good{"TheOnlyOneThatRuns",
                         "",
                         IpFamily::kV4,
                         "eth0",
                         {lo(), card("eth0", 2), changed(card("docker0", 3), [](Interface& i) { i.running = false; })}},
                    Good{"TheOnlyOneWithAnAddress",
                         "",
                         IpFamily::kV4,
                         "eth1",
                         {lo(), changed(card("eth0", 2), [](Interface& i) { i.has_ipv4 = false; }), card("eth1", 3)}},
                    Good{"SeveralMeansLo", "", IpFamily::kV4, "lo", {lo(), card("eth0", 2), card("eth1", 3)}},
                    Good{"NoneMeansLo", "", IpFamily::kV4, "lo", {lo()}}),
    [](const auto& c) { return std::string(c.param.name); });

struct Bad {
  const char* name;
  std::string wanted;
  IpFamily family;
  NetError::Kind kind;
  std::string sentence;
  std::vector<Interface> here;
};
class Refusal : public testing::TestWithParam<Bad> {};
TEST_P(Refusal, SaysWhatToDo) {
  const Bad& c = GetParam();
  EXPECT_THAT(error_of(choose_interface(c.here, c.wanted, c.family)), IsError(c.kind, c.sentence));
}
INSTANTIATE_TEST_SUITE_P(
    Table, Refusal,
    testing::Values(
        Bad{"NoSuchName",
            "eth9",
            IpFamily::kV4,
            NetError::Kind::kNoSuchInterface,
            "no interface named \"eth9\" here; the ones that can multicast over IPv4 are: lo, eth0",
            {lo(), card("eth0", 2)}},
        Bad{"NothingHere",
            "eth9",
            IpFamily::kV6,
            NetError::Kind::kNoSuchInterface,
            "no interface named \"eth9\" here; none here can multicast over IPv6",
            {}},
        Bad{"Down",
            "eth0",
            IpFamily::kV4,
            NetError::Kind::kNoMulticast,
            "interface \"eth0\" is down: bring it up (ip link set eth0 up) or name another; the ones that can "
            "multicast over IPv4 are: lo",
            {lo(), changed(card("eth0", 2), [](Interface& i) { i.up = false; })}},
        Bad{"PointToPoint",
            "tun0",
            IpFamily::kV4,
            NetError::Kind::kNoMulticast,
            "interface \"tun0\" does not do multicast: name another; the ones that can multicast over IPv4 are: lo",
            {lo(), changed(card("tun0", 2), [](Interface& i) { i.multicast = false; })}},
        Bad{"NoAddress",
            "eth0",
            IpFamily::kV6,
            NetError::Kind::kNoMulticast,
            "interface \"eth0\" has no IPv6 address: give it one or name another; the ones that can multicast over "
            "IPv6 are: eth1",
            {lo(), changed(card("eth0", 2), [](Interface& i) { i.has_ipv6 = false; }), card("eth1", 3)}},
        Bad{"NoneV6",
            "",
            IpFamily::kV6,
            NetError::Kind::kNoMulticast,
            "no interface here can multicast over IPv6; bring one up with an address, or use an IPv4 group such as "
            "239.192.0.0, which works over lo too",
            {lo()}},
        Bad{"SeveralV6",
            "",
            IpFamily::kV6,
            NetError::Kind::kNoMulticast,
            "several interfaces can multicast (eth0, eth1); name the one to use",
            {lo(), card("eth0", 2), card("eth1", 3)}}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(ListInterfaces, FindsLo) {
  const auto here = must(list_interfaces());
  const auto found = std::ranges::find(here, "lo", &Interface::name);
  ASSERT_NE(found, here.end());
  EXPECT_TRUE(found->loopback);
  EXPECT_EQ(found->index, 1u);
  EXPECT_TRUE(std::ranges::is_sorted(here, {}, &Interface::index));
}

Interface by_ipv6(const char* name, unsigned index, bool wide) {
  return changed(card(name, index), [&](Interface& i) {
    i.has_ipv4 = false;
    i.has_wide_ipv6 = wide;
  });
}

TEST(Ipv6, IsTakenWhereThereIsNothingElse) {
  EXPECT_TRUE(has_ipv6_alone({lo(), by_ipv6("eth0", 2, true)}, ""));
  EXPECT_TRUE(has_ipv6_alone({lo(), by_ipv6("eth0", 2, true), card("eth1", 3)}, "eth0"));
  EXPECT_FALSE(has_ipv6_alone({lo(), by_ipv6("eth0", 2, true), card("eth1", 3)}, ""));
  EXPECT_FALSE(has_ipv6_alone({lo(), by_ipv6("eth0", 2, false)}, "")) << "it may get an IPv4 address any moment";
  EXPECT_FALSE(has_ipv6_alone({lo()}, ""));
  EXPECT_FALSE(has_ipv6_alone({lo(), by_ipv6("eth0", 2, true)}, "lo"));
}

TEST(Ipv6, IsNamedWhereIpv4WasWantedAndIsNotThere) {
  const std::vector<Interface> here{lo(), by_ipv6("eth0", 2, false)};
  EXPECT_THAT(error_of(choose_interface(here, "eth0", IpFamily::kV4)),
              IsError(NetError::Kind::kNoMulticast, HasSubstr("say --ipv6, or an IPv6 group (--group ff15::50:0)")));
  EXPECT_THAT(must(choose_interface(here, "", IpFamily::kV4)).why, HasSubstr("eth0 can over IPv6: say --ipv6"));
}

}  // namespace peerd::net::interfaces_test
