#pragma once
#include <toml++/toml.h>
#include <nlohmann/json.hpp>

namespace peerd::config {

// The same value as JSON; a date or a time, which JSON has none of, as its text.
[[nodiscard]] nlohmann::ordered_json to_json(const toml::node& node);

}  // namespace peerd::config
