#pragma once
#include <string>
#include <vector>

namespace peerd::config {

// The keys that differ between two configurations (TOML that this program has read before), by dotted name, ascending:
// those with another value, and those that only one of them has. A list is one value.
[[nodiscard]] std::vector<std::string> changed_keys(const std::string& before, const std::string& after);

}  // namespace peerd::config
