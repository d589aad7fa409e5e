#pragma once
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "core/math.hpp"
#include "peerd/view/frames/pose_frame.hpp"
#include "peerd/view/picks/walk.hpp"

namespace peerd::gateway {

// The messages of a WebSocket's client: requests of the control protocol, and some of the gateway's own.

struct TokenRequest {
  std::string token;
};
// A request of the control protocol, as a line.
struct PlainRequest {
  std::string line;
};
struct WatchRequest {
  double hz = 20.0;
  view::PoseStream::Watch watch;
};
struct UnwatchRequest {};
struct PickRequest {
  Vec3 origin, direction;
};
// A WalkRequest asks where somebody comes who goes through the scene as it stands now.
struct WalkRequest {
  view::AvatarSize size;
  view::Stride stride;
  std::string except;  // the path of an object that it does not meet; empty: none
};
// That object is the client's avatar: it is removed when the connection ends.
struct AvatarRequest {
  std::string path;  // empty: the client has none any more
};
// An InspectRequest names a node of the picture by its number, or any node by its path.
struct InspectRequest {
  std::optional<std::uint32_t> node;
  std::string path;  // counts without a number
};
struct SurroundingsRequest {};
struct HierarchyRequest {
  std::string path;
  std::uint32_t level = 0;
};
struct LiveRequest {
  using What = std::variant<PlainRequest, TokenRequest, WatchRequest, UnwatchRequest, PickRequest, InspectRequest,
                            WalkRequest, AvatarRequest, SurroundingsRequest, HierarchyRequest>;

  std::optional<std::int64_t> sequence;   // which the reply repeats, also where it is a refusal
  std::expected<What, std::string> what;  // the error is one sentence for its sender
};

// Parses one message of hostile input.
[[nodiscard]] LiveRequest parse_live_request(std::string_view message);

// A reply, with "seq" where its request had that.
[[nodiscard]] std::string with_sequence(std::string reply, std::optional<std::int64_t> sequence);
// The event that the scene has another revision.
[[nodiscard]] std::string scene_event(std::uint32_t revision);

}  // namespace peerd::gateway
