#include "peerd/view/gateway/live_request.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"
#include "peerd/peer/feed/json_members.hpp"

namespace peerd::gateway {
namespace {

constexpr std::int64_t kSequenceMax = (std::int64_t{1} << 53) - 1;  // the largest that every reader of JSON keeps

constexpr double kHzMin = 1.0, kHzMax = 120.0;
constexpr std::int64_t kLevelMax = 24;  // of hierarchies
constexpr std::int64_t kNodeMax = std::numeric_limits<std::uint32_t>::max();
constexpr std::array<std::pair<std::string_view, view::PoseKind>, view::kPoseKinds> kKinds{
    {{"shown", view::PoseKind::kShown}, {"truth", view::PoseKind::kTruth}, {"ghost", view::PoseKind::kGhost}}};

view::PoseKinds read_kinds(feed::JsonMembers& members) {
  const auto names = members.texts("kinds");
  if (!names) return view::set_of(view::PoseKind::kShown);
  view::PoseKinds kinds = 0;
  for (const std::string& name : *names) {
    const auto known = std::ranges::find(kKinds, name, [](const auto& kind) { return kind.first; });
    if (known == kKinds.end()) {
      members.fail("kinds", "has \"" + name + "\", which is none of \"shown\", \"truth\" and \"ghost\"");
    } else {
      kinds = static_cast<view::PoseKinds>(kinds | view::set_of(known->second));
    }
  }
  return kinds;
}

WatchRequest read_watch(feed::JsonMembers& members) {
  WatchRequest request;
  if (const auto hz = members.number("hz")) request.hz = *hz;
  if (!(request.hz >= kHzMin && request.hz <= kHzMax)) members.fail("hz", "has to be from 1 to 120");
  request.watch.kinds = read_kinds(members);
  request.watch.looks = members.flag("looks");
  if (!members.has("near")) return request;
  if (const nlohmann::json* const inside = members.object("near")) {
    feed::JsonMembers near(*inside);
    view::PoseStream::Near sphere;
    sphere.center_m = near.required(near.numbers<3>("center_m"), "center_m");
    sphere.radius_m = near.required(near.number("radius_m"), "radius_m");
    if (!(sphere.radius_m > 0.0)) near.fail("radius_m", "has to be above 0");
    if (const std::string error = near.finish(); !error.empty()) members.fail("near", error);
    request.watch.near = sphere;
  }
  return request;
}

// Sizes and times that mean something; a stride that is longer goes by many requests.
constexpr double kSizeMax_m = 1e3, kStrideMax_m = 1e3, kStrideMax_s = 1.0, kFallMax_m_s = 1e3;

WalkRequest read_walk(feed::JsonMembers& members) {
  WalkRequest request;
  request.stride.eye = members.required(members.numbers<3>("eye_m"), "eye_m");
  request.stride.by = members.required(members.numbers<3>("by_m"), "by_m");
  request.stride.falls = members.flag("falls", true);
  const auto take = [&](const char* name, double& value, double most) {
    if (const auto given = members.number(name)) value = *given;
    if (!(value >= 0.0 && value <= most))
      members.fail(name, "has to be from 0 to " + std::to_string(std::lround(most)));
  };
  take("radius_m", request.size.radius_m, kSizeMax_m);
  take("height_m", request.size.height_m, kSizeMax_m);
  take("step_m", request.size.step_m, kSizeMax_m);
  take("for_s", request.stride.for_s, kStrideMax_s);
  take("fall_m_s", request.stride.fall_m_s, kFallMax_m_s);
  if (request.stride.by.norm() > kStrideMax_m) members.fail("by_m", "is longer than 1000 m");
  request.except = members.text("except").value_or("");
  return request;
}

InspectRequest read_inspect(feed::JsonMembers& members) {
  InspectRequest request;
  if (members.has("node")) request.node = static_cast<std::uint32_t>(members.whole("node", 0, 0, kNodeMax));
  if (const auto path = members.text("path")) request.path = *path;
  if (!request.node && !members.has("path")) members.fail("node", "is missing");
  if (request.node && members.has("path")) members.fail("path", "stands beside \"node\": one of the two names a node");
  return request;
}

std::expected<LiveRequest::What, std::string> read_what(const nlohmann::json& object) {
  feed::JsonMembers members(object);
  if (const auto ours = members.check_version(); !ours) return std::unexpected(ours.error());
  const std::string name = members.text("do").value_or("");
  LiveRequest::What what;
  if (name == "token") {
    what = TokenRequest{members.required(members.text("token"), "token")};
  } else if (name == "watch") {
    what = read_watch(members);
  } else if (name == "unwatch") {
    what = UnwatchRequest{};
  } else if (name == "pick") {
    const Vec3 origin = members.required(members.numbers<3>("origin_m"), "origin_m");
    what = PickRequest{origin, members.required(members.numbers<3>("direction"), "direction")};
  } else if (name == "walk") {
    what = read_walk(members);
  } else if (name == "avatar") {
    what = AvatarRequest{members.text("path").value_or("")};
  } else if (name == "inspect") {
    what = read_inspect(members);
  } else if (name == "surroundings") {
    what = SurroundingsRequest{};
  } else if (name == "hierarchy") {
    HierarchyRequest asked{members.required(members.text("path"), "path"), 0};
    asked.level = static_cast<std::uint32_t>(members.whole("level", 0, 0, kLevelMax));
    what = std::move(asked);
  } else {
    return PlainRequest{json_line(object)};
  }
  if (std::string error = members.finish(); !error.empty()) return std::unexpected(std::move(error));
  return what;
}

}  // namespace

LiveRequest parse_live_request(std::string_view message) {
  LiveRequest request;
  auto object = feed::parse_json_object(message);
  if (!object) {
    request.what = std::unexpected(object.error());
    return request;
  }
  if (object->contains("seq")) {
    const nlohmann::json sequence = object->at("seq");
    const bool is_whole = sequence.is_number_integer() && sequence >= 0 && sequence <= kSequenceMax;
    if (!is_whole) {
      request.what = std::unexpected("\"seq\" must be a whole number from 0 to 2^53 - 1");
      return request;
    }
    request.sequence = sequence.get<std::int64_t>();
    object->erase("seq");
  }
  request.what = read_what(*object);
  return request;
}

std::string with_sequence(std::string reply, std::optional<std::int64_t> sequence) {
  assert(reply.starts_with("{\""));
  if (!sequence) return reply;
  return "{\"seq\":" + std::to_string(*sequence) + ',' + reply.substr(1);
}

std::string scene_event(std::uint32_t revision) {
  return json_line(nlohmann::ordered_json{{"v", feed::kMessageVersion}, {"event", "scene"}, {"revision", revision}});
}

}  // namespace peerd::gateway
