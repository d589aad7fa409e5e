#include "peerd/cli/client/peer_replies.hpp"

#include <array>
#include <utility>

#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"
#include "peerd/peer/control/control_client.hpp"

namespace peerd {
namespace {

using Json = nlohmann::ordered_json;

// The lists of which a reply has a limited number of rows, and "next" to continue from.
constexpr std::array kLists{"objects", "peers", "conflicts"};

Result<void> fetch_rest(const std::filesystem::path& socket, const char* list, Json& reply) {
  while (!reply.at("next").is_null()) {
    const auto line = control::ask(socket, json_line(Json{{"do", list}, {"from", reply.at("next")}}));
    if (!line) return std::unexpected(line.error());
    auto more = read_reply(socket, *line);
    if (!more) return std::unexpected(more.error());
    for (Json& row : more->at(list)) reply.at(list).push_back(std::move(row));
    reply.at("next") = more->at("next");
  }
  return {};
}

}  // namespace

Result<Json> read_reply(const std::filesystem::path& socket, const std::string& line) {
  Json reply = Json::parse(line, nullptr, /*allow_exceptions=*/false);
  const bool understood =
      reply.is_object() && reply.contains("ok") && reply.at("ok").is_boolean() && reply.value("v", 0) == 1;
  if (!understood) {
    return std::unexpected(InputError{
        "error: what listens at " + socket.string() + " is no peer of this version: " + line.substr(0, 200), 3});
  }
  if (!reply.at("ok").get<bool>()) {
    return std::unexpected(InputError{"error: " + reply.value("error", std::string("no reason given")), kWrongUse});
  }
  return reply;
}

Result<Json> ask_peer(const std::filesystem::path& socket, const std::string& request) {
  const auto line = control::ask(socket, request);
  if (!line) return std::unexpected(line.error());
  auto reply = read_reply(socket, *line);
  if (!reply) return reply;
  for (const char* const list : kLists) {
    // The status has only the first of the peer's own objects, and says so.
    if (!reply->contains(list) || reply->contains("counters")) continue;
    if (const auto all = fetch_rest(socket, list, *reply); !all) return std::unexpected(all.error());
  }
  return reply;
}

}  // namespace peerd
