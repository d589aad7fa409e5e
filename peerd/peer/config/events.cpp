#include "peerd/peer/config/events.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "peerd/input/text_file.hpp"

namespace peerd::config {
namespace {

// The kinds of edits stand in the order of SceneEdit::Kind, in place of EventKind::kEdit.
const std::initializer_list<std::string_view> kKinds{"join",
                                                     "leave",
                                                     "kill",
                                                     "partition",
                                                     "heal",
                                                     "network",
                                                     "key",
                                                     to_string(SceneEdit::Kind::kAdd),
                                                     to_string(SceneEdit::Kind::kRemove),
                                                     to_string(SceneEdit::Kind::kMove),
                                                     to_string(SceneEdit::Kind::kSet),
                                                     to_string(SceneEdit::Kind::kOwn),
                                                     to_string(SceneEdit::Kind::kGrab),
                                                     to_string(SceneEdit::Kind::kSteal),
                                                     to_string(SceneEdit::Kind::kRelease),
                                                     to_string(SceneEdit::Kind::kData),
                                                     to_string(SceneEdit::Kind::kSend),
                                                     to_string(SceneEdit::Kind::kUndo),
                                                     to_string(SceneEdit::Kind::kRedo),
                                                     to_string(SceneEdit::Kind::kLock),
                                                     to_string(SceneEdit::Kind::kUnlock)};
constexpr SizeLimit kAddedText{kMiB, "no operation is so long", 2};
constexpr std::size_t kFirstEdit = static_cast<std::size_t>(EventKind::kEdit);

bool joins_or_leaves(EventKind kind) {
  return kind == EventKind::kJoin || kind == EventKind::kLeave || kind == EventKind::kKill;
}

class EventReader {
 public:
  EventReader(TomlReader& root, const std::vector<PeerSettings>& peers, double duration_s,
              const std::filesystem::path& folder)
      : root_(root), peers_(peers), duration_s_(duration_s), folder_(folder) {}

  std::vector<ScenarioEvent> all() {
    const toml::table* tables = root_.table("event");
    if (tables == nullptr) return {};
    std::vector<ScenarioEvent> events;
    for (const auto& [name, value] : *tables) {
      const std::string key = "event." + std::string(name.str());
      if (!value.is_table()) {
        root_.fail(&value, key + " must be a table: at_s, kind and what goes with it");
        continue;
      }
      events.push_back(event(TomlReader(*value.as_table(), key, root_.error()), std::string(name.str())));
    }
    std::ranges::sort(events, {}, [](const ScenarioEvent& e) { return std::tie(e.at_s, e.name); });
    check_order(events, *tables);
    return events;
  }

 private:
  ScenarioEvent event(TomlReader reader, const std::string& name) {
    ScenarioEvent e;
    e.name = name;
    reader.require("at_s");
    reader.read("at_s", e.at_s, 0.0, kForever_s);
    if (e.at_s > duration_s_) {
      reader.fail(reader.raw().get("at_s"), reader.dotted("at_s") + ": the run is over by then (duration_s)");
    }
    reader.require("kind");
    std::size_t kind = 0;
    reader.read_word("kind", kind, kKinds);
    e.kind = static_cast<EventKind>(std::min(kind, kFirstEdit));
    if (joins_or_leaves(e.kind)) {
      reader.require("peer");
      e.peer = peer(reader, "peer");
    } else if (e.kind == EventKind::kPartition) {
      reader.require("groups");
      e.sides = sides(reader);
    } else if (e.kind == EventKind::kKey) {
      reader.require("peer");
      e.peer = peer(reader, "peer");
      e.key = read_key(reader);
    } else if (e.kind == EventKind::kEdit) {
      reader.require("peer");
      e.peer = peer(reader, "peer");
      e.edit = edit(reader, static_cast<SceneEdit::Kind>(kind - kFirstEdit));
    } else if (e.kind == EventKind::kNetwork) {
      e.from = peer(reader, "from");
      e.to = peer(reader, "to");
      e.change = read_link_change(reader);
      if (e.change.empty()) reader.fail(nullptr, reader.dotted("kind") + ": say what changes, such as latency_ms");
    }
    reader.finish();
    return e;
  }

  SceneEdit edit(TomlReader& reader, SceneEdit::Kind kind) {
    SceneEdit e;
    e.kind = kind;
    const auto needed = [&](std::string_view key, std::string& value) {
      reader.require(key);
      reader.read(key, value);
    };
    if (kind == SceneEdit::Kind::kAdd) {
      reader.read("text", e.text);
      std::string file;
      reader.read("file", file);
      if (reader.has("text") == reader.has("file")) {
        reader.fail(nullptr, reader.dotted("text") + ": give either a text or its file");
      } else if (reader.has("file")) {
        auto text = read_text_file(folder_ / file, kAddedText);
        if (text) {
          e.text = *std::move(text);
        } else {
          reader.fail(reader.raw().get("file"), reader.dotted("file") + ": " + text.error().text);
        }
      }
    } else if (kind != SceneEdit::Kind::kSend && kind != SceneEdit::Kind::kUndo && kind != SceneEdit::Kind::kRedo) {
      needed("path", e.path);
    }
    if (kind == SceneEdit::Kind::kSend) {
      needed("topic", e.key);
      needed("text", e.data);
    }
    if (kind == SceneEdit::Kind::kData) {
      needed("key", e.key);
      reader.read("value", e.data);
      reader.read("remove", e.removes);
      if (reader.has("value") == e.removes) {
        reader.fail(nullptr, reader.dotted("value") + ": give either a value or remove = true");
      }
    }
    if (kind == SceneEdit::Kind::kAdd || kind == SceneEdit::Kind::kMove) reader.read("under", e.under);
    if (kind == SceneEdit::Kind::kSet) {
      needed("field", e.field);
      needed("value", e.value);
    }
    return e;
  }

