#pragma once
#include <expected>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "peerd/peer/feed/pose_feed.hpp"

namespace peerd::feed {

class JsonMembers;

// One pose as a message names it: an object by its path, and the Unix time at which it was there [s]; without a time,
// the time of arrival counts.
struct FedPose {
  std::string object;
  std::optional<double> time_s;
  PoseSample pose;
};

// A message of an external program about the objects that it moves, over the control socket or by UDP
// (docs/reference/control-protocol.md).
struct PoseMessage {
  std::vector<FedPose> poses;
  bool reply = true;  // false: the control socket does not reply, so that the program need not read
};

// Reads the members of a "pose" message, "v" and "do" apart. Errors are kept in `members`.
[[nodiscard]] PoseMessage read_pose_message(JsonMembers& members);

// Parses a datagram of the pose port, which is hostile input. The error is one sentence for the log.
[[nodiscard]] std::expected<PoseMessage, std::string> parse_pose_message(std::string_view datagram);

}  // namespace peerd::feed
