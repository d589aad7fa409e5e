#include "peerd/gateway/live_request.hpp"

#include <cassert>
#include <limits>

#include <nlohmann/json.hpp>

#include "peerd/feed/json_members.hpp"
#include "peerd/input/json_line.hpp"

namespace peerd::gateway {
namespace {

constexpr std::int64_t kSequenceMax = (std::int64_t{1} << 53) - 1;  // the largest that every reader of JSON keeps

}  // namespace

std::expected<LiveRequest, std::string> parse_live_request(std::string_view message) {
  auto object = feed::parse_json_object(message);
  if (!object) return std::unexpected(object.error());
  LiveRequest request;
  if (object->contains("seq")) {
    const nlohmann::json sequence = object->at("seq");
    const bool is_whole = sequence.is_number_integer() && sequence >= 0 && sequence <= kSequenceMax;
    if (!is_whole) return std::unexpected("\"seq\" must be a whole number from 0 to 2^53 - 1");
    request.sequence = sequence.get<std::int64_t>();
    object->erase("seq");
  }
  feed::JsonMembers members(*object);
  if (const auto ours = members.check_version(); !ours) return std::unexpected(ours.error());
  const std::string what = members.text("do").value_or("");
  if (what == "token") {
    request.what = TokenRequest{members.required(members.text("token"), "token")};
  } else {
    request.what = PlainRequest{json_line(*object)};
    return request;
  }
  if (std::string error = members.finish(); !error.empty()) return std::unexpected(std::move(error));
  return request;
}

std::string with_sequence(std::string reply, std::optional<std::int64_t> sequence) {
  assert(reply.starts_with("{\""));
  if (!sequence) return reply;
  return "{\"seq\":" + std::to_string(*sequence) + ',' + reply.substr(1);
}

std::string scene_event(std::uint32_t revision) {
  return nlohmann::ordered_json{{"v", feed::kMessageVersion}, {"event", "scene"}, {"revision", revision}}.dump();
}

}  // namespace peerd::gateway
