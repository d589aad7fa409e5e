#include "peerd/lab/measure/sweep.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace peerd::measure::sweep_test {

TEST(Sweep, VaryingKeysInOrderWhateverTheirType) {
  const std::vector<Params> runs{{{"a.x", 1}, {"b.x", "u"}, {"c", 5}, {"e", 100}},
                                 {{"a.x", 2}, {"b.x", "u"}, {"c", 5}, {"d", true}, {"e", 100.0}}};
  EXPECT_THAT(varying_keys(runs), testing::ElementsAre("a.x", "d"));
  EXPECT_TRUE(varying_keys({}).empty());
}

TEST(Sweep, Words) {
  const Params run{{"network.latency_ms", 100.0},
                   {"replication.approach", "dr+rcp"},
                   {"replication.order", 2},
                   {"motion.speed_m_s", 2.5},
                   {"a.rate_hz", 60},
                   {"b.rate_hz", 30}};
  std::vector<std::string> keys;
  for (const auto& item : run.items()) keys.push_back(item.key());
  EXPECT_EQ(describe(run, keys), "latency 100 ms, dr+rcp, order 2, speed 2.5 m/s, a.rate 60 Hz, b.rate 30 Hz");
  EXPECT_EQ(axis_label("network.latency_ms", keys), "latency [ms]");
  EXPECT_EQ(short_name("a.rate_hz", keys), "a.rate_hz");
}

TEST(Sweep, AValueAsText) {
  const Params run{{"a", "dr+rcp"}, {"b", 100}, {"c", 0.25}, {"d", true}, {"e", {1, 2}}};
  const auto text = [&](const char* key) { return value_text(run, key); };
  EXPECT_EQ(text("a"), "dr+rcp") << "without quotes";
  EXPECT_EQ(text("b"), "100");
  EXPECT_EQ(text("c"), "0.25");
  EXPECT_EQ(text("d"), "true");
  EXPECT_EQ(text("e"), "[1,2]");
  EXPECT_EQ(text("f"), "") << "the run does not set it";
}

TEST(Sweep, ParametersComeBeforeTheNetworksSettings) {
  const Params all = with_network({{"network.loss", 0.5}}, {{"network.loss", 0.5}, {"network.jitter_ms", 3}});
  EXPECT_EQ(all.dump(), R"({"network.loss":0.5,"network.jitter_ms":3})");
  EXPECT_EQ(with_network(Params::object(), Params::object()).dump(), "{}");
}

}  // namespace peerd::measure::sweep_test
