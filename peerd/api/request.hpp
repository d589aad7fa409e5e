#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <string>
#include <string_view>
#include <variant>

#include "core/key_codes.hpp"

namespace peerd::api {

// One line of the control protocol; README.md in this folder specifies it.
inline constexpr int kVersion = 1;
inline constexpr std::size_t kLineMax_bytes = 4096;  // of a request, its end included
inline constexpr std::uint32_t kObjectsMax =
    256;  // in one reply: nobody's list of objects may hold up the peer's ticks

struct KeyRequest {
  KeyEvent key;
};
struct StatusRequest {};
struct ObjectsRequest {
  std::uint32_t from = 0;  // the first object's number
  std::uint32_t count = kObjectsMax;
};
struct LeaveRequest {};
using Request = std::variant<KeyRequest, StatusRequest, ObjectsRequest, LeaveRequest>;

// Hostile input. The error is one sentence for whoever sent it.
[[nodiscard]] std::expected<Request, std::string> parse_request(std::string_view line);

}  // namespace peerd::api
