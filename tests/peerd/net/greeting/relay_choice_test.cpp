#include "peerd/net/greeting/relay_choice.hpp"

#include <gtest/gtest.h>

namespace peerd::net::relay_choice_test {

using asio::ip::udp;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::uint32_t kSelf = 50;
udp::endpoint address(int n) { return {asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(1000 + n)}; }

struct RelayChoiceTest : testing::Test {
  RelayChoice choice{{.relays = {address(0), address(1), address(2)}, .self = kSelf}};
  HostTime now{seconds(100)};
  std::int64_t note = 0;

  // That relay greets; its path leads from it over those to the root.
  void greets(int n, std::vector<std::uint32_t> path, bool detached = false) {
    Greeting greeting{.instance = path.front(), .number = 7, .echo = 9};
    greeting.link = LinkNote{.sent_at_ns = ++note, .path = std::move(path), .detached = detached};
    RelayChoice::Relay* const relay = choice.find(address(n));
    ASSERT_NE(relay, nullptr);
    choice.on_greeting(now, *relay, greeting);
  }
  [[nodiscard]] int chosen() const {
    return choice.chosen() == nullptr ? -1 : static_cast<int>(choice.chosen() - choice.relays().data());
  }
};

TEST_F(RelayChoiceTest, TakesTheFirstThatAnswersAndAnotherOneWhenItIsSilent) {
  EXPECT_FALSE(choice.update(now));
  EXPECT_EQ(chosen(), -1);
  greets(1, {11});
  EXPECT_TRUE(choice.update(now));
  EXPECT_EQ(chosen(), 1);
  now += milliseconds(1'100);
  greets(2, {12});
  EXPECT_FALSE(choice.update(now));
  now += milliseconds(200);
  EXPECT_TRUE(choice.update(now));
  EXPECT_EQ(chosen(), 2);
}

TEST_F(RelayChoiceTest, GoesBackToABetterOneOnceItIsSteady) {
  greets(1, {11});
  (void)choice.update(now);
  for (int i = 0; i < 10; ++i) {
    greets(0, {10}), greets(1, {11});
    (void)choice.update(now);
    EXPECT_EQ(chosen(), now - HostTime{seconds(100)} >= seconds(3) ? 0 : 1) << i;
    now += milliseconds(400);
  }
  EXPECT_EQ(chosen(), 0);
}

TEST_F(RelayChoiceTest, ARelayThatIsCutOffItselfIsTheLastResort) {
  greets(0, {10}, /*detached=*/true);
  (void)choice.update(now);
  EXPECT_EQ(chosen(), 0);
  for (int i = 0; i < 10; ++i) {
    greets(0, {10}, true), greets(2, {12, 13});
    (void)choice.update(now);
    now += milliseconds(400);
  }
  EXPECT_EQ(chosen(), 2);
}

TEST_F(RelayChoiceTest, OneThatLosesMuchIsLeftForAnother) {
  std::uint32_t sent = 0;
  for (int i = 0; i < 12; ++i) {
    Greeting greeting{.instance = 10, .number = 7, .echo = 9};
    greeting.link = LinkNote{.sent_at_ns = ++note, .datagrams_out = sent += 50, .path = {10}};
    RelayChoice::Relay& lossy = *choice.find(address(0));
    for (int came = 0; came < 30; ++came) lossy.meter.count_in();
    choice.on_greeting(now, lossy, greeting);
    greets(1, {11});
    (void)choice.update(now);
    EXPECT_EQ(chosen(), i < 8 ? 0 : 1) << i;  // after 200 datagrams, and three seconds of the other one
    now += milliseconds(400);
  }
}

TEST_F(RelayChoiceTest, NeverChoosesOneWhosePathLeadsBack) {
  greets(0, {10, 20, kSelf, 30});
  (void)choice.update(now);
  EXPECT_EQ(chosen(), -1);
  greets(1, {11, 30});
  (void)choice.update(now);
  EXPECT_EQ(chosen(), 1);
}

// Exactly one of relays that have chosen each other at the same time lets go.
TEST_F(RelayChoiceTest, OfACircleTheLowestLetsGo) {
  greets(0, {10});
  (void)choice.update(now);
  greets(0, {10, kSelf, 10});  // it is below this one, and has the lower number: it lets go
  EXPECT_FALSE(choice.update(now));
  EXPECT_EQ(chosen(), 0);
  greets(1, {90, 12});
  for (int i = 0; i < 10; ++i) {
    now += milliseconds(400);
    greets(1, {90, 12});
    (void)choice.update(now);
  }
  EXPECT_EQ(chosen(), 1);
  greets(1, {90, kSelf, 90});
  EXPECT_TRUE(choice.update(now));
  EXPECT_EQ(chosen(), -1);
}

TEST_F(RelayChoiceTest, OneThatLeavesIsNotWaitedFor) {
  greets(0, {10}), greets(1, {11});
  (void)choice.update(now);
  choice.on_greeting(now, *choice.find(address(0)), {.instance = 10, .number = 7, .leaving = true});
  EXPECT_TRUE(choice.update(now));
  EXPECT_EQ(chosen(), 1);
}

TEST_F(RelayChoiceTest, AProcessThatStartsAnewBeginsItsNotesAnew) {
  note = 1'000'000;
  greets(0, {10});
  note = 0;
  greets(0, {77, 5});
  EXPECT_EQ(choice.find(address(0))->path, (std::vector<std::uint32_t>{77, 5}));
}

TEST_F(RelayChoiceTest, ARecordedGreetingAndABareOneAreNoSignOfLife) {
  greets(1, {11});
  (void)choice.update(now);
  RelayChoice::Relay& first = *choice.find(address(0));
  choice.on_greeting(now, first, {.instance = 10, .number = 7});  // bare: it may take nobody any more
  for (int i = 0; i < 10; ++i) {
    choice.on_greeting(now, first, {.instance = 10, .number = 7});
    greets(1, {11});
    (void)choice.update(now);
    now += milliseconds(400);
  }
  EXPECT_EQ(chosen(), 1);
  Greeting recorded{.instance = 11, .number = 7};
  recorded.link = LinkNote{.sent_at_ns = note, .path = {11}};
  for (int i = 0; i < 5; ++i) {
    choice.on_greeting(now, *choice.find(address(1)), recorded);
    now += milliseconds(400);
  }
  (void)choice.update(now);
  EXPECT_EQ(chosen(), -1);
}

TEST_F(RelayChoiceTest, DatagramsAloneKeepARelayForAWhile) {
  greets(0, {10});
  (void)choice.update(now);
  for (int i = 0; i < 15; ++i) {
    now += milliseconds(400);
    if (choice.chosen() != nullptr) choice.on_datagram(now);
    (void)choice.update(now);
    EXPECT_EQ(chosen(), i < 10 ? 0 : -1) << i;  // 3 s, and then silence
  }
}

}  // namespace peerd::net::relay_choice_test
