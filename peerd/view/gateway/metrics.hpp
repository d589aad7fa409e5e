#pragma once
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace peerd::gateway {

// The counters, clock, peers and regions of a peer in the text format 0.0.4 of Prometheus, made of the control
// protocol's replies to "status" and "peers".
[[nodiscard]] std::string metrics_text(const nlohmann::json& status, const nlohmann::json& peers);

}  // namespace peerd::gateway
