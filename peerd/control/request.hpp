#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/motion/key_codes.hpp"
#include "peerd/feed/pose_feeds.hpp"

namespace peerd::api {

// One line of the control protocol; README.md in this folder specifies it.
inline constexpr int kVersion = 1;
inline constexpr std::size_t kLineMax_bytes = 65'536;  // of a request, its end included: no UDP datagram is longer
// In one reply: nobody's list may hold up the peer's ticks.
inline constexpr std::uint32_t kObjectsMax = 256;
inline constexpr std::size_t kPeersMax = 256, kRegionsMax = 1024;

struct KeyRequest {
  KeyEvent key;
};
struct StatusRequest {};
struct ObjectsRequest {
  std::uint32_t from = 0;  // the first object's number
  std::uint32_t count = kObjectsMax;
};
struct PeersRequest {
  std::uint32_t from = 0;  // the first peer's id
};
struct LeaveRequest {};
struct PoseRequest {
  std::vector<feed::FedPose> poses;
  bool reply = true;  // false: none at all, so that the program need not read
};
using Request = std::variant<KeyRequest, StatusRequest, PeersRequest, ObjectsRequest, LeaveRequest, PoseRequest>;

// Hostile input. The error is one sentence for whoever sent it.
[[nodiscard]] std::expected<Request, std::string> parse_request(std::string_view line);

}  // namespace peerd::api
