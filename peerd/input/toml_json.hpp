#pragma once
#include <toml++/toml.h>
#include <nlohmann/json_fwd.hpp>

namespace peerd {

// Converts a value to JSON. Dates and times, which JSON does not have, become their text.
[[nodiscard]] nlohmann::ordered_json to_json(const toml::node& node);

}  // namespace peerd
