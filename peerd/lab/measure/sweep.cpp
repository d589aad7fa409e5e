#include "peerd/lab/measure/sweep.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <string_view>

#include <nlohmann/json.hpp>

namespace peerd::measure {
namespace {

struct NameAndUnit {
  std::string name;
  std::string unit;  // empty: the name ends in no known unit
};

NameAndUnit split_unit(const std::string& name) {
  struct Unit {
    std::string_view suffix, text;
  };
  static constexpr std::array units{Unit{"_ms", "ms"},   Unit{"_us", "µs"}, Unit{"_s", "s"},
                                    Unit{"_m", "m"},     Unit{"_hz", "Hz"}, Unit{"_m_s", "m/s"},
                                    Unit{"_rad", "rad"}, Unit{"_deg", "°"}, Unit{"_percent", "%"}};
  const Unit* best = nullptr;  // the longest: "speed_m_s" is metres per second, not seconds
  for (const Unit& unit : units) {
    if (name.ends_with(unit.suffix) && (best == nullptr || unit.suffix.size() > best->suffix.size())) best = &unit;
  }
  if (best == nullptr || name.size() == best->suffix.size()) return {name, ""};
  return {name.substr(0, name.size() - best->suffix.size()), std::string(best->text)};
}

std::string in_words(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

}  // namespace

std::vector<std::string> varying_keys(std::span<const Params> runs) {
  std::vector<std::string> keys;
  for (const Params& run : runs) {
    for (const auto& item : run.items()) {
      if (std::ranges::find(keys, item.key()) == keys.end()) keys.push_back(item.key());
    }
  }
  std::erase_if(keys, [&](const std::string& key) {
    return std::ranges::all_of(
        runs, [&](const Params& run) { return value_text(run, key) == value_text(runs.front(), key); });
  });
  return keys;
}

Params with_network(Params params, const Params& network_settings) {
  for (const auto& item : network_settings.items()) {
    if (!params.contains(item.key())) params[item.key()] = item.value();
  }
  return params;
}

std::string short_name(const std::string& key, std::span<const std::string> keys) {
  // Without a dot the position is npos, and npos + 1 is 0, which gives the whole key.
  const auto last = [](const std::string& k) { return k.substr(k.rfind('.') + 1); };
  const bool unique = std::ranges::none_of(keys, [&](const auto& k) { return k != key && last(k) == last(key); });
  return unique ? last(key) : key;
}

std::string value_text(const Params& run, const std::string& key) {
  const auto it = run.find(key);
  if (it == run.end()) return "";
  if (it->is_string()) return it->get<std::string>();
  if (it->is_number_float()) {  // 100 and 100.0 are one value
    std::array<char, 32> digits;
    const double value = it->get<double>();
    return {digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr};
  }
  return it->dump(-1, ' ', false, Params::error_handler_t::replace);
}

std::string describe(const Params& run, const std::string& key, std::span<const std::string> keys) {
  const auto it = run.find(key);
  if (it != run.end() && it->is_string()) return it->get<std::string>();
  const NameAndUnit n = split_unit(short_name(key, keys));
  return in_words(n.name) + ' ' + value_text(run, key) + (n.unit.empty() ? "" : ' ' + n.unit);
}

std::string describe(const Params& run, std::span<const std::string> keys) {
  std::string text;
  for (const std::string& key : keys) {
    if (!text.empty()) text += ", ";
    text += describe(run, key, keys);
  }
  return text;
}

std::string axis_label(const std::string& key, std::span<const std::string> keys) {
  const NameAndUnit n = split_unit(short_name(key, keys));
  return in_words(n.name) + (n.unit.empty() ? "" : " [" + n.unit + ']');
}

}  // namespace peerd::measure