  std::string peer(TomlReader& reader, std::string_view key) {
    std::string name;
    reader.read(key, name);
    if (reader.has(key)) (void)index_of(reader, key, name);
    return name;
  }

  std::size_t index_of(TomlReader& reader, std::string_view key, const std::string& name) {
    const auto at = std::ranges::find(peers_, name, &PeerSettings::name);
    if (at == peers_.end()) {
      std::vector<std::string> names;
      for (const PeerSettings& p : peers_) names.push_back(p.name);
      const auto meant = did_you_mean(name, names);
      reader.fail(reader.raw().get(key), reader.dotted(key) + ": the scenario has no peer \"" + name + "\"" +
                                             (meant ? "; did you mean \"" + *meant + "\"?" : ""));
    }
    return static_cast<std::size_t>(at - peers_.begin());
  }

  // The peers that are in no group form one group together.
  std::vector<std::uint32_t> sides(TomlReader& reader) {
    const auto groups = reader.word_rows("groups");
    std::vector<std::uint32_t> sides(peers_.size(), 0);
    for (std::size_t g = 0; g < groups.size(); ++g) {
      for (const std::string& name : groups[g]) {
        const std::size_t i = index_of(reader, "groups", name);
        if (i == peers_.size()) return sides;
        if (sides[i] != 0) {
          reader.fail(reader.raw().get("groups"), reader.dotted("groups") + ": \"" + name + "\" is in two of them");
        }
        sides[i] = static_cast<std::uint32_t>(g) + 1;
      }
    }
    if (!reader.error() && std::ranges::adjacent_find(sides, std::ranges::not_equal_to{}) == sides.end()) {
      reader.fail(reader.raw().get("groups"), reader.dotted("groups") + ": all peers are in one, so nothing is parted");
    }
    return sides;
  }

  // A peer that joins must be away, a peer that leaves must be there, and a network that heals must be partitioned.
  void check_order(const std::vector<ScenarioEvent>& events, const toml::table& tables) {
    if (events.empty()) return;
    std::map<std::string, bool> there;
    for (const PeerSettings& p : peers_) there[p.name] = starts_with(events, p.name);
    const auto fail = [&](const ScenarioEvent& e, const std::string& what) {
      root_.fail(tables.get(e.name), "event." + e.name + ": " + what);
    };
    if (std::ranges::none_of(there, [](const auto& p) { return p.second; })) {
      return fail(events.front(), "somebody must be there from the start: all peers join later");
    }
    bool parted = false;
    for (const ScenarioEvent& e : events) {
      if (joins_or_leaves(e.kind)) {
        const bool joins = e.kind == EventKind::kJoin;
        if (there[e.peer] == joins) fail(e, "\"" + e.peer + "\" is " + (joins ? "there already" : "not there then"));
        there[e.peer] = joins;
      }
      if ((e.kind == EventKind::kKey || e.kind == EventKind::kEdit) && !there[e.peer])
        fail(e, "\"" + e.peer + "\" is not there then");
      if (e.kind == EventKind::kHeal && !parted) fail(e, "there is no partition then");
      if (e.kind == EventKind::kPartition || e.kind == EventKind::kHeal) parted = e.kind == EventKind::kPartition;
    }
  }

  TomlReader& root_;
  const std::vector<PeerSettings>& peers_;
  double duration_s_;
  const std::filesystem::path& folder_;
};

}  // namespace

std::string_view to_string(EventKind kind) { return kKinds.begin()[static_cast<std::size_t>(kind)]; }

std::vector<ScenarioEvent> read_events(TomlReader& root, const std::vector<PeerSettings>& peers, double duration_s,
                                       const std::filesystem::path& folder) {
  return EventReader(root, peers, duration_s, folder).all();
}

bool starts_with(const std::vector<ScenarioEvent>& events, std::string_view peer) {
  const auto first =
      std::ranges::find_if(events, [&](const ScenarioEvent& e) { return joins_or_leaves(e.kind) && e.peer == peer; });
  return first == events.end() || first->kind != EventKind::kJoin;
}

void give_to_peers(const std::vector<ScenarioEvent>& events, std::vector<PeerSettings>& peers) {
  for (const ScenarioEvent& e : events) {
    if (e.kind != EventKind::kKey && e.kind != EventKind::kEdit) continue;
    PeerSettings& peer = *std::ranges::find(peers, e.peer, &PeerSettings::name);
    if (e.kind == EventKind::kEdit) peer.edits.push_back({e.at_s, e.edit});  // they come by time
    if (e.kind == EventKind::kKey) peer.keys.push_back({e.at_s, e.key});
    std::ranges::stable_sort(peer.keys, {}, &ScriptedKey::at_s);
  }
}

bool peers_change(const std::vector<ScenarioEvent>& events) {
  return std::ranges::any_of(events, [](const ScenarioEvent& e) { return joins_or_leaves(e.kind); });
}

}  // namespace peerd::config
