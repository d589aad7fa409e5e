#pragma once
#include <span>
#include <string>
#include <vector>

#include "peerd/input/toml_input.hpp"
#include "peerd/peer/config/run_settings.hpp"

namespace peerd::config {

// The sources of a scenario's settings, each laid over those before it. Their values know their lines, which copies of
// toml++'s tables do not.
struct GivenSettings {
  toml::table file;
  // Whether the file's text is of other peers or of a recording: nobody here can mend it, so it gets no warnings.
  bool file_is_provided = false;
  std::span<const toml::table> overlays;
  toml::table set;  // by --set
  // Whether the runs are all of the sweep, or one of them: a key may have its effect in another one.
  bool whole_sweep = true;
};

// The keys that another key switches off in all runs, as one warning each. Where a later source than that of the key
// holds the other key, there is none: who lays `replication.approach = "dr"` over a scenario means to switch off.
[[nodiscard]] std::vector<std::string> keys_without_effect(const GivenSettings& given,
                                                           std::span<const RunSettings> runs);

}  // namespace peerd::config
