#include "peerd/peer/feed/json_members.hpp"

#include <algorithm>
#include <limits>

#include "core/suggestion.hpp"

namespace peerd::feed {

using nlohmann::json;

std::expected<json, std::string> parse_json_object(std::string_view line) {
  // The library would silently keep the last of two members with the same name.
  std::vector<std::set<std::string>> names;  // of each object that is open
  std::optional<std::string> twice;
  const auto note_name = [&](int, json::parse_event_t event, json& parsed) {
    if (event == json::parse_event_t::object_start) names.emplace_back();
    if (event == json::parse_event_t::object_end) names.pop_back();
    if (event != json::parse_event_t::key) return true;
    const std::string& name = parsed.get_ref<const std::string&>();
    if (!names.back().insert(name).second && !twice) twice = name;
    return true;
  };
  json object = json::parse(line, note_name, /*allow_exceptions=*/false);
  if (object.is_discarded())
    return std::unexpected("this is not JSON, which has no NaN and no 1e999; write one object on a line");
  if (!object.is_object()) return std::unexpected("this is JSON, but no object");
  if (twice) return std::unexpected("\"" + *twice + "\" is given twice");
  return object;
}

const json* JsonMembers::find(const char* name) {
  known_.insert(name);
  const auto at = object_.find(name);
  return at == object_.end() ? nullptr : &*at;
}

std::optional<std::string> JsonMembers::text(const char* name) {
  const json* value = find(name);
  if (value == nullptr) return std::nullopt;
  if (!value->is_string()) return fail(name, "must be a string"), std::nullopt;
  return value->get<std::string>();
}

bool JsonMembers::flag(const char* name, bool otherwise) {
  const json* value = find(name);
  if (value == nullptr) return otherwise;
  if (!value->is_boolean()) return fail(name, "must be true or false"), otherwise;
  return value->get<bool>();
}

std::int64_t JsonMembers::whole(const char* name, std::int64_t otherwise, std::int64_t min, std::int64_t max) {
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

std::optional<double> JsonMembers::number(const char* name) {
  const json* value = find(name);
  if (value == nullptr) return std::nullopt;
  if (!value->is_number()) return fail(name, "must be a number"), std::nullopt;
  return value->get<double>();
}

template <int Size>
std::optional<Eigen::Matrix<double, Size, 1>> JsonMembers::numbers(const char* name) {
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
template std::optional<Eigen::Vector3d> JsonMembers::numbers<3>(const char*);
template std::optional<Eigen::Vector4d> JsonMembers::numbers<4>(const char*);

std::optional<std::vector<std::string>> JsonMembers::texts(const char* name) {
  const json* value = find(name);
  if (value == nullptr) return std::nullopt;
  const bool good = value->is_array() && std::ranges::all_of(*value, [](const json& item) { return item.is_string(); });
  if (!good) return fail(name, "must be a list of strings"), std::nullopt;
  return value->get<std::vector<std::string>>();
}

const json* JsonMembers::object(const char* name) {
  const json* value = find(name);
  if (value == nullptr || value->is_object()) return value;
  return fail(name, "must be an object"), nullptr;
}

std::vector<const json*> JsonMembers::objects(const char* name) {
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

std::expected<void, std::string> JsonMembers::check_version() {
  const std::int64_t version = whole("v", kMessageVersion, 0, std::numeric_limits<std::int32_t>::max());
  if (version == kMessageVersion) return {};
  return std::unexpected("version " + std::to_string(version) + " is not spoken here; this is version " +
                         std::to_string(kMessageVersion));
}

std::string JsonMembers::stands_in_place_of(const char* name) const {
  for (const auto& [given, value] : object_.items()) {
    if (known_.contains(given)) continue;
    Suggestion suggestion(given);
    suggestion.consider(name);
    if (suggestion.best()) return "; there is a \"" + given + "\"";
  }
  return "";
}

void JsonMembers::fail(const std::string& name, const std::string& what) {
  if (error_.empty()) error_ = "\"" + name + "\" " + what;
}

std::string JsonMembers::finish() {
  for (const auto& [name, value] : object_.items()) {
    if (known_.contains(name) || !error_.empty()) continue;
    error_ = "unknown member \"" + name + "\"";
    Suggestion suggestion(name);
    for (const std::string& k : known_) suggestion.consider(k);
    if (const auto meant = suggestion.best()) error_ += "; did you mean \"" + std::string(*meant) + "\"?";
  }
  return error_;
}

}  // namespace peerd::feed
