#include "peerd/peer/feed/pose_message.hpp"

#include <utility>

#include "peerd/peer/feed/json_members.hpp"

namespace peerd::feed {
namespace {

// Reads one object's pose. `time_s` is the message's, for poses without a time of their own. PoseFeed judges the
// values.
FedPose read_pose(JsonMembers& members, std::optional<double> time_s) {
  FedPose fed;
  fed.object = members.required(members.text("object"), "object");
  fed.time_s = members.number("time_s");
  if (!fed.time_s) fed.time_s = time_s;
  fed.pose.position = members.required(members.numbers<3>("position_m"), "position_m");
  if (const auto q = members.numbers<4>("orientation_xyzw")) {
    fed.pose.orientation = Quat(q->w(), q->x(), q->y(), q->z());
  }
  fed.pose.velocity = members.numbers<3>("velocity_m_s");
  fed.pose.acceleration = members.numbers<3>("acceleration_m_s2");
  fed.pose.angular_velocity_body = members.numbers<3>("angular_velocity_rad_s");
  fed.pose.jump = members.flag("jump");
  return fed;
}

}  // namespace

PoseMessage read_pose_message(JsonMembers& members) {
  PoseMessage message;
  message.reply = members.flag("reply", true);
  if (!members.has("poses")) {
    message.poses.push_back(read_pose(members, std::nullopt));
    return message;
  }
  const auto time_s = members.number("time_s");
  for (const nlohmann::json* item : members.objects("poses")) {
    JsonMembers pose(*item);
    message.poses.push_back(read_pose(pose, time_s));
    if (const std::string error = pose.finish(); !error.empty()) {
      members.fail("poses", "number " + std::to_string(message.poses.size()) + ": " + error);
      break;
    }
  }
  return message;
}

std::expected<PoseMessage, std::string> parse_pose_message(std::string_view datagram) {
  const auto object = parse_json_object(datagram);
  if (!object) return std::unexpected(object.error());
  JsonMembers members(*object);
  if (const auto ours = members.check_version(); !ours) return std::unexpected(ours.error());
  if (members.text("do") != "pose") return std::unexpected("by UDP \"do\" must be \"pose\"");
  PoseMessage message = read_pose_message(members);
  if (std::string error = members.finish(); !error.empty()) return std::unexpected(std::move(error));
  return message;
}

}  // namespace peerd::feed
