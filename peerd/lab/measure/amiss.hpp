#pragma once
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace peerd::measure {

// Returns what is amiss in what objects do to each other in these runs of a summary: a sentence for each kind, about
// the first run that it is in.
[[nodiscard]] std::vector<std::string> amiss(const nlohmann::ordered_json& runs);

}  // namespace peerd::measure
