#include "peerd/peer/config/expectations.hpp"

#include <algorithm>
#include <limits>

#include "peerd/input/toml_json.hpp"
#include "peerd/peer/config/measures.hpp"

namespace peerd::config {
namespace {

using Json = nlohmann::ordered_json;

void read_measure(TomlReader& reader, Expectation& e) {
  reader.require("that");
  reader.read("that", e.that);
  if (!reader.has("that") || config::find_measure(e.that)) return;
  std::vector<std::string> names;
  for (const config::Measure& m : config::measures()) names.emplace_back(m.name);
  const auto meant = did_you_mean(e.that, names);
  reader.fail(reader.raw().get("that"), reader.dotted("that") + ": a report has no \"" + e.that + "\"" +
                                            (meant ? "; did you mean \"" + *meant + "\"?" : ""));
}

void read_limits(TomlReader& reader, Expectation& e) {
  constexpr double kAny = std::numeric_limits<double>::max();
  const bool yes_or_no = config::find_measure(e.that).value_or(config::Measure{}).yes_or_no;
  if (yes_or_no) {
    bool equals = false;
    reader.require("equals");
    reader.read("equals", equals);
    e.equals = equals;
    return;  // finish() refuses the other two
  }
  reader.read("at_least", e.at_least, -kAny, kAny);
  reader.read("at_most", e.at_most, -kAny, kAny);
  std::optional<double> equals;
  reader.read("equals", equals, -kAny, kAny);
  if (equals) e.equals = *equals;
  if (!e.at_least && !e.at_most && !e.equals) {
    reader.fail(nullptr, reader.dotted("that") + ": give a limit: at_most, at_least or equals");
  } else if (e.equals && (e.at_least || e.at_most)) {
    reader.fail(reader.raw().get("equals"), reader.dotted("equals") + " leaves nothing to at_least and at_most");
  } else if (e.at_least && e.at_most && *e.at_least > *e.at_most) {
    reader.fail(reader.raw().get("at_least"), reader.dotted("at_least") + " is above at_most: nothing can hold");
  }
}

void read_views(TomlReader& reader, Expectation& e, const std::vector<PeerSettings>& peers) {
  reader.read("object", e.object);
  reader.read("observer", e.observer);
  const bool of_view = config::find_measure(e.that).value_or(config::Measure{}).of_view;
  for (const char* key : {"object", "observer"}) {
    if (of_view || !reader.has(key)) continue;
    reader.fail(reader.raw().get(key), reader.dotted(key) + ": " + e.that + " is the whole run's");
  }
  std::vector<std::string> names;
  for (const PeerSettings& p : peers) names.push_back(p.name);
  if (reader.has("observer") && std::ranges::find(names, e.observer) == names.end()) {
    const auto meant = did_you_mean(e.observer, names);
    reader.fail(reader.raw().get("observer"), reader.dotted("observer") + ": the scenario has no peer \"" + e.observer +
                                                  "\"" + (meant ? "; did you mean \"" + *meant + "\"?" : ""));
  }
}

void read_window(TomlReader& reader, Expectation& e, double latest_s) {
  reader.read("from_s", e.from_s, 0.0, latest_s);
  reader.read("until_s", e.until_s, 0.0, latest_s);
  if (e.until_s && *e.until_s <= e.from_s) {
    reader.fail(reader.raw().get("until_s"), reader.dotted("until_s") + " must be after from_s");
  }
  const bool window = config::find_measure(e.that).value_or(config::Measure{}).window;
  for (const char* key : {"from_s", "until_s"}) {
    if (window || !reader.has(key)) continue;
    reader.fail(reader.raw().get(key), reader.dotted(key) + ": " + e.that + " is known of the whole run only");
  }
}

Expectation read_expectation(TomlReader reader, const std::string& name, const std::vector<PeerSettings>& peers,
                             double latest_s) {
  Expectation e;
  e.name = name;
  e.place = reader.place(nullptr);
  read_measure(reader, e);
  read_limits(reader, e);
  read_views(reader, e, peers);
  read_window(reader, e, latest_s);
  e.where = Json::object();
  if (const toml::table* where = reader.table("where")) {
    for (const auto& [key, value] : *where) {
      Json values = to_json(value);
      e.where[std::string(key.str())] = values.is_array() ? values : Json::array({values});
    }
  }
  std::size_t mode = 0;
  reader.read_word("mode", mode, {"both", "sim", "real"});
  if (mode > 0) e.mode = mode == 1 ? "sim" : "real";
  reader.finish();
  return e;
}

}  // namespace

std::vector<Expectation> read_expectations(TomlReader& root, const std::vector<PeerSettings>& peers, double latest_s) {
  const toml::table* tables = root.table("expect");
  if (tables == nullptr) return {};
  std::vector<Expectation> all;
  for (const auto& [name, value] : *tables) {
    const std::string key = "expect." + std::string(name.str());
    if (!value.is_table()) {
      root.fail(&value, key + " must be a table: that, a limit and where it holds");
      continue;
    }
    all.push_back(
        read_expectation(TomlReader(*value.as_table(), key, root.error()), std::string(name.str()), peers, latest_s));
  }
  return all;
}

bool picks(const Expectation& e, const toml::table& root) {
  return std::ranges::all_of(e.where.items(), [&](const auto& key) {
    const toml::node* value = find(root, key.key());
    return value != nullptr && std::ranges::find(key.value(), to_json(*value)) != key.value().end();
  });
}

std::vector<std::string> keys_not_set(const Expectation& e, const toml::table& root) {
  std::vector<std::string> keys;
  for (const auto& [key, values] : e.where.items()) {
    if (find(root, key) == nullptr) keys.push_back(key);
  }
  return keys;
}

}  // namespace peerd::config
