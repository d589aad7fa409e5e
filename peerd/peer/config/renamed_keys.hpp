#pragma once
#include <string>
#include <vector>

#include "peerd/input/toml_input.hpp"

namespace peerd::config {

// Some keys of the configuration had another name in earlier versions. Files and captures that were written then stay
// valid: whoever parses a configuration calls these functions first, so that everything behind them, `params` of a
// report included, knows the new names alone.

// A table [world] of `file` and `lenient` is another way to write the keys `world` and `lenient`, at any time.

// Gives each key of `root` its new name, the names in [sweep] and in `where` of expectations included, and adds a
// sentence for each to `warnings`. The error is that a table has both names of one key.
[[nodiscard]] Result<void> rename_old_keys(toml::table& root, std::vector<std::string>& warnings);
// Does the same for the key of an assignment of --set, and for the keys inside of its value.
[[nodiscard]] Result<void> rename_old_keys(Assignment& set, std::vector<std::string>& warnings);

}  // namespace peerd::config
