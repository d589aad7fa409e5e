#pragma once
#include <cstddef>
#include <cstdint>
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "core/motion/key_codes.hpp"
#include "peerd/peer/config/scene_edit.hpp"
#include "peerd/peer/control/event_kind.hpp"
#include "peerd/peer/feed/pose_message.hpp"
#include "replication/wire/operation.hpp"
#include "replication/wire/wire.hpp"

namespace peerd::control {

// The requests of the control protocol, which docs/reference/control-protocol.md specifies.

// The longest request [bytes], its line end included; no UDP datagram is longer.
inline constexpr std::size_t kLineMax_bytes = 65'536;
// The longest lists of one reply. Making a longer one would hold up the peer's ticks.
inline constexpr std::uint32_t kObjectsMax = 256;
inline constexpr std::size_t kPeersMax = 256, kRegionsMax = 1024, kConflictsMax = 64;
// The longest lost value of a reply [bytes]; of a longer one the beginning.
inline constexpr std::size_t kLostValueMax_bytes = 4096;

struct KeyRequest {
  KeyEvent key;
};
struct StatusRequest {};
struct ObjectsRequest {
  std::uint64_t from = 0;  // the first object's number
  std::uint32_t count = kObjectsMax;
};
struct PeersRequest {
  std::uint32_t from = 0;  // the first peer's id
};
struct LeaveRequest {};
using PoseRequest = feed::PoseMessage;
// A LetGoRequest ends that poses move an object which this peer has grabbed.
struct LetGoRequest {
  std::string path;
};
// From now on the peer looks from there, in the frame of the node at the path (empty: the world); none: as its
// configuration says.
struct ViewpointRequest {
  std::string path;
  std::optional<replication::Viewpoint> viewpoint;
};
struct EditRequest {
  config::SceneEdit edit;
};
// An OperationRequest asks what has become of an operation that this peer has made.
struct OperationRequest {
  replication::OperationId operation;
};
// A DataRequest asks for the value under a key of a node, or for the keys that the node has.
struct DataRequest {
  std::string path;
  std::optional<std::string> key;
};
struct ConflictsRequest {
  std::uint32_t from = 0;  // so many are passed over
};
// A SubscribeRequest asks for the events of these kinds, from now on.
struct SubscribeRequest {
  EventKinds kinds;
};
struct WorldRequest {};   // the scene as it is, as VRML
struct ViewerRequest {};  // where this peer's page is
using Request = std::variant<KeyRequest, StatusRequest, PeersRequest, ObjectsRequest, LeaveRequest, PoseRequest,
                             LetGoRequest, ViewpointRequest, EditRequest, OperationRequest, DataRequest,
                             ConflictsRequest, SubscribeRequest, WorldRequest, ViewerRequest>;

// Whether the request changes something, if only at this peer (a key, poses, a viewpoint, an edit, leaving), or gives
// the token with which one may.
[[nodiscard]] bool changes_something(const Request& request);

// Parses one line of hostile input. The error is one sentence for its sender.
[[nodiscard]] std::expected<Request, std::string> parse_request(std::string_view line);

}  // namespace peerd::control
