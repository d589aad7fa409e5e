#include "peerd/input/toml_input.hpp"
#include "peerd/input/text_file.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "core/suggestion.hpp"
#include "peerd/input/number.hpp"

namespace peerd {
namespace {

std::string located(const toml::source_region& at, const std::string& sentence) {
  return place_of(at) + "error: " + sentence;
}

// Finds an item of a list by its number. Null means that `list` is no list, or has no such item.
template <class Node>
Node* item(Node& list, std::string_view number) {
  std::size_t i = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), i);
  if (!list.is_array() || error != std::errc{} || end != number.data() + number.size()) return nullptr;
  return list.as_array()->get(i);
}

}  // namespace

std::string place_of(const toml::source_region& at) {
  std::ostringstream out;
  if (at.path) out << *at.path << ':';
  if (at.begin) out << at.begin.line << ':' << at.begin.column << ':';
  if (out.tellp() > 0) out << ' ';
  return out.str();
}

std::optional<std::string> did_you_mean(std::string_view word, const std::vector<std::string>& words) {
  Suggestion suggestion(word);
  for (const std::string& candidate : words) suggestion.consider(candidate);
  const auto best = suggestion.best();
  return best ? std::optional<std::string>(*best) : std::nullopt;
}

std::string TomlReader::dotted(std::string_view key) const {
  return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
}

std::string TomlReader::place(const toml::node* at) const {
  return place_of((at != nullptr ? *at : static_cast<const toml::node&>(table_)).source());
}

void TomlReader::fail(const toml::node* at, const std::string& sentence) {
  if (!error_) error_ = InputError{place(at) + "error: " + sentence};
}

const toml::node* TomlReader::node(std::string_view key) {
  known_.emplace(key);
  return error_ ? nullptr : table_.get(key);
}

void TomlReader::number(std::string_view key, std::optional<double>& value, double min, double max) {
  const toml::node* n = node(key);
  if (n == nullptr) return;
  const auto x = n->value<double>();
  if (!x || !n->is_number()) return fail(n, dotted(key) + " must be a number");
  if (const auto why = why_refused(*x, {min, max})) return fail(n, dotted(key) + " = " + *why);
  value = x;
}

void TomlReader::read(std::string_view key, std::optional<double>& value, double min, double max) {
  number(key, value, min, max);
}

void TomlReader::read(std::string_view key, double& value, double min, double max) {
  std::optional<double> given;
  number(key, given, min, max);
  value = given.value_or(value);
}

void TomlReader::read(std::string_view key, std::uint32_t& value, std::uint32_t min, std::uint32_t max) {
  std::optional<double> given;
  number(key, given, min, max);
  if (!given) return;
  if (*given != std::floor(*given)) return fail(node(key), dotted(key) + " must be a whole number");
  value = static_cast<std::uint32_t>(*given);
}

void TomlReader::read(std::string_view key, std::uint64_t& value) {
  const toml::node* n = node(key);
  if (n == nullptr) return;
  const auto x = n->value_exact<std::int64_t>();
  if (!x || *x < 0) return fail(n, dotted(key) + " must be a whole number, not negative");
  value = static_cast<std::uint64_t>(*x);
}

void TomlReader::read(std::string_view key, std::optional<std::uint64_t>& value) {
  std::uint64_t given = 0;
  read(key, given);
  if (has(key)) value = given;
}

void TomlReader::read(std::string_view key, bool& value) {
  const toml::node* n = node(key);
  if (n == nullptr) return;
  const auto x = n->value_exact<bool>();
  if (!x) return fail(n, dotted(key) + " must be true or false");
  value = *x;
}

void TomlReader::read(std::string_view key, std::string& value) {
  const toml::node* n = node(key);
  if (n == nullptr) return;
  const auto x = n->value_exact<std::string>();
  if (!x) return fail(n, dotted(key) + " must be a string");
  value = *x;
}

