#include "peerd/config/scenario.hpp"

#include <algorithm>
#include <set>
#include <sstream>

namespace peerd::config {
namespace {

constexpr double kLatencyMax_ms = 60'000.0;
constexpr std::size_t kRunsMax = 100'000;

LinkSettings read_link(TomlReader& reader, LinkSettings link) {
  reader.read("latency_ms", link.latency_ms, 0.0, kLatencyMax_ms);
  reader.read("jitter_ms", link.jitter_ms, 0.0, kLatencyMax_ms);
  reader.read("loss", link.loss, 0.0, 1.0);
  reader.read("duplication", link.duplication, 0.0, 1.0);
  reader.read("reordering", link.reordering, 0.0, 1.0);
  return link;
}

void read_network(TomlReader reader, RunSettings& run) {
  run.network = read_link(reader, {});
  const toml::table* links = reader.table("link");
  if (links != nullptr) {
    for (const auto& [from, targets] : *links) {
      if (!targets.is_table()) {
        reader.fail(&targets, "write network.link.FROM.TO as a table of link settings");
        continue;
      }
      for (const auto& [to, value] : *targets.as_table()) {
        const std::string key = reader.dotted("link." + std::string(from.str()) + "." + std::string(to.str()));
        if (!value.is_table()) {
          reader.fail(&value, key + " must be a table of link settings");
          continue;
        }
        for (std::string_view peer : {from.str(), to.str()}) {
          const bool known = std::ranges::any_of(run.peers, [&](const PeerSettings& p) { return p.name == peer; });
          if (!known) reader.fail(&value, key + ": the scenario has no peer \"" + std::string(peer) + "\"");
        }
        TomlReader sub(*value.as_table(), key, reader.error());
        run.links[{std::string(from.str()), std::string(to.str())}] = read_link(sub, run.network);
        sub.finish();
      }
    }
  }
  reader.finish();
}

const toml::table& table_or_empty(TomlReader& reader, std::string_view key) {
  static const toml::table empty;
  const toml::table* table = reader.table(key);
  return table != nullptr ? *table : empty;
}

void read_peers(TomlReader& root, RunSettings& run, const std::filesystem::path& folder) {
  root.require("peer");
  for (const auto& [name, value] : table_or_empty(root, "peer")) {
    const std::string key = "peer." + std::string(name.str());
    if (!value.is_table()) {
      root.fail(&value, key + " must be a table");
      continue;
    }
    run.peers.push_back(read_peer(TomlReader(*value.as_table(), key, root.error()), std::string(name.str()), folder));
    const PeerSettings& peer = run.peers.back();
    for (const PeerSettings& other : run.peers) {
      if (&other == &peer) break;
      if (other.id == peer.id) root.fail(&value, key + ".id: peer " + other.name + " has that id too");
    }
  }
  std::ranges::sort(run.peers, {}, &PeerSettings::id);
}

Result<RunSettings> read_run(const toml::table& root, Scenario& scenario, const std::filesystem::path& file) {
  std::optional<InputError> error;
  TomlReader reader(root, "", error);
  RunSettings run;
  reader.require("world");
  std::string world;
  reader.read("name", scenario.name);
  if (scenario.name.empty() || scenario.name.starts_with('.') || scenario.name.find('/') != std::string::npos) {
    reader.fail(root.get("name"), "name: it becomes a folder's name, so no slash and no dot in front");
  }
  reader.read("world", world);
  scenario.world = file.parent_path() / world;
  std::size_t inlines = 0;
  reader.read_word("inlines", inlines, {"at-once", "when-needed"});
  scenario.inlines_when_needed = inlines == 1;
  reader.read("duration_s", run.duration_s, 0.1, 1e6);
  reader.read("seed", run.seed);
  reader.read("sample_hz", run.sample_hz, 1, 1000);
  run.replication = read_replication(TomlReader(table_or_empty(reader, "replication"), "replication", error));
  read_peers(reader, run, file.parent_path());
  run.motion = read_motions(reader, file.parent_path());
  TomlReader decisions(table_or_empty(reader, "decisions"), "decisions", error);
  run.replication.decisions = read_decisions(decisions, run.peers);
  decisions.read("compare", run.compare_outcomes);
  decisions.finish();
  run.replication.relay = read_relay(TomlReader(table_or_empty(reader, "relay"), "relay", error), run.peers);
  run.replication.regions = read_regions(TomlReader(table_or_empty(reader, "regions"), "regions", error));
  if (run.replication.regions.cell_m > 0.0 && run.replication.relay.through != replication::kNobody) {
    reader.fail(root.get("regions"), "regions: a relay passes all states on to everybody; leave out one of the two");
  }
  read_network(TomlReader(table_or_empty(reader, "network"), "network", error), run);
  run.control = read_control(TomlReader(table_or_empty(reader, "control"), "control", error));
  if (run.control.socket && !run.control.socket->empty()) {
    run.control.socket = (file.parent_path() / *run.control.socket).string();
  }
  run.transport = read_transport(TomlReader(table_or_empty(reader, "transport"), "transport", error));
  reader.finish();
  if (error) return std::unexpected(*error);
  return run;
}

nlohmann::ordered_json to_json(const toml::node& node) {
  if (const auto* x = node.as_integer()) return x->get();
  if (const auto* x = node.as_floating_point()) return x->get();
  if (const auto* x = node.as_boolean()) return x->get();
  if (const auto* x = node.as_string()) return x->get();
  if (const auto* list = node.as_array()) {
    auto items = nlohmann::ordered_json::array();
    for (const toml::node& item : *list) items.push_back(to_json(item));
    return items;
  }
  if (const auto* table = node.as_table()) {
    auto items = nlohmann::ordered_json::object();
    for (const auto& [key, item] : *table) items[std::string(key.str())] = to_json(item);
    return items;
  }
  std::ostringstream text;
  node.visit([&](const auto& concrete) { text << toml::table{{"value", concrete}}; });
  return text.str();
}

std::string to_text(const toml::table& root) {
  std::ostringstream text;
  text << root << '\n';
  return text.str();
}

// Keys whose one value is a list: setting them does not sweep.
bool takes_list(std::string_view key) {
  return key.ends_with(".enslaves") || key.ends_with(".axis") || key.ends_with(".define") || key.ends_with(".key") ||
         key == "replication.models" || key == "transport.peers" || key.ends_with(".position") ||
         key.ends_with(".offset") || key.ends_with(".spin_axis") || key.ends_with(".waypoints") ||
         key.ends_with(".within_m") || key.ends_with(".origin_m") || key == "regions.counts" ||
         key.ends_with(".physics.velocity") || key.ends_with(".physics.acceleration");
}

struct SweptKey {
  std::string key;
  std::vector<const toml::node*> values;
};

// All that a request brings together.
struct Sources {
  std::string text;
  std::vector<toml::table> overlays;
  std::vector<Assignment> sets, swept_sets;
};

Result<Sources> read_sources(const ScenarioRequest& request) {
  Sources sources;
  if (request.text) {
    sources.text = *request.text;
  } else if (!request.file.empty()) {
    auto text = read_text_file(request.file);
    if (!text) return std::unexpected(text.error());
    sources.text = std::move(*text);
  }
  for (const auto& path : request.configs) {
    auto overlay = read_toml(path);
    if (!overlay) return std::unexpected(overlay.error());
    sources.overlays.push_back(std::move(*overlay));
  }
  for (const std::string& given : request.sets) {
    auto set = parse_assignment(given);
    if (!set) return std::unexpected(set.error());
    const bool sweeps = set->holder.get("value")->is_array() && !takes_list(set->key);
    if (sweeps && !request.sweep) {
      return std::unexpected(InputError{"error: --set " + given + ": a list sweeps, and one peer runs one value"});
    }
    (sweeps ? sources.swept_sets : sources.sets).push_back(std::move(*set));
  }
  return sources;
}

// The scenario with what its request lays over it. Read anew for each run: toml++ copies lose their line numbers.
Result<toml::table> read_root(const ScenarioRequest& request, const Sources& sources) {
  auto root = parse_toml(sources.text, request.file.string());
  if (!root) return root;
  for (const toml::table& overlay : sources.overlays) merge(*root, overlay);
  for (const Assignment& set : sources.sets) {
    if (auto done = assign(*root, set.key, *set.holder.get("value")); !done) return std::unexpected(done.error());
  }
  if (request.seed) root->insert_or_assign("seed", static_cast<std::int64_t>(*request.seed));
  return root;
}

// The lists to sweep over: the scenario's, with those of --set in their places and without the keys that --set fixes.
Result<toml::table> read_sweep(const ScenarioRequest& request, const Sources& sources, const toml::table& root) {
  toml::table sweep;
  if (const toml::node* given = root.get("sweep"); given != nullptr && request.sweep) {
    if (!given->is_table()) {
      return std::unexpected(InputError{request.file.string() + ": error: sweep must be a table of lists"});
    }
    sweep = *given->as_table();
  }
  for (const Assignment& set : sources.swept_sets) {
    sweep.insert_or_assign(set.key, *set.holder.get("value")->as_array());
  }
  for (const Assignment& set : sources.sets) sweep.erase(set.key);
  return sweep;
}

Result<std::vector<SweptKey>> swept_keys(const ScenarioRequest& request, const toml::table& sweep) {
  std::vector<SweptKey> swept;
  for (const auto& [key, value] : sweep) {
    if (request.real && key.str().starts_with("network.")) continue;
    SweptKey& s = swept.emplace_back(std::string(key.str()), std::vector<const toml::node*>{});
    const toml::array* values = value.as_array();
    if (values == nullptr || values->empty()) {
      return std::unexpected(InputError{request.file.string() + ": error: sweep: \"" + s.key +
                                        "\" must be a list of at least one value; a key with dots stands in quotes"});
    }
    for (const toml::node& v : *values) s.values.push_back(&v);
  }
  return swept;
}

}  // namespace

const LinkSettings& link(const RunSettings& run, const std::string& from, const std::string& to) {
  const auto at = run.links.find({from, to});
  return at == run.links.end() ? run.network : at->second;
}

Result<Scenario> read_scenario(const ScenarioRequest& request) {
  const auto sources = read_sources(request);
  if (!sources) return std::unexpected(sources.error());
  const auto base = read_root(request, *sources);
  if (!base) return std::unexpected(base.error());
  const auto sweep = read_sweep(request, *sources, *base);
  if (!sweep) return std::unexpected(sweep.error());
  const auto swept = swept_keys(request, *sweep);
  if (!swept) return std::unexpected(swept.error());

  std::size_t runs = 1;
  std::set<std::string> named{"replication.approach", "replication.order"};  // params that are not swept
  if (!request.real) named.insert("network.latency_ms");
  for (const Assignment& set : sources->sets) named.insert(set.key);
  for (const SweptKey& s : *swept) {
    runs *= s.values.size();
    named.erase(s.key);
    if (runs > kRunsMax) {
      return std::unexpected(InputError{"error: the sweep has more than " + std::to_string(kRunsMax) + " runs"});
    }
  }

  Scenario scenario;
  scenario.name = request.file.empty() ? "peerd" : request.file.stem().string();
  for (std::size_t i = 0; i < runs; ++i) {
    auto root = read_root(request, *sources);
    if (!root) return std::unexpected(root.error());
    root->erase("sweep");
    nlohmann::ordered_json params = nlohmann::ordered_json::object();
    std::size_t rest = i, below = runs;
    for (const SweptKey& s : *swept) {  // the last key varies fastest
      below /= s.values.size();
      const toml::node& value = *s.values[rest / below];
      rest %= below;
      if (auto done = assign(*root, s.key, value); !done) return std::unexpected(done.error());
      params[s.key] = to_json(value);
    }
    for (const std::string& key : named) {
      if (const auto value = root->at_path(key)) params[key] = to_json(*value.node());
    }
    auto run = read_run(*root, scenario, request.file);
    if (!run) return std::unexpected(run.error());
    run->params = std::move(params);
    run->toml = to_text(*root);
    scenario.runs.push_back(std::move(*run));
  }
  scenario.seed = scenario.runs.front().seed;
  return scenario;
}

}  // namespace peerd::config
