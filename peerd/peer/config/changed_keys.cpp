#include "peerd/peer/config/changed_keys.hpp"

#include <map>

#include <toml++/toml.h>
#include <nlohmann/json.hpp>

#include "peerd/input/toml_json.hpp"

namespace peerd::config {
namespace {

using Values = std::map<std::string, nlohmann::ordered_json>;

void collect(const toml::table& table, const std::string& prefix, Values& values) {
  for (const auto& [key, value] : table) {
    const std::string name = prefix + std::string(key.str());
    if (const toml::table* const below = value.as_table()) {
      collect(*below, name + ".", values);
    } else {
      values.emplace(name, to_json(value));
    }
  }
}

}  // namespace

std::vector<std::string> changed_keys(const std::string& before, const std::string& after) {
  Values old, now;
  collect(toml::parse(before), "", old);
  collect(toml::parse(after), "", now);
  Values all = old;
  all.insert(now.begin(), now.end());
  std::vector<std::string> changed;
  for (const auto& [key, value] : all) {
    const auto in_old = old.find(key), in_now = now.find(key);
    if (in_old == old.end() || in_now == now.end() || in_old->second != in_now->second) changed.push_back(key);
  }
  return changed;
}

}  // namespace peerd::config