void TomlReader::read(std::string_view key, std::vector<std::string>& value) {
  const toml::node* n = node(key);
  if (n == nullptr) return;
  const toml::array* list = n->as_array();
  if (list == nullptr) return fail(n, dotted(key) + " must be a list of strings");
  value.clear();
  for (const toml::node& item : *list) {
    const auto x = item.value_exact<std::string>();
    if (!x) return fail(&item, dotted(key) + " must be a list of strings");
    value.push_back(*x);
  }
}

void TomlReader::read(std::string_view key, std::vector<double>& value, std::size_t size) {
  const toml::node* n = node(key);
  if (n == nullptr) return;
  const toml::array* list = n->as_array();
  const std::string wanted = dotted(key) + " must be a list of " + std::to_string(size) + " numbers";
  if (list == nullptr || list->size() != size) return fail(n, wanted);
  value.clear();
  for (const toml::node& item : *list) {
    const auto x = item.value<double>();
    if (!x || !item.is_number()) return fail(&item, wanted);
    if (const auto why = why_refused(*x, kCoordinates)) return fail(&item, wanted + "; " + *why);
    value.push_back(*x);
  }
}

std::vector<std::vector<double>> TomlReader::rows(std::string_view key, std::size_t size) {
  const toml::node* n = node(key);
  if (n == nullptr) return {};
  const std::string wanted = dotted(key) + " must be a list of lists of " + std::to_string(size) + " numbers";
  const toml::array* list = n->as_array();
  if (list == nullptr || list->empty()) {
    fail(n, wanted);
    return {};
  }
  std::vector<std::vector<double>> rows;
  for (const toml::node& item : *list) {
    const toml::array* row = item.as_array();
    if (row == nullptr || row->size() != size) {
      fail(&item, wanted);
      return {};
    }
    for (std::vector<double>& numbers = rows.emplace_back(); const toml::node& number : *row) {
      const auto x = number.value<double>();
      const auto why = x && number.is_number() ? why_refused(*x, kCoordinates) : "";
      if (why) {
        fail(&number, wanted + (why->empty() ? "" : "; " + *why));
        return {};
      }
      numbers.push_back(*x);
    }
  }
  return rows;
}

std::vector<std::vector<std::string>> TomlReader::word_rows(std::string_view key) {
  const toml::node* n = node(key);
  if (n == nullptr) return {};
  const toml::array* list = n->as_array();
  std::vector<std::vector<std::string>> rows;
  bool good = list != nullptr && !list->empty();
  for (std::size_t i = 0; good && i < list->size(); ++i) {
    const toml::array* row = list->get(i)->as_array();
    good = row != nullptr && std::ranges::all_of(*row, [](const toml::node& word) { return word.is_string(); });
    rows.emplace_back();
    for (std::size_t j = 0; good && j < row->size(); ++j) rows.back().push_back(row->get_as<std::string>(j)->get());
  }
  if (good) return rows;
  fail(n, dotted(key) + " must be a list of lists of strings");
  return {};
}

void TomlReader::read_word(std::string_view key, std::size_t& index, std::initializer_list<std::string_view> words) {
  const toml::node* n = node(key);
  if (n == nullptr) return;
  const auto x = n->value_exact<std::string>();
  const auto at = x ? std::ranges::find(words, *x) : words.end();
  if (at != words.end()) {
    index = static_cast<std::size_t>(at - words.begin());
    return;
  }
  std::string choices;
  for (std::string_view w : words) choices += (choices.empty() ? "\"" : ", \"") + std::string(w) + "\"";
  fail(n, dotted(key) + " must be one of " + choices);
}

const toml::table* TomlReader::table(std::string_view key) {
  const toml::node* n = node(key);
  if (n == nullptr) return nullptr;
  if (n->as_table() == nullptr) fail(n, dotted(key) + " must be a table");
  return n->as_table();
}

std::vector<const toml::table*> TomlReader::tables(std::string_view key) {
  const toml::node* n = node(key);
  if (n == nullptr) return {};
  std::vector<const toml::table*> all;
  const std::string wanted = dotted(key) + " must be a list of tables: write each as [[" + dotted(key) + "]]";
  if (n->as_array() == nullptr) {
    fail(n, wanted);
    return {};
  }
  for (const toml::node& item : *n->as_array()) {
    if (item.as_table() == nullptr) {
      fail(&item, wanted);
      return {};
    }
    all.push_back(item.as_table());
  }
  return all;
}

