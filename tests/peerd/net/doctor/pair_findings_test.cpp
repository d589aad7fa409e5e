// Tables of made-up outcomes.
#include "peerd/net/doctor/pair_findings.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace peerd::doctor::pair_findings_test {

using testing::HasSubstr;

constexpr Heard kAll{true, kStream, 1472}, kAllMulticast{true, kStream, 1232}, kNothing{};

PairOutcome good_outcome() {
  PairOutcome o;
  o.result.answered = o.result.is_heard = o.result.complete = true;
  o.result.unicast_in = o.result.unicast_out = kAll;
  o.result.multicast_in = o.result.multicast_out = kAllMulticast;
  o.result.tcp_in = o.result.tcp_out = TcpState::kWorks;
  o.result.round_trip = std::chrono::milliseconds(2);
  o.host = "there";
  o.host_address = "192.0.2.2:47474";
  o.own_address = "192.0.2.1:47474";
  o.group = "239.192.80.0 port 47474";
  o.interface = "eth0";
  return o;
}

struct Case {
  const char* name;
  std::function<void(PairOutcome&)> change;
  int exit_code;
  std::vector<std::string> says;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class PairFindings : public testing::TestWithParam<Case> {};
TEST_P(PairFindings, SayWhatWorksAndWhatToDo) {
  PairOutcome outcome = good_outcome();
  GetParam().change(outcome);
  const auto findings = pair_findings(outcome);
  EXPECT_EQ(exit_code_of(findings), GetParam().exit_code) << as_text(findings);
  for (const std::string& words : GetParam().says) EXPECT_THAT(as_text(findings), HasSubstr(words));
}
INSTANTIATE_TEST_SUITE_P(
    Table, PairFindings,
    testing::Values(
        Case{"AllWorks",
             [](PairOutcome&) {},
             0,
             {"from here to there: 200 of 200", "from there to here: 200 of 200", "1472 bytes arrive whole by unicast",
              "2 ms at least"}},
        Case{"NobodyAnswers",
             [](PairOutcome& o) { o.result = {}, o.waited = std::chrono::seconds(60); },
             3,
             {"problem: there (192.0.2.2:47474) did not answer within 60 s",
              "peerd doctor --with 192.0.2.1:47474 there", "a firewall here drops UDP 47474"}},
        Case{"UnicastAlone",
             [](PairOutcome& o) { o.result.multicast_in = o.result.multicast_out = kNothing; },
             1,
             {"warning: from here to there: nothing of 239.192.80.0 port 47474 arrived over eth0",
              "here --set transport.multicast=never --set 'transport.peers=[\"192.0.2.2:47474\"]'",
              "there --set transport.multicast=never --set 'transport.peers=[\"192.0.2.1:47474\"]'"}},
        Case{"MulticastOneWay",
             [](PairOutcome& o) { o.result.multicast_in = kNothing; },
             1,
             {"warning: from there to here: nothing of 239.192.80.0", "from here to there: 200 of 200"}},
        Case{"NoMulticastHere",
             [](PairOutcome& o) {
               o.result.multicast_in = o.result.multicast_out = kNothing;
               o.group = "";
               o.why_no_multicast = "no flag";
             },
             1,
             {"warning: not tried: no flag; use unicast"}},
        Case{"MulticastIsNotWanted",
             [](PairOutcome& o) {
               o.result.multicast_in = o.result.multicast_out = kNothing;
               o.multicast_wanted = false;
             },
             0,
             {"unicast         from here to there: 200 of 200"}},
        Case{"MulticastAlone",
             [](PairOutcome& o) { o.result.unicast_in = o.result.unicast_out = kNothing; },
             0,
             {"hint: from here to there: nothing arrived", "1232 bytes arrive whole by multicast"}},
        Case{"ItHearsNothing",
             [](PairOutcome& o) {
               o.result.is_heard = o.result.complete = false;
               o.result.unicast_in = {true, 0, 64};
               o.result.unicast_out = o.result.multicast_out = kNothing;
             },
             3,
             {"problem: there: it is heard here, and hears nothing of this computer",
              "unicast         from there to here: datagrams arrive; how many are lost was not tried"}},
        Case{"OppositePaths",
             [](PairOutcome& o) { o.result.unicast_out = o.result.multicast_in = kNothing; },
             3,
             {"problem: there: no way works in both directions"}},
        Case{"Loss",
             [](PairOutcome& o) { o.result.multicast_out.stream = 150; },
             1,
             {"warning: from here to there: 150 of 200 datagrams arrived: 25 % are lost"}},
        Case{
            "LossOfWhatIsNotNeeded", [](PairOutcome& o) { o.result.unicast_out.stream = 150; }, 0, {"hint: from here"}},
        Case{"ShortDatagrams",
             [](PairOutcome& o) { o.result.unicast_out.largest_bytes = 1000; },
             1,
             {"warning: of lengths up to 1472 bytes that were tried, 1000 is the longest", "raise the MTU"}},
        Case{"NoTcp",
             [](PairOutcome& o) { o.result.tcp_in = TcpState::kNoAnswer, o.result.tcp_out = TcpState::kRefused; },
             1,
             {"from here to there: refused; nobody", "set transport.snapshot_port there",
              "from there to here: no answer; nobody", "set transport.snapshot_port here"}},
        Case{"TcpPortIsTaken",
             [](PairOutcome& o) { o.result.tcp_in = TcpState::kUntried, o.tcp_problem = "Address already in use"; },
             0,
             {"hint: from there to here: not tried (Address already in use)"}},
        Case{"ItsInterfaceNeedsAName",
             [](PairOutcome& o) { o.interface_guessed = true; },
             1,
             {"a peer would use lo, and not eth0", "name it: --interface eth0"}},
        Case{"ClocksApart",
             [](PairOutcome& o) { o.result.clock_ahead = -std::chrono::seconds(5); },
             0,
             {"hint: that of there is 5000 ms behind this one, to within 1 ms"}}),
    [](const auto& c) { return std::string(c.param.name); });

TEST(PairFindingsJson, HasAllNumbers) {
  const auto j = as_json(good_outcome());
  EXPECT_EQ(j["multicast"]["to"].dump(), R"({"arrived":200,"of":200,"largest_bytes":1232})");
  EXPECT_EQ(j["tcp"]["from"], "works");
  EXPECT_EQ(j["round_trip_ms"], 2.0);
  PairOutcome nobody;
  EXPECT_TRUE(as_json(nobody)["round_trip_ms"].is_null());
}

}  // namespace peerd::doctor::pair_findings_test
