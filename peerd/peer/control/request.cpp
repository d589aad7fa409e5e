#include "peerd/peer/control/request.hpp"

#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "peerd/peer/feed/json_members.hpp"
#include "peerd/peer/feed/pose_feed.hpp"

namespace peerd::control {
namespace {

constexpr std::int64_t kCodeMax = std::numeric_limits<std::int32_t>::max();
constexpr double kAspectMax = 1000.0;
constexpr std::int64_t kObjectMax = std::numeric_limits<std::int64_t>::max();

// The request names its key by a name with modifiers, or by the numbers of Qt.
Request read_key(feed::JsonMembers& members) {
  KeyModifiers held;
  const auto name = members.text("key");
  held.shift = members.flag("shift");
  held.control = members.flag("control");
  held.alt = members.flag("alt");
  held.meta = members.flag("meta");
  held.keypad = members.flag("keypad");
  KeyEvent key{static_cast<std::int32_t>(members.whole("value", 0, 0, kCodeMax)),
               static_cast<std::int32_t>(members.whole("state", 0, 0, kCodeMax))};
  if (members.has("key") == members.has("value")) {
    members.fail("key", "or \"value\" must say which key: a name, or a Qt::Key");
  } else if (members.has("key") && members.has("state")) {
    members.fail("state", "belongs to \"value\"; beside \"key\" say \"shift\": true");
  } else if (members.has("value") && (held.shift || held.control || held.alt || held.meta || held.keypad)) {
    members.fail("value", "has its modifiers in \"state\"");
  } else if (name) {
    const auto found = find_key(*name, held);
    if (found)
      key = *found;
    else
      members.fail("key", "is unknown: " + found.error());
  }
  key.is_release = members.flag("release");
  return KeyRequest{key};
}

Request read_edit(feed::JsonMembers& members, config::SceneEdit::Kind kind) {
  using enum config::SceneEdit::Kind;
  config::SceneEdit edit;
  edit.kind = kind;
  if (kind == kUndo || kind == kRedo) return EditRequest{std::move(edit)};
  if (kind == kAdd) {
    edit.text = members.required(members.text("text"), "text");
  } else {
    edit.path = members.required(members.text("path"), "path");
  }
  if (kind == kAdd || kind == kMove) edit.under = members.text("under").value_or("");
  if (kind == kSet) {
    edit.field = members.required(members.text("field"), "field");
    edit.value = members.required(members.text("value"), "value");
  }
  return EditRequest{std::move(edit)};
}

// Without a position there is none, and none of the rest may be there.
Request read_viewpoint(feed::JsonMembers& members) {
  ViewpointRequest request;
  if (!members.has("position_m")) return request;
  replication::Viewpoint& view = request.viewpoint.emplace();
  view.pose.position = members.required(members.numbers<3>("position_m"), "position_m");
  request.path = members.text("object").value_or("");
  if (const auto turned = members.numbers<4>("orientation_xyzw")) view.pose.orientation.coeffs() = *turned;
  if (const auto angle_rad = members.number("field_of_view_rad")) view.field_of_view = *angle_rad;
  if (const auto aspect = members.number("aspect")) view.aspect = *aspect;
  // Others refuse what is farther away, and with it all that this peer says of itself.
  if (!(view.pose.position.cwiseAbs().maxCoeff() <= feed::kPositionMax_m)) {
    members.fail("position_m", "is farther than 1e9 m from the origin");
  }
  const double length = view.pose.orientation.norm();
  if (!(length > 0.7 && length < 1.42)) members.fail("orientation_xyzw", "is no unit quaternion");
  view.pose.orientation.normalize();
  const bool is_angle = view.field_of_view > 0.0 && view.field_of_view < std::numbers::pi;
  if (!is_angle) members.fail("field_of_view_rad", "has to be between 0 and pi");
  if (!(view.aspect > 0.0 && view.aspect <= kAspectMax)) members.fail("aspect", "has to be above 0, and 1000 at most");
  return request;
}

// With a value, or to be removed: an edit; else a question.
Request read_data(feed::JsonMembers& members) {
  std::string path = members.required(members.text("path"), "path");
  std::optional<std::string> key = members.text("key"), value = members.text("value");
  const bool removes = members.flag("remove");
  if (!value && !removes) return DataRequest{std::move(path), std::move(key)};
  if (value && removes) members.fail("remove", "and \"value\" exclude each other");
  config::SceneEdit edit;
  edit.kind = config::SceneEdit::Kind::kData;
  edit.path = std::move(path);
  edit.key = members.required(std::move(key), "key");
  edit.data = value.value_or("");
  edit.removes = removes;
  return EditRequest{std::move(edit)};
}

Request read_message(feed::JsonMembers& members) {
  config::SceneEdit edit;
  edit.kind = config::SceneEdit::Kind::kSend;
  edit.key = members.required(members.text("topic"), "topic");
  edit.data = members.required(members.text("text"), "text");
  return EditRequest{std::move(edit)};
}

// Without a list, to all kinds.
Request read_subscription(feed::JsonMembers& members) {
  const auto names = members.texts("to");
  if (!names) return SubscribeRequest{EventKinds::all()};
  EventKinds kinds;
  for (const std::string& name : *names) {
    const auto kind = find_event_kind(name);
    if (kind) kinds.add(*kind);
    if (!kind) members.fail("to", "has \"" + name + "\", which is no kind of events");
  }
  return SubscribeRequest{kinds};
}

Request read_operation(feed::JsonMembers& members) {
  const auto author = members.whole("author", 0, 1, replication::kAuthorMax);
  const auto number = members.whole("number", 0, 1, std::numeric_limits<std::uint32_t>::max());
  return OperationRequest{
      {replication::AuthorId{static_cast<std::uint32_t>(author)}, static_cast<std::uint32_t>(number)}};
}

std::optional<config::SceneEdit::Kind> edit_kind(std::string_view word) {
  using enum config::SceneEdit::Kind;
  for (const auto kind : {kAdd, kRemove, kMove, kSet, kOwn, kGrab, kSteal, kRelease, kUndo, kRedo, kLock, kUnlock}) {
    if (word == config::to_string(kind)) return kind;
  }
  return std::nullopt;
}

}  // namespace

bool changes_something(const Request& request) {
  return std::holds_alternative<KeyRequest>(request) || std::holds_alternative<PoseRequest>(request) ||
         std::holds_alternative<LetGoRequest>(request) || std::holds_alternative<ViewpointRequest>(request) ||
         std::holds_alternative<EditRequest>(request) || std::holds_alternative<LeaveRequest>(request) ||
         std::holds_alternative<ViewerRequest>(request);
}

std::expected<Request, std::string> parse_request(std::string_view line) {
  const auto object = feed::parse_json_object(line);
  if (!object) return std::unexpected(object.error());
  feed::JsonMembers members(*object);
  if (const auto ours = members.check_version(); !ours) return std::unexpected(ours.error());
  const std::string what = members.text("do").value_or("");
  std::optional<Request> request;
  if (what == "key") {
    request = read_key(members);
  } else if (what == "status") {
    request = StatusRequest{};
  } else if (what == "peers") {
    request = PeersRequest{static_cast<std::uint32_t>(members.whole("from", 0, 0, kCodeMax))};
  } else if (what == "objects") {
    request = ObjectsRequest{static_cast<std::uint64_t>(members.whole("from", 0, 0, kObjectMax)),
                             static_cast<std::uint32_t>(members.whole("count", kObjectsMax, 1, kObjectsMax))};
  } else if (what == "pose") {
    request = feed::read_pose_message(members);
  } else if (what == "let_go") {
    request = LetGoRequest{members.required(members.text("path"), "path")};
  } else if (what == "viewpoint") {
    request = read_viewpoint(members);
  } else if (const auto kind = edit_kind(what)) {
    request = read_edit(members, *kind);
  } else if (what == "data") {
    request = read_data(members);
  } else if (what == "send") {
    request = read_message(members);
  } else if (what == "conflicts") {
    request = ConflictsRequest{static_cast<std::uint32_t>(members.whole("from", 0, 0, kCodeMax))};
  } else if (what == "subscribe") {
    request = read_subscription(members);
  } else if (what == "operation") {
    request = read_operation(members);
  } else if (what == "world") {
    request = WorldRequest{};
  } else if (what == "viewer") {
    request = ViewerRequest{};
  } else if (what == "leave") {
    request = LeaveRequest{};
  } else {
    members.fail("do",
                 "must be one of \"key\", \"status\", \"peers\", \"objects\", \"pose\", \"let_go\", \"viewpoint\", "
                 "\"add\", \"remove\", \"move\", \"set\", \"own\", \"grab\", \"steal\", \"release\", \"data\", "
                 "\"send\", \"undo\", \"redo\", \"lock\", \"unlock\", \"conflicts\", \"subscribe\", \"operation\", "
                 "\"world\", \"viewer\", \"leave\"");
  }
  if (std::string error = members.finish(); !error.empty()) return std::unexpected(std::move(error));
  return *request;
}

}  // namespace peerd::control