void TomlReader::require(std::string_view key) {
  if (!error_ && table_.get(key) == nullptr) fail(nullptr, dotted(key) + " is missing");
}

void TomlReader::finish() {
  for (const auto& [key, value] : table_) {
    if (known_.contains(key.str())) continue;
    std::string sentence = "unknown key " + dotted(key.str());
    const auto meant = did_you_mean(key.str(), {known_.begin(), known_.end()});
    if (meant) sentence += "; did you mean " + dotted(*meant) + "?";
    if (!error_) error_ = InputError{located(key.source(), sentence)};
    return;
  }
}

Result<toml::table> parse_toml(const std::string& text, const std::string& name) {
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& e) {
    return std::unexpected(InputError{located(e.source(), std::string(e.description()))});
  }
}

Result<toml::table> read_toml(const std::filesystem::path& path) {
  const auto text = read_text_file(path, kSettingsFile);
  if (!text) return std::unexpected(text.error());
  return parse_toml(*text, path.string());
}

Result<Assignment> parse_assignment(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    return std::unexpected(
        InputError{"error: --set " + text + ": write it as KEY=VALUE, such as network.latency_ms=100"});
  }
  Assignment a{text.substr(0, equals), {}};
  const std::string value = text.substr(equals + 1);
  if (auto as_toml = parse_toml("value = " + value, "--set " + a.key); as_toml && as_toml->size() == 1) {
    a.holder = std::move(*as_toml);
  } else {
    a.holder.insert_or_assign("value", value);
  }
  return a;
}

const toml::node* find(const toml::table& root, std::string_view dotted_key) {
  const toml::node* at = &root;
  while (at != nullptr && !dotted_key.empty()) {
    const std::string_view part = dotted_key.substr(0, dotted_key.find('.'));
    dotted_key.remove_prefix(std::min(dotted_key.size(), part.size() + 1));
    const toml::table* table = at->as_table();
    at = table != nullptr ? table->get(part) : item(*at, part);
  }
  return at;
}

Result<void> assign(toml::table& root, std::string_view dotted_key, const toml::node& value) {
  toml::node* at = &root;
  std::string_view rest = dotted_key;
  for (std::size_t dot = rest.find('.'); dot != std::string_view::npos; dot = rest.find('.')) {
    toml::table* table = at->as_table();
    at = table != nullptr ? &table->emplace<toml::table>(rest.substr(0, dot)).first->second
                          : item(*at, rest.substr(0, dot));
    rest.remove_prefix(dot + 1);
    if (at == nullptr || !(at->is_table() || at->is_array())) {
      const std::string holder(dotted_key.substr(0, dotted_key.size() - rest.size() - 1));
      return std::unexpected(InputError{"error: " + std::string(dotted_key) + ": " + holder +
                                        (at != nullptr ? " is a value, not a table" : " is no item of a list")});
    }
  }
  if (toml::table* table = at->as_table()) {
    value.visit([&](const auto& concrete) { table->insert_or_assign(rest, concrete); });
    return {};
  }
  toml::node* const old = item(*at, rest);
  if (old == nullptr) {
    return std::unexpected(InputError{"error: " + std::string(dotted_key) + ": the list has " +
                                      std::to_string(at->as_array()->size()) + " items, which count from 0"});
  }
  toml::array& list = *at->as_array();
  const auto place = std::ranges::find_if(list, [&](const toml::node& n) { return &n == old; });
  value.visit([&](const auto& concrete) { list.replace(place, concrete); });
  return {};
}

void merge(toml::table& base, const toml::table& over) {
  for (const auto& [key, value] : over) {
    toml::table* below = base.get_as<toml::table>(key.str());
    if (below != nullptr && value.is_table()) {
      merge(*below, *value.as_table());
    } else {
      value.visit([&](const auto& concrete) { base.insert_or_assign(key, concrete); });
    }
  }
}

}  // namespace peerd
