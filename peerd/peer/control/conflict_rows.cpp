#include "peerd/peer/control/conflict_rows.hpp"

#include <optional>
#include <string>

#include <spdlog/fmt/fmt.h>

#include "peerd/peer/control/request.hpp"
#include "peerd/peer/node/edit_operation.hpp"

namespace peerd::control {
namespace {

using namespace replication;
using nlohmann::ordered_json;

// The words say what an operation changes, and to which value, for people.
struct Words {
  std::string what;
  std::optional<std::string> value{};
};

struct WordsOf {
  const Scene& scene;

  template <class Id>
  [[nodiscard]] std::string path(Id id) const {
    return path_or_id(scene, id);
  }
  Words operator()(const AddNodes& a) const {
    return {a.parent ? "add below " + path(*a.parent) : "add at the top level", a.text};
  }
  Words operator()(const RemoveObject& r) const { return {"remove " + path(r.object)}; }
  Words operator()(const RemoveNode& r) const { return {"remove " + path(r.node)}; }
  Words operator()(const MoveObject& m) const {
    return {"move " + path(m.object), m.parent ? "below " + path(*m.parent) : "to the top level"};
  }
  Words operator()(const SetField& s) const { return {fmt::format("set {} {}", path(s.node), s.field), s.value}; }
  Words operator()(const ChangeRoute& c) const {
    return {fmt::format("{} ROUTE {}.{} TO {}.{}", c.removes ? "remove" : "add", path(c.from), c.event_out, path(c.to),
                        c.event_in)};
  }
  Words operator()(const SetData& d) const {
    return {fmt::format("data {} {}", path(d.node), d.key), d.value ? d.value : std::optional<std::string>("removed")};
  }
  template <class Other>
  Words operator()(const Other& other) const {
    return {kind_of(other)};
  }
};

ordered_json operation(const OperationKey& key) {
  return {{"author", key.second.author.value},
          {"number", key.second.number},
          {"at_s", to_seconds(key.first.time_since_epoch())}};
}

ordered_json row(const PeerNode& node, const Conflict& conflict) {
  const auto words = [&](const OperationKey& key) {
    const auto body = node.peer().find(key);
    return body ? std::visit(WordsOf{node.scene()}, *body) : Words{"?"};
  };
  const Words lost = words(conflict.loser);
  ordered_json row{{"what", lost.what}, {"value", nullptr}, {"lost", operation(conflict.loser)}, {"winner", nullptr}};
  if (lost.value) row["value"] = lost.value->substr(0, kLostValueMax_bytes);
  if (lost.value && lost.value->size() > kLostValueMax_bytes) row["value_bytes"] = lost.value->size();
  if (conflict.winner) {
    const Words won = words(*conflict.winner);
    row["winner"] = operation(*conflict.winner);
    row["winner"]["what"] = won.what;
    row["winner"]["value"] =
        won.value ? ordered_json(won.value->substr(0, kLostValueMax_bytes)) : ordered_json(nullptr);
  }
  row["found_s"] = to_seconds(conflict.found.time_since_epoch());
  return row;
}

}  // namespace

ordered_json conflict_rows(const PeerNode& node, HostTime now, std::uint32_t from) {
  ordered_json rows{{"conflicts", ordered_json::array()}, {"next", nullptr}};
  const SessionClock& clock = node.peer().clock();
  if (clock.synchronised()) {
    const std::vector<Conflict> all = node.peer().conflicts().list(clock.to_session(now));
    for (std::size_t i = from; i < all.size(); ++i) {
      if (rows["conflicts"].size() == kConflictsMax) {
        rows["next"] = i;
        break;
      }
      rows["conflicts"].push_back(row(node, all[i]));
    }
  }
  rows["forgotten"] = node.peer().conflicts().forgotten();
  return rows;
}

}  // namespace peerd::control
