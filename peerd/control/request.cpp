#include "peerd/control/request.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/suggestion.hpp"

namespace peerd::api {
namespace {

using nlohmann::json;

constexpr std::int64_t kCodeMax = std::numeric_limits<std::int32_t>::max();

// A JSON object's members, each read once. Like the reader of configurations: the first error wins, and a member that
// nobody asked for is one.
class Members {
 public:
  explicit Members(const json& object) : object_(object) {}

  [[nodiscard]] bool has(const char* name) const { return object_.contains(name); }
  std::optional<std::string> text(const char* name) {
    const json* value = find(name);
    if (value == nullptr) return std::nullopt;
    if (!value->is_string()) return fail(name, "must be a string"), std::nullopt;
    return value->get<std::string>();
  }
  bool flag(const char* name, bool otherwise = false) {
    const json* value = find(name);
    if (value == nullptr) return otherwise;
    if (!value->is_boolean()) return fail(name, "must be true or false"), otherwise;
    return value->get<bool>();
  }
  std::int64_t whole(const char* name, std::int64_t otherwise, std::int64_t min, std::int64_t max) {
    const json* value = find(name);
    if (value == nullptr) return otherwise;
    const bool fits =
        value->is_number_unsigned()
            ? value->get<std::uint64_t>() <= static_cast<std::uint64_t>(max) && value->get<std::int64_t>() >= min
            : value->is_number_integer() && value->get<std::int64_t>() >= min && value->get<std::int64_t>() <= max;
    if (!fits) {
      fail(name, "must be a whole number from " + std::to_string(min) + " to " + std::to_string(max));
      return otherwise;
    }
    return value->get<std::int64_t>();
  }
  std::optional<double> number(const char* name) {
    const json* value = find(name);
    if (value == nullptr) return std::nullopt;
    if (!value->is_number()) return fail(name, "must be a number"), std::nullopt;
    return value->get<double>();
  }
  template <int Size>
  std::optional<Eigen::Matrix<double, Size, 1>> numbers(const char* name) {
    const json* value = find(name);
    if (value == nullptr) return std::nullopt;
    const auto is_number = [](const json& x) { return x.is_number(); };
    if (!value->is_array() || value->size() != Size || !std::ranges::all_of(*value, is_number)) {
      return fail(name, "must be a list of " + std::to_string(Size) + " numbers"), std::nullopt;
    }
    Eigen::Matrix<double, Size, 1> v;
    for (int i = 0; i < Size; ++i) v[i] = value->at(static_cast<std::size_t>(i)).template get<double>();
    return v;
  }
  // A list of objects; empty where it is not there.
  std::vector<const json*> objects(const char* name) {
    const json* value = find(name);
    std::vector<const json*> items;
    if (value == nullptr) return items;
    if (!value->is_array()) return fail(name, "must be a list"), items;
    for (const json& item : *value) {
      if (!item.is_object()) return fail(name, "must be a list of objects"), items;
      items.push_back(&item);
    }
    return items;
  }
  template <class T>
  T required(std::optional<T> value, const char* name) {
    if (!value) fail(name, "is missing");
    return value ? std::move(*value) : T();
  }
  void fail(const std::string& name, const std::string& what) {
    if (error_.empty()) error_ = "\"" + name + "\" " + what;
  }
  // The first thing wrong with the object; empty where nothing is.
  std::string finish() {
    for (const auto& [name, value] : object_.items()) {
      if (known_.contains(name) || !error_.empty()) continue;
      error_ = "unknown member \"" + name + "\"";
      Suggestion suggestion(name);
      for (const std::string& k : known_) suggestion.consider(k);
      if (const auto meant = suggestion.best()) error_ += "; did you mean \"" + std::string(*meant) + "\"?";
    }
    return error_;
  }

 private:
  const json* find(const char* name) {
    known_.insert(name);
    const auto at = object_.find(name);
    return at == object_.end() ? nullptr : &*at;
  }

  const json& object_;
  std::set<std::string> known_;
  std::string error_;
};

Request read_key(Members& members) {
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
  return KeyRequest{key};
}

// One object's pose; values are judged where they are used (pose_feed.hpp).
feed::FedPose read_pose(Members& members, std::optional<double> time_s) {
  feed::FedPose fed;
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

// One pose, or a list of them with what they have in common.
Request read_poses(Members& members) {
  PoseRequest request;
  request.reply = members.flag("reply", true);
  if (!members.has("poses")) {
    request.poses.push_back(read_pose(members, std::nullopt));
    return request;
  }
  const auto time_s = members.number("time_s");
  for (const json* item : members.objects("poses")) {
    Members pose(*item);
    request.poses.push_back(read_pose(pose, time_s));
    if (const std::string error = pose.finish(); !error.empty()) {
      members.fail("poses", "number " + std::to_string(request.poses.size()) + ": " + error);
      break;
    }
  }
  return request;
}

}  // namespace

std::expected<Request, std::string> parse_request(std::string_view line) {
  // The library would keep the last of two members of one name without a word.
  std::vector<std::set<std::string>> names;  // of the objects that are open
  std::optional<std::string> twice;
  const auto note_name = [&](int, json::parse_event_t event, json& parsed) {
    if (event == json::parse_event_t::object_start) names.emplace_back();
    if (event == json::parse_event_t::object_end) names.pop_back();
    if (event != json::parse_event_t::key) return true;
    const std::string& name = parsed.get_ref<const std::string&>();
    if (!names.back().insert(name).second && !twice) twice = name;
    return true;
  };
  const json object = json::parse(line, note_name, /*allow_exceptions=*/false);
  if (object.is_discarded())
    return std::unexpected("this is not JSON, which has no NaN and no 1e999; write one object on a line");
  if (!object.is_object()) return std::unexpected("this is JSON, but no object");
  if (twice) return std::unexpected("\"" + *twice + "\" is given twice");
  Members members(object);
  const std::int64_t version = members.whole("v", kVersion, 0, kCodeMax);
  if (version != kVersion) {
    return std::unexpected("version " + std::to_string(version) + " is not spoken here; this is version " +
                           std::to_string(kVersion));
  }
  const std::string what = members.text("do").value_or("");
  std::optional<Request> request;
  if (what == "key") {
    request = read_key(members);
  } else if (what == "status") {
    request = StatusRequest{};
  } else if (what == "peers") {
    request = PeersRequest{static_cast<std::uint32_t>(members.whole("from", 0, 0, kCodeMax))};
  } else if (what == "objects") {
    request = ObjectsRequest{static_cast<std::uint32_t>(members.whole("from", 0, 0, kCodeMax)),
                             static_cast<std::uint32_t>(members.whole("count", kObjectsMax, 1, kObjectsMax))};
  } else if (what == "pose") {
    request = read_poses(members);
  } else if (what == "leave") {
    request = LeaveRequest{};
  } else {
    members.fail("do", "must be one of \"key\", \"status\", \"peers\", \"objects\", \"pose\", \"leave\"");
  }
  if (std::string error = members.finish(); !error.empty()) return std::unexpected(std::move(error));
  return *request;
}

}  // namespace peerd::api
