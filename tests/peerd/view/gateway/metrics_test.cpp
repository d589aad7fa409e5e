#include "peerd/view/gateway/metrics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>

#include "peerd/net/os/traffic_counters.hpp"
#include "peerd/peer/control/answer.hpp"
#include "peerd/peer/node/counter_meanings.hpp"
#include "peerd/view/gateway/gateway_counters.hpp"
#include "tests/peerd/peer/node/lone_peer.hpp"

namespace peerd::gateway::metrics_test {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

constexpr const char* kWorld = R"(#VRML V2.0 utf8
DEF A Transform { children Shape { geometry Box { } } }
DEF DRIVEN Transform { children Shape { geometry Box { } } }
)";

struct Replies {
  Replies() : peer(kWorld, {"A", "DRIVEN"}) {
    peer.make();
    peer.run(1);
    status = json::parse(control::answer(*peer.node, peer.now, R"({"do":"status"})", Duration{0}, [] {
                           return control::More{GatewayCounters().named()};
                         }).line);
    peers = json::parse(control::answer(*peer.node, peer.now, R"({"do":"peers"})").line);
  }
  testing_support::LonePeer peer;
  json status, peers;
};

// Returns the row of `ctl peers` for a peer whose one-way delay has not been measured yet.
json row_of_b() {
  return {{"id", 2},
          {"name", "b \"c\" \\ d\ne"},
          {"joined", true},
          {"leads", false},
          {"heard_ms_ago", 250.0},
          {"round_trip_ms", 1.5},
          {"delay_ms", nullptr},
          {"clock_ahead_ms", -2.0},
          {"clock_error_ms", 1.0},
          {"datagrams_in", 7},
          {"bytes_in", 700},
          {"loss_in", 0.25},
          {"loss_out", nullptr},
          {"duplicates", 0},
          {"overtaken", 3},
          {"ghosts_differ", 1},
          {"ghosts_differ_explained", 2},
          {"drops", {{"stale", 4}}}};
}

// The format: each metric has one HELP, one TYPE and then its values, each value once.
void expect_well_formed(const std::string& text) {
  const std::regex value(R"re(([a-z_]+)(\{[a-z]+="([^"\\]|\\.)*"(,[a-z]+="([^"\\]|\\.)*")*\})? -?[0-9.e+-]+)re");
  std::istringstream lines(text);
  std::string line, metric;
  std::set<std::string> metrics, values;
  while (std::getline(lines, line)) {
    if (line.starts_with("# HELP ")) {
      metric = line.substr(7, line.find(' ', 7) - 7);
      EXPECT_TRUE(metrics.insert(metric).second) << line;
      EXPECT_GT(line.size(), 8 + metric.size()) << "nothing says what it is: " << line;
      ASSERT_TRUE(std::getline(lines, line));
      EXPECT_TRUE(line == "# TYPE " + metric + " counter" || line == "# TYPE " + metric + " gauge") << line;
      EXPECT_EQ(metric.ends_with("_total"), line.ends_with(" counter")) << line;
      continue;
    }
    std::smatch parts;
    ASSERT_TRUE(std::regex_match(line, parts, value)) << line;
    EXPECT_EQ(parts[1], metric) << line;
    EXPECT_TRUE(values.insert(line.substr(0, line.rfind(' '))).second) << line;
  }
}

TEST(Metrics, HaveAllCountersOfStatus) {
  const Replies replies;
  const std::string text = metrics_text(replies.status, replies.peers);
  expect_well_formed(text);
  for (const auto& [name, count] : replies.status["counters"].items()) {
    if (name.starts_with("updates_out_") || name.starts_with("dropped_") || name.starts_with("gateway.refused_"))
      continue;
    std::string metric = "peerd_" + name + "_total";
    std::ranges::replace(metric, '.', '_');
    EXPECT_THAT(text, HasSubstr('\n' + metric + ' ' + count.dump() + '\n'));
  }
  EXPECT_THAT(text, HasSubstr("peerd_gateway_refused_total{kind=\"origin\"} 0\n"));
  EXPECT_THAT(text, HasSubstr("peerd_updates_out_up_to_total{size=\"16_bytes\"} "));
  EXPECT_THAT(text, HasSubstr("peerd_peer_info{peer=\"1\",name=\"a\"} 1\n"));
  EXPECT_THAT(text, HasSubstr("peerd_joined 1\n"));
  EXPECT_THAT(text, HasSubstr("peerd_region_datagrams_out_total{region=\"0\"} "));
  EXPECT_THAT(text, Not(HasSubstr("null")));
}

TEST(Metrics, EveryCounterOfTheGatewayHasAMeaning) {
  for (const auto& [name, count] : GatewayCounters().named()) EXPECT_FALSE(meaning_of_counter(name).empty()) << name;
}

TEST(Metrics, PeersAreLabelsAndUnitsAreSeconds) {
  Replies replies;
  const json row = row_of_b();
  replies.peers["peers"] = json::array({row});
  const std::string text = metrics_text(replies.status, replies.peers);
  expect_well_formed(text);
  const std::string labels = R"({peer="2",name="b \"c\" \\ d\ne"})";
  EXPECT_THAT(text, HasSubstr("peerd_peer_silence_seconds" + labels + " 0.25\n"));
  EXPECT_THAT(text, HasSubstr("peerd_peer_round_trip_seconds" + labels + " 0.0015\n"));
  EXPECT_THAT(text, HasSubstr("peerd_peer_loss_in_ratio" + labels + " 0.25\n"));
  EXPECT_THAT(text, HasSubstr("peerd_peer_joined" + labels + " 1\n"));
  EXPECT_THAT(text, HasSubstr(R"(peerd_peer_drops_total{peer="2",name="b \"c\" \\ d\ne",reason="stale"} 4)"));
  EXPECT_THAT(text, Not(HasSubstr("peerd_peer_delay_seconds"))) << "it is not known yet";
}

// Each metric that the dashboard asks for is there: a counter as the program names it, a row's column or the session's.
TEST(Metrics, TheDashboardAsksForWhatThereIs) {
  Replies replies;
  json row = row_of_b();
  row["delay_ms"] = row["loss_out"] = 0.5;
  replies.peers["peers"] = json::array({row});
  replies.peers["clock"]["os_clock_error_ms"] = 1.0;
  for (const auto& [name, count] : net::TrafficCounters().named()) replies.status["counters"][name] = count;
  replies.status["counters"]["dropped_stale"] = 1;
  const std::string text = metrics_text(replies.status, replies.peers);
  std::ifstream file(PEERD_SOURCE_DIR "/peerd/packaging/grafana/peerd.json");
  const json dashboard = json::parse(file);
  std::size_t asked = 0;
  const std::regex metric("peerd_[a-z_]+");
  for (const json& panel : dashboard["panels"]) {
    for (const json& target : panel.value("targets", json::array())) {
      const std::string expression = target["expr"];
      std::smatch name;
      ASSERT_TRUE(std::regex_search(expression, name, metric)) << expression;
      EXPECT_THAT(text, HasSubstr("# TYPE " + name.str() + ' ')) << panel["title"];
      ++asked;
    }
  }
  EXPECT_GT(asked, 30U);
}

}  // namespace peerd::gateway::metrics_test
