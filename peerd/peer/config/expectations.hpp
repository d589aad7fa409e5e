#pragma once
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/peer/config/peer_settings.hpp"

namespace peerd::config {

// The table [expect.NAME]: a limit that a measure of the report must keep for the scenario to count as passed.
struct Expectation {
  std::string name;
  std::string place;  // FILE:LINE:COLUMN: and a blank, of the table; empty: unknown
  std::string that;   // name of a config::Measure
  std::optional<double> at_least, at_most;
  std::optional<nlohmann::ordered_json> equals;  // number, true or false
  std::string object, observer;                  // views that are checked; empty: all; the object may be a pattern
  nlohmann::ordered_json where;                  // selects runs: lists of values by dotted key
  std::string mode;                              // "sim" or "real": only there; empty: everywhere
  double from_s = 0.0;                           // begin of the part of the run that is checked
  std::optional<double> until_s;                 // end of that part; none: the run's end
  std::vector<std::size_t> runs;                 // indices of the runs that are checked; read_scenario sets them
};

// Reads the tables below `expect`, by name. Times after `latest_s` are refused.
[[nodiscard]] std::vector<Expectation> read_expectations(TomlReader& root, const std::vector<PeerSettings>& peers,
                                                         double latest_s);

// Whether `root`, the whole configuration of one run, has one of the listed values for each key of `where`.
[[nodiscard]] bool picks(const Expectation& e, const toml::table& root);
// The keys of `where` that `root` does not set.
[[nodiscard]] std::vector<std::string> keys_not_set(const Expectation& e, const toml::table& root);

}  // namespace peerd::config
