#pragma once
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/config/peer_settings.hpp"

namespace peerd::config {

// The table [expect.NAME]: what a report must say for the scenario to have gone as it should.
struct Expectation {
  std::string name;
  std::string place;  // FILE:LINE:COLUMN: and a blank, of its table; empty where that is unknown
  std::string that;   // a report::Measure
  std::optional<double> at_least, at_most;
  std::optional<nlohmann::ordered_json> equals;  // a number, or true or false
  std::string object, observer;                  // whose; empty: all. The object may be a pattern
  nlohmann::ordered_json where;   // values of swept keys, by dotted name, each as a list: only those runs
  std::string mode;               // "sim" or "real": only there; empty: everywhere
  double from_s = 0.0;            // of what is between these times alone
  std::optional<double> until_s;  // none: the end
  std::vector<std::size_t> runs;  // that it is about, by index; set by read_scenario
};

// The tables below `expect`, by name; times of theirs after `latest_s` are refused.
[[nodiscard]] std::vector<Expectation> read_expectations(TomlReader& root, const std::vector<PeerSettings>& peers,
                                                         double latest_s);

// Whether `root`, one run's whole configuration, has one of the values for each of the keys.
[[nodiscard]] bool picks(const Expectation& e, const toml::table& root);
// Those of its keys that `root` does not set.
[[nodiscard]] std::vector<std::string> keys_not_set(const Expectation& e, const toml::table& root);

}  // namespace peerd::config
