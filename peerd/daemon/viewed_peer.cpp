#include "peerd/daemon/viewed_peer.hpp"

#include <nlohmann/json.hpp>

#include "peerd/control/answer.hpp"
#include "peerd/gateway/metrics.hpp"

namespace peerd {

std::string ViewedPeer::metrics() {
  const HostTime now = daemon_.now();
  const auto reply_to = [&](const char* request) {
    const api::Answer answer =
        api::answer(node_, now, request, Duration{0}, [this] { return daemon_.counters_of_status(); });
    return nlohmann::json::parse(answer.line);
  };
  return gateway::metrics_text(reply_to(R"({"do":"status"})"), reply_to(R"({"do":"peers"})"));
}

std::uint32_t ViewedPeer::revision() { return static_cast<std::uint32_t>(node_.peer().counters().scene_changes + 1); }

}  // namespace peerd
