#include "peerd/view/gateway/gateway_counters.hpp"

namespace peerd::gateway {

std::map<std::string, std::uint64_t> GatewayCounters::named() const {
  std::map<std::string, std::uint64_t> all{{"gateway.connections", connections},
                                           {"gateway.requests", requests},
                                           {"gateway.live", live},
                                           {"gateway.messages", messages},
                                           {"gateway.events_dropped", events_dropped},
                                           {"gateway.frames", frames},
                                           {"gateway.frame_bytes", frame_bytes},
                                           {"gateway.frames_late", frames_late}};
  for (std::size_t i = 0; i < refused.size(); ++i) {
    all["gateway.refused_" + std::string(text_of(static_cast<RefusalKind>(i)).name)] = refused.at(i);
  }
  return all;
}

}  // namespace peerd::gateway
