#pragma once
#include <chrono>
#include <cstddef>

namespace peerd::gateway {

inline constexpr std::size_t kConnectionsMax = 1000;
inline constexpr std::size_t kHeaderMax_bytes = 8192;
// The body of a request and the message of a WebSocket: of a client that has shown the token, and of any other, so that
// a thousand strangers occupy 64 MiB at most.
inline constexpr std::size_t kBodyMax_bytes = std::size_t{1} << 20, kStrangersBodyMax_bytes = 65'536;
inline constexpr std::chrono::seconds kRequestWithin{5};  // from its first byte to its last
inline constexpr std::chrono::seconds kIdle{30};          // between two requests
// A client reads what waits for it within this time and as long as it takes at the least rate.
inline constexpr std::chrono::seconds kReadWithin{30};
inline constexpr std::size_t kRateMin_bytes_s = 100'000;

[[nodiscard]] inline std::chrono::seconds time_to_read(std::size_t size_bytes) {
  return kReadWithin + std::chrono::seconds(size_bytes / kRateMin_bytes_s);
}

}  // namespace peerd::gateway
