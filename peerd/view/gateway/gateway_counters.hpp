#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>

#include "peerd/view/gateway/refusal_kind.hpp"

namespace peerd::gateway {

struct GatewayCounters {
  std::uint64_t connections = 0;  // taken since the start
  std::uint64_t requests = 0;     // of HTTP
  std::uint64_t live = 0;         // connections that became WebSockets
  std::uint64_t messages = 0;     // from WebSockets
  std::uint64_t events_dropped = 0;
  std::uint64_t frames = 0, frame_bytes = 0;  // of poses
  std::uint64_t frames_late = 0;              // of those, the ones that waited for a slow reader
  std::array<std::uint64_t, kRefusalKinds> refused{};

  // By "gateway." and a name.
  [[nodiscard]] std::map<std::string, std::uint64_t> named() const;
};

}  // namespace peerd::gateway
