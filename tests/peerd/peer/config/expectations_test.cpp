#include "peerd/peer/config/expectations.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/peerd/peer/config/scenario_text.hpp"

namespace peerd::config::expectations_test {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kSwept = R"(world = "some.wrl"
duration_s = 20
replication.approach = "dr"
[peer.a]
id = 1
[peer.b]
id = 2
)";
constexpr const char* kSweep = R"([sweep]
"network.latency_ms" = [5, 100]
"replication.order" = [1, 2]
)";

class ExpectationsTest : public testing_support::ScenarioText {
 protected:
  ExpectationsTest() : ScenarioText(kSwept) {}
  std::vector<Expectation> expectations_of(const std::string& text, std::vector<std::string> sets = {}) {
    return read(text, std::move(sets)).expectations;
  }
};

TEST_F(ExpectationsTest, SayWhatMustHoldAndWhere) {
  const auto all = expectations_of(std::string(R"([expect.same-worlds]
that = "state_roots_equal"
equals = true
[expect.close]
that = "ghost_error_m.p99"
at_most = 0.5
at_least = 0
object = "CAR*"
observer = "b"
from_s = 8
until_s = 12.5
mode = "sim"
where = { "network.latency_ms" = [5, 7], "replication.order" = 2.0, "replication.approach" = "dr" }
)") + kSweep);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].name, "close");
  EXPECT_EQ(all[0].at_most, 0.5);
  EXPECT_EQ(all[0].until_s, 12.5);
  EXPECT_EQ(all[0].mode, "sim");
  EXPECT_THAT(all[0].runs, ElementsAre(1)) << "2.0 is 2; of a list one value will do; what is not swept counts too";
  EXPECT_THAT(all[1].runs, ElementsAre(0, 1, 2, 3));
}

TEST_F(ExpectationsTest, ARepeatedRunIsMeantWithEachSeed) {
  const Scenario scenario =
      read(std::string("[expect.x]\nthat = \"updates_sent\"\nat_most = 3\nwhere.\"replication.order\" = 2\n") + kSweep,
           {"repeat=3"});
  ASSERT_EQ(scenario.runs.size(), 12u);
  EXPECT_THAT(scenario.expectations[0].runs, ElementsAre(3, 4, 5, 9, 10, 11));
}

TEST_F(ExpectationsTest, ArePartOfTheFileAndSoAreSettings) {
  const std::string one = "[expect.x]\nthat = \"updates_sent\"\nat_most = 3\n";
  EXPECT_EQ(expectations_of(one, {"expect.x.at_most=5"})[0].at_most, 5);
  EXPECT_THAT(expectations_of(one, {"expect={}"}), IsEmpty());
}

// The simulated network's keys mean nothing where the network is real.
TEST_F(ExpectationsTest, ARealNetworkIsNotWhatTheyGoBy) {
  const std::string one = "[expect.x]\nthat = \"updates_sent\"\nat_most = 3\nwhere.\"network.latency_ms\" = 5\n";
  EXPECT_THAT(expectations_of(one + kSweep)[0].runs, ElementsAre(0, 1));
  request.real = true;
  EXPECT_THAT(expectations_of(one + kSweep)[0].runs, IsEmpty());
}

TEST_F(ExpectationsTest, SettingsMayLeaveThemWithoutRunsButTheFileMayNot) {
  const std::string one = "[expect.x]\nthat = \"updates_sent\"\nat_most = 3\nwhere.\"replication.order\" = 2\n";
  EXPECT_THAT(expectations_of(one + kSweep, {"replication.order=1"})[0].runs, IsEmpty());
  EXPECT_THAT(error("[expect.x]\nthat = \"updates_sent\"\nat_most = 3\nwhere.\"replication.order\" = 3\n" +
                    std::string(kSweep)),
              HasSubstr(":8:1: error: expect.x.where: no run has these values"));
  EXPECT_THAT(
      error("[expect.x]\nthat = \"updates_sent\"\nat_most = 3\nwhere.\"replication.ordr\" = 2\n" + std::string(kSweep)),
      HasSubstr("the scenario does not set replication.ordr"));
}

TEST_F(ExpectationsTest, OfWhatAShortenedRunDoesNotReachAreNotChecked) {
  const std::string late = "[expect.x]\nthat = \"updates_sent\"\nat_most = 3\nfrom_s = 8\n";
  EXPECT_THAT(expectations_of(late, {"duration_s=9"})[0].runs, ElementsAre(0));
  EXPECT_THAT(expectations_of(late, {"duration_s=7"})[0].runs, IsEmpty());
  EXPECT_THAT(expectations_of(late + "until_s = 12\n", {"duration_s=9"})[0].runs, IsEmpty());
}

struct Bad {
  const char* name;
  const char* expectation;  // line 9 is its first key
  const char *where, *sentence;
};
class ExpectationRefusal : public ExpectationsTest, public testing::WithParamInterface<Bad> {};
TEST_P(ExpectationRefusal, SaysWhereAndWhat) {
  expect_refused(std::string("[expect.e]\n") + GetParam().expectation, GetParam().where, GetParam().sentence);
}
INSTANTIATE_TEST_SUITE_P(
    Table, ExpectationRefusal,
    testing::Values(
        Bad{"OfNothing", "at_most = 1", "8:", "expect.e.that is missing"},
        Bad{"NoSuchMeasure", "that = \"ghost_error_m.man\"\nat_most = 1",
            "9:8: ", "did you mean \"ghost_error_m.mean\"?"},
        Bad{"NoLimit", "that = \"updates_sent\"", "8:", "give a limit: at_most, at_least or equals"},
        Bad{"TwoLimits", "that = \"updates_sent\"\nequals = 3\nat_most = 3", "10:10: ", "leaves nothing to"},
        Bad{"NothingBetween", "that = \"updates_sent\"\nat_least = 3\nat_most = 2", "10:12: ", "nothing can hold"},
        Bad{"YesIsNoNumber", "that = \"state_roots_equal\"\nequals = 1", "10:10: ", "must be true or false"},
        Bad{"NumberIsNoYes", "that = \"updates_sent\"\nequals = true", "10:10: ", "must be a number"},
        Bad{"AtMostYes", "that = \"state_roots_equal\"\nequals = true\nat_most = 1",
            "11:1: ", "unknown key expect.e.at_most"},
        Bad{"MisspeltLimit", "that = \"updates_sent\"\nequals = 1\nat_mots = 1",
            "11:1: ", "did you mean expect.e.at_most?"},
        Bad{"ObjectOfARun", "that = \"traffic.bytes\"\nequals = 1\nobject = \"CAR\"", "11:10: ", "is the whole run's"},
        Bad{"NoSuchObserver", "that = \"updates_sent\"\nequals = 1\nobserver = \"bb\"",
            "11:12: ", "did you mean \"b\"?"},
        Bad{"PartOfACounter", "that = \"counters.ticks\"\nequals = 1\nfrom_s = 2", "11:10: ", "of the whole run only"},
        Bad{"AfterTheEnd", "that = \"updates_sent\"\nequals = 1\nfrom_s = 21", "11:10: ", "out of range: 0 to 20"},
        Bad{"EmptyPart", "that = \"updates_sent\"\nequals = 1\nfrom_s = 3\nuntil_s = 3",
            "12:11: ", "must be after from_s"},
        Bad{"NoMode", "that = \"updates_sent\"\nequals = 1\nmode = \"live\"", "11:8: ", "must be one of"}),
    [](const auto& c) { return std::string(c.param.name); });

}  // namespace peerd::config::expectations_test
