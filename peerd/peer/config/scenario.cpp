#include "peerd/peer/config/scenario.hpp"

#include <algorithm>
#include <set>

#include "peerd/input/path_text.hpp"
#include "peerd/input/printable.hpp"
#include "peerd/input/text_file.hpp"
#include "peerd/input/toml_json.hpp"
#include "peerd/peer/config/node_pattern.hpp"
#include "peerd/peer/config/renamed_keys.hpp"
#include "peerd/peer/config/without_effect.hpp"

namespace peerd::config {
namespace {

constexpr double kDurationMax_s = 1e6;
constexpr std::size_t kRunsMax = 100'000;

LinkSettings read_link(TomlReader& reader, LinkSettings link) {
  change_link(link, read_link_change(reader));
  if (link.loss_burst > 0.0 && (link.loss_burst < 1.0 || link.loss > link.loss_burst / (link.loss_burst + 1.0))) {
    reader.fail(reader.raw().get("loss_burst"),
                reader.dotted("loss_burst") +
                    ": a run is 1 datagram or more, and between two runs one arrives: no more "
                    "than loss_burst / (loss_burst + 1) of all can be lost");
  }
  return link;
}

void read_islands(TomlReader& reader, RunSettings& run) {
  const std::vector<const toml::table*> tables = reader.tables("island");
  for (std::size_t i = 0; i < tables.size(); ++i) {
    const std::string key = reader.dotted("island." + std::to_string(i));
    TomlReader sub(*tables[i], key, reader.error());
    std::vector<std::string> patterns;
    sub.require("peers");
    sub.read("peers", patterns);
    run.islands.push_back(read_link(sub, run.network));
    for (const std::string& pattern : patterns) {
      bool matches_any = false;
      for (const PeerSettings& peer : run.peers) {
        if (!matches(pattern, peer.name)) continue;
        matches_any = true;
        const std::size_t island = run.island_of.try_emplace(peer.name, i).first->second;
        if (island == i) continue;
        sub.fail(tables[i]->get("peers"), key + ".peers: peer \"" + peer.name + "\" is on another island, too");
      }
      if (matches_any) continue;
      sub.fail(tables[i]->get("peers"), key + ".peers: the scenario has no peer \"" + pattern + "\"");
    }
    sub.finish();
  }
}

void read_network(TomlReader reader, RunSettings& run) {
  run.network = read_link(reader, {});
  std::size_t via = 0;
  reader.read_word("via", via, {"nothing", "nats", "nats-cluster", "relay"});
  run.via = static_cast<Via>(via);
  read_islands(reader, run);
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
        const std::string sender(from.str()), receiver(to.str());
        run.links[{sender, receiver}] = read_link(sub, link(run, sender, receiver));
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

bool is_world_name(const std::string& name) {
  constexpr std::size_t kWorldNameMax_bytes = 63;
  return !name.empty() && name.size() <= kWorldNameMax_bytes && is_printable(name);
}

Result<RunSettings> read_run(const toml::table& root, Scenario& scenario, const ScenarioRequest& request) {
  const std::filesystem::path& file = request.file;
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
  scenario.world = file.parent_path() / path_of_text(world);
  std::size_t inlines = 0;
  reader.read_word("inlines", inlines, {"at-once", "when-needed"});
  scenario.reading.inlines_when_needed = inlines == 1;
  reader.read("expansion", scenario.reading.expansion, 1, kExpansionMax);
  reader.read("lenient", scenario.reading.lenient);
  reader.read("collide", scenario.reading.collide);
  reader.read("unit", scenario.reading.unit);
  reader.read("up", scenario.reading.up);
  reader.read("world_name", scenario.reading.name);
  if (reader.has("world_name") && !is_world_name(scenario.reading.name)) {
    reader.fail(root.get("world_name"), "world_name: it has 1 to 63 bytes, none of them a control character");
  }
  reader.read("duration_s", run.duration_s, 0.1, kDurationMax_s);
  reader.read("seed", run.seed);
  reader.read("repeat", scenario.repeat, 1, kRepeatMax);
  if (scenario.repeat - 1 > static_cast<std::uint64_t>(kSeedMax) - run.seed) {
    reader.fail(root.get("seed"), "seed: with repeat, the last of the seeds would be above 2^63 - 1");
  }
  reader.read("sample_hz", run.sample_hz, 1, 1000);
  run.replication = read_replication(TomlReader(table_or_empty(reader, "replication"), "replication", error));
  read_peers(reader, run, file.parent_path());
  run.motion = read_motions(reader, file.parent_path());
  TomlReader decisions(table_or_empty(reader, "decisions"), "decisions", error);
  run.replication.decisions = read_decisions(decisions, run.peers);
  decisions.read("compare", run.compare_outcomes);
  decisions.finish();
  run.replication.relay = read_relay(TomlReader(table_or_empty(reader, "relay"), "relay", error), run.peers);
  run.replication.collision = read_collision(TomlReader(table_or_empty(reader, "collision"), "collision", error));
  run.replication.regions = read_regions(TomlReader(table_or_empty(reader, "regions"), "regions", error));
  const replication::RelaySettings& relay = run.replication.relay;
  if (run.replication.bounded_latency.is_on() && relay.restamps && relay.through != kNobody) {
    reader.fail(
        find(root, "relay.restamps"),
        "relay.restamps: with a bounded latency updates count from their owners' stamps; leave out one of the two");
  }
  if (run.replication.regions.cell_m > 0.0 && run.replication.relay.through != kNobody) {
    reader.fail(root.get("regions"), "regions: a relay passes all states on to everybody; leave out one of the two");
  }
  run.baseline = read_baseline(TomlReader(table_or_empty(reader, "baseline"), "baseline", error));
  if (request.real && run.baseline.system != BaselineSystem::kNone) {
    reader.fail(root.get("baseline"), "baseline.system: other systems run in the simulator alone: peerd sim");
  }
  read_network(TomlReader(table_or_empty(reader, "network"), "network", error), run);
  run.control = read_control(TomlReader(table_or_empty(reader, "control"), "control", error));
  if (run.control.socket && !run.control.socket->empty()) {
    run.control.socket = (file.parent_path() / *run.control.socket).string();
  }
  run.log = read_log(TomlReader(table_or_empty(reader, "log"), "log", error));
  run.gateway = read_gateway(TomlReader(table_or_empty(reader, "gateway"), "gateway", error));
  run.transport = read_transport(TomlReader(table_or_empty(reader, "transport"), "transport", error));
  run.events = read_events(reader, run.peers, run.duration_s, file.parent_path());
  const bool as_it_stands = request.configs.empty() && request.sets.empty();
  scenario.expectations = read_expectations(reader, run.peers, as_it_stands ? run.duration_s : kDurationMax_s);
  reader.finish();
  if (error) return std::unexpected(*error);
  give_to_peers(run.events, run.peers);
  return run;
}

// Captures have this text, so it holds no user and no password of a NATS server.
std::string to_text(toml::table root) {
  if (toml::array* const servers = root.at_path("transport.nats").as_array()) {
    servers->for_each([](toml::value<std::string>& server) {
      if (const auto url = net::parse_server_url(*server)) *server = url->shown();
    });
  }
  std::ostringstream text;
  text << root << '\n';
  return text.str();
}

// Such a key has a list as its one value, so that setting it to a list does not sweep.
bool takes_list(std::string_view key) {
  return key.ends_with(".owns") || key.ends_with(".axis") || key.ends_with(".define") || key.ends_with(".key") ||
         key == "network.island" || (key.starts_with("network.island.") && key.ends_with(".peers")) ||
         key == "replication.models" || key == "transport.peers" || key == "transport.relays" ||
         key == "transport.nats" || key == "gateway.origins" || key.ends_with(".position") ||
         key.ends_with(".offset") || key.ends_with(".spin_axis") || key.ends_with(".waypoints") ||
         key.ends_with(".within_m") || key.ends_with(".origin_m") || key == "regions.counts" ||
         key.ends_with(".groups") || key.ends_with(".physics.velocity") || key.ends_with(".physics.acceleration") ||
         key.ends_with(".physics.angular_velocity");
}

struct SweptKey {
  std::string key;
  std::vector<const toml::node*> values;
};

// All sources of a request's settings, parsed.
struct Sources {
  std::string text;
  std::vector<toml::table> overlays;
  std::vector<Assignment> sets, swept_sets;
  std::vector<std::string> warnings;  // about the overlays and sets
};

Result<Sources> read_sources(const ScenarioRequest& request) {
  Sources sources;
  if (request.text) {
    sources.text = *request.text;
  } else if (!request.file.empty()) {
    auto text = read_text_file(request.file, kSettingsFile);
    if (!text) return std::unexpected(text.error());
    sources.text = std::move(*text);
  }
  for (const auto& path : request.configs) {
    auto overlay = read_toml(path);
    if (!overlay) return std::unexpected(overlay.error());
    if (auto done = rename_old_keys(*overlay, sources.warnings); !done) return std::unexpected(done.error());
    sources.overlays.push_back(std::move(*overlay));
  }
  for (const std::string& given : request.sets) {
    auto set = parse_assignment(given);
    if (!set) return std::unexpected(set.error());
    if (auto done = rename_old_keys(*set, sources.warnings); !done) return std::unexpected(done.error());
    const bool sweeps = set->holder.get("value")->is_array() && !takes_list(set->key);
    if (sweeps && !request.sweep) {
      return std::unexpected(InputError{"error: --set " + given + ": a list sweeps, and one peer runs one value"});
    }
    (sweeps ? sources.swept_sets : sources.sets).push_back(std::move(*set));
  }
  return sources;
}

// Parses the scenario's text and lays the request's settings over it; adds a warning for each old name in the text. It
// is done anew for each run, because copies of toml++'s tables lose their line numbers.
Result<toml::table> read_root(const ScenarioRequest& request, const Sources& sources,
                              std::vector<std::string>& warnings) {
  auto root = parse_toml(sources.text, request.file.string());
  if (!root) return root;
  if (auto done = rename_old_keys(*root, warnings); !done) return std::unexpected(done.error());
  for (const toml::table& overlay : sources.overlays) merge(*root, overlay);
  for (const Assignment& set : sources.sets) {
    if (auto done = assign(*root, set.key, *set.holder.get("value")); !done) return std::unexpected(done.error());
  }
  if (request.seed) root->insert_or_assign("seed", static_cast<std::int64_t>(*request.seed));
  if (request.repeat) root->insert_or_assign("repeat", static_cast<std::int64_t>(*request.repeat));
  return root;
}

// The sources one by one. The text has been read without an error before.
GivenSettings given_settings(const ScenarioRequest& request, const Sources& sources) {
  GivenSettings given;
  std::vector<std::string> known_warnings;
  if (auto file = parse_toml(sources.text, request.file.string()); file && rename_old_keys(*file, known_warnings)) {
    given.file = std::move(*file);
  }
  given.file_is_provided = request.text.has_value();
  given.overlays = sources.overlays;
  for (const auto* assignments : {&sources.sets, &sources.swept_sets}) {
    for (const Assignment& a : *assignments) (void)assign(given.set, a.key, *a.holder.get("value"));
  }
  given.whole_sweep = request.sweep && !request.real;  // real runs leave out what the network sweeps
  return given;
}

// The lists to sweep over: those of the scenario, replaced by those of --set, without the keys that --set fixes.
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

// The reason why all runs have one value of that key. It is empty where the key may be swept.
std::string why_not_swept(std::string_view key) {
  if (key == "world" || key == "inlines" || key == "lenient" || key == "collide" || key == "unit" || key == "up" ||
      key == "name")
    return "all runs of a sweep share it";
  if (key == "repeat") return "every combination is repeated as often";
  if (key.starts_with("expect.")) return "an expectation says by `where` which runs it is about";
  return "";
}

Result<std::vector<SweptKey>> swept_keys(const ScenarioRequest& request, const toml::table& sweep) {
  std::vector<SweptKey> swept;
  for (const auto& [key, value] : sweep) {
    if (request.real && key.str().starts_with("network.")) continue;
    SweptKey& s = swept.emplace_back(std::string(key.str()), std::vector<const toml::node*>{});
    if (const std::string why = why_not_swept(key.str()); !why.empty()) {
      return std::unexpected(InputError{request.file.string() + ": error: sweep: \"" + s.key + "\": " + why});
    }
    const toml::array* values = value.as_array();
    if (values == nullptr || values->empty()) {
      return std::unexpected(InputError{request.file.string() + ": error: sweep: \"" + s.key +
                                        "\" must be a list of at least one value; a key with dots stands in quotes"});
    }
    for (const toml::node& v : *values) s.values.push_back(&v);
  }
  return swept;
}

// One combination of the sweep: its whole configuration, and the part of it that is listed among the run's parameters.
struct Point {
  toml::table root;
  nlohmann::ordered_json params = nlohmann::ordered_json::object();
};

// `named` are the keys that are listed as parameters without being swept.
Result<Point> read_point(const ScenarioRequest& request, const Sources& sources, const std::vector<SweptKey>& swept,
                         const std::set<std::string>& named, std::size_t number, std::size_t points) {
  std::vector<std::string> known_warnings;
  auto root = read_root(request, sources, known_warnings);
  if (!root) return std::unexpected(root.error());
  root->erase("sweep");
  Point point{std::move(*root)};
  std::size_t rest = number, below = points;
  for (const SweptKey& s : swept) {  // the last key varies fastest
    below /= s.values.size();
    const toml::node& value = *s.values[rest / below];
    rest %= below;
    if (auto done = assign(point.root, s.key, value); !done) return std::unexpected(done.error());
    point.params[s.key] = to_json(value);
  }
  for (const std::string& key : named) {
    if (const toml::node* value = find(point.root, key)) point.params[key] = to_json(*value);
  }
  return point;
}

// Adds the runs of this point to each expectation that selects them.
void pick_runs(const ScenarioRequest& request, const toml::table& root, std::size_t first_run, std::uint32_t repeat,
               double duration_s, std::vector<Expectation>& expectations) {
  for (Expectation& e : expectations) {
    const bool about_simulated_network =
        std::ranges::any_of(e.where.items(), [](const auto& key) { return key.key().starts_with("network."); });
    const bool is_over_before = std::max(e.from_s, e.until_s.value_or(0.0)) > duration_s;
    if (!picks(e, root) || is_over_before || (request.real && about_simulated_network)) continue;
    for (std::uint32_t k = 0; k < repeat; ++k) e.runs.push_back(first_run + k);
  }
}

// An expectation of the file itself that selects no run is a mistake. Settings that are laid over the file may leave it
// without runs; the report then says that it was not checked.
std::optional<InputError> without_runs(const ScenarioRequest& request, const std::vector<Expectation>& expectations,
                                       const toml::table& root) {
  if (request.real || !request.sweep || !request.configs.empty() || !request.sets.empty()) return std::nullopt;
  for (const Expectation& e : expectations) {
    if (!e.runs.empty()) continue;
    const std::vector<std::string> unknown = keys_not_set(e, root);
    return InputError{e.place + "error: expect." + e.name + ".where: " +
                      (unknown.empty() ? "no run has these values" : "the scenario does not set " + unknown.front())};
  }
  return std::nullopt;
}

}  // namespace

nlohmann::ordered_json network_settings(const RunSettings& run) {
  nlohmann::ordered_json settings = nlohmann::ordered_json::object();
  const auto add = [&](const std::string& table, const LinkSettings& link, const LinkSettings& usual) {
    for (const LinkKey& key : kLinkKeys) {
      if (link.*key.value != usual.*key.value) settings[table + std::string(key.name)] = link.*key.value;
    }
  };
  add("network.", run.network, {});
  for (std::size_t i = 0; i < run.islands.size(); ++i) {
    add("network.island." + std::to_string(i) + ".", run.islands[i], run.network);
  }
  for (const auto& [ends, link] : run.links) {
    add("network.link." + ends.first + "." + ends.second + ".", link, run.network);
  }
  return settings;
}

Result<Scenario> read_scenario(const ScenarioRequest& request) {
  const auto sources = read_sources(request);
  if (!sources) return std::unexpected(sources.error());
  std::vector<std::string> warnings;
  const auto base = read_root(request, *sources, warnings);
  if (!base) return std::unexpected(base.error());
  const auto sweep = read_sweep(request, *sources, *base);
  if (!sweep) return std::unexpected(sweep.error());
  const auto swept = swept_keys(request, *sweep);
  if (!swept) return std::unexpected(swept.error());

  std::size_t points = 1;
  std::set<std::string> named{"replication.approach", "replication.order"};  // listed as parameters without being swept
  if (!request.real) named.insert("network.latency_ms");
  for (const Assignment& set : sources->sets) named.insert(set.key);
  for (const SweptKey& s : *swept) {
    points *= s.values.size();
    named.erase(s.key);
    if (points > kRunsMax) {
      return std::unexpected(InputError{"error: the sweep has more than " + std::to_string(kRunsMax) + " runs"});
    }
  }

  Scenario scenario;
  scenario.warnings = std::move(warnings);
  scenario.warnings.insert(scenario.warnings.end(), sources->warnings.begin(), sources->warnings.end());
  scenario.name = request.file.empty() ? "peerd" : request.file.stem().string();
  std::vector<Expectation> expectations;
  for (std::size_t i = 0; i < points; ++i) {
    auto point = read_point(request, *sources, *swept, named, i, points);
    if (!point) return std::unexpected(point.error());
    auto run = read_run(point->root, scenario, request);
    if (!run) return std::unexpected(run.error());
    if (!request.sweep) scenario.repeat = 1;
    if (i == 0) {
      if (points * scenario.repeat > kRunsMax) {
        return std::unexpected(
            InputError{"error: sweep and repeat make more than " + std::to_string(kRunsMax) + " runs"});
      }
      if (scenario.repeat > 1 && point->params.contains("seed") && sweep->contains("seed")) {
        return std::unexpected(InputError{request.file.string() + ": error: sweep: seeds are repeat's already"});
      }
      expectations = std::move(scenario.expectations);
    }
    pick_runs(request, point->root, scenario.runs.size(), scenario.repeat, run->duration_s, expectations);
    point->root.erase("expect");  // expectations concern all runs; a peer or a capture of one run has no use for them
    run->params = std::move(point->params);
    const std::uint64_t first_seed = run->seed;
    for (std::uint32_t k = 0; k < scenario.repeat; ++k) {
      run->seed = first_seed + k;
      point->root.insert_or_assign("seed", static_cast<std::int64_t>(run->seed));
      run->toml = to_text(point->root);
      scenario.runs.push_back(*run);
    }
    if (i + 1 < points) continue;
    if (const auto error = without_runs(request, expectations, point->root)) return std::unexpected(*error);
  }
  for (std::string& warning : keys_without_effect(given_settings(request, *sources), scenario.runs)) {
    scenario.warnings.push_back(std::move(warning));
  }
  scenario.expectations = std::move(expectations);
  scenario.seed = scenario.runs.front().seed;
  return scenario;
}

const LinkSettings& link(const RunSettings& run, const std::string& from, const std::string& to) {
  if (const auto at = run.links.find({from, to}); at != run.links.end()) return at->second;
  const auto of_sender = run.island_of.find(from), of_receiver = run.island_of.find(to);
  const bool is_within = of_sender != run.island_of.end() && of_receiver != run.island_of.end() &&
                         of_sender->second == of_receiver->second;
  return is_within ? run.islands[of_sender->second] : run.network;
}

std::vector<LinkSettings> links_of(const RunSettings& run) {
  std::vector<LinkSettings> links{run.network};
  links.insert(links.end(), run.islands.begin(), run.islands.end());
  for (const auto& [ends, link] : run.links) links.push_back(link);
  return links;
}

double longest_delay_s(const RunSettings& run) {
  std::vector<LinkSettings> links = links_of(run);
  double most_ms = 0.0;
  const auto look = [&] {
    for (const LinkSettings& link : links) most_ms = std::max(most_ms, link.longest_delay_ms());
  };
  look();
  for (const ScenarioEvent& e : run.events) {
    for (LinkSettings& link : links) change_link(link, e.change);
    look();
  }
  return most_ms * 1e-3;
}

}  // namespace peerd::config
