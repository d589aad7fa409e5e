#include "peerd/input/toml_json.hpp"

#include <sstream>

#include <nlohmann/json.hpp>

namespace peerd {

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

}  // namespace peerd
