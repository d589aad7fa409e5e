#include "peerd/peer/config/renamed_keys.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <utility>

namespace peerd::config {
namespace {

using Parts = std::vector<std::string>;  // parts of a dotted key

// A key at the top of the file has one part, [replication] order has two, and [peer.NAME] id has three. `*` stands for
// any name.
struct RenamedKey {
  std::span<const std::string_view> old_parts;
  std::string_view new_name;  // replaces the last part
};
constexpr std::array<std::string_view, 3> kEnslaves{"peer", "*", "enslaves"};
constexpr std::array<std::string_view, 2> kAlongAt{"replication", "along_at"};
constexpr std::array kRenamedKeys{
    RenamedKey{kEnslaves, "owns"},
    RenamedKey{kAlongAt, "piggyback_fraction"},
};

Parts parts_of(std::string_view dotted) {
  Parts parts;
  for (std::size_t dot = dotted.find('.'); dot != std::string_view::npos; dot = dotted.find('.')) {
    parts.emplace_back(dotted.substr(0, dot));
    dotted.remove_prefix(dot + 1);
  }
  parts.emplace_back(dotted);
  return parts;
}

std::string dotted(const Parts& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ".") + part;
  return text;
}

// Gives the key its new name, or nothing where its name is not an old one. Parts below the renamed one, such as the
// number of an item of its list, stay.
std::optional<Parts> renamed(const Parts& key) {
  for (const RenamedKey& known : kRenamedKeys) {
    const std::size_t size = known.old_parts.size();
    const bool same =
        key.size() >= size && std::equal(known.old_parts.begin(), known.old_parts.end(), key.begin(),
                                         [](auto old, const auto& part) { return old == "*" || old == part; });
    if (!same) continue;
    Parts now = key;
    now[size - 1] = known.new_name;
    return now;
  }
  return std::nullopt;
}

std::string is_now_called(const Parts& before, const Parts& now) {
  return dotted(before) + " is now called " + dotted(now);
}

// Renames the keys of one table and of those below it.
class Renamer {
 public:
  explicit Renamer(std::vector<std::string>& warnings) : warnings_(warnings) {}

  void walk(toml::table& table, const Parts& at) {
    const bool holds_dotted_names =
        at == Parts{"sweep"} || (at.size() == 3 && at.front() == "expect" && at.back() == "where");
    std::vector<std::string> names;  // a table must not change while it is iterated over
    for (const auto& [key, value] : table) names.emplace_back(key.str());
    for (const std::string& name : names) {
      Parts key = holds_dotted_names ? parts_of(name) : at;
      if (!holds_dotted_names) key.push_back(name);
      if (const auto now = renamed(key)) {
        rename(table, name, holds_dotted_names ? dotted(*now) : now->back(), key, *now);
      } else if (toml::table* const below = table.get_as<toml::table>(name)) {
        walk(*below, key);
      }
    }
  }
  [[nodiscard]] Result<void> result() const {
    if (error_) return std::unexpected(*error_);
    return {};
  }

 private:
  void rename(toml::table& table, const std::string& name, const std::string& new_name, const Parts& key,
              const Parts& now) {
    const auto old = table.find(name);
    const toml::source_region place = old->first.source();
    if (table.contains(new_name)) {
      if (!error_) {
        error_ = InputError{place_of(place) + "error: " + dotted(key) + " and " + dotted(now) +
                            " are two names of one key; leave out " + dotted(key)};
      }
      return;
    }
    warnings_.push_back(place_of(place) + "warning: " + is_now_called(key, now));
    // A moved node keeps its place in the file, a copied one does not.
    old->second.visit([&](auto& value) { table.insert_or_assign(toml::key(new_name, place), std::move(value)); });
    table.erase(name);
  }

  std::vector<std::string>& warnings_;
  std::optional<InputError> error_;
};

// The key that one of the table [world] stands for. It is null where there is no such key.
const char* key_of_world(std::string_view name) {
  if (name == "file") return "world";
  return name == "lenient" ? "lenient" : nullptr;
}

// A table with other keys stays, for the reader to refuse it.
void flatten_world(toml::table& root) {
  const toml::table* const world = root.get_as<toml::table>("world");
  if (world == nullptr) return;
  for (const auto& [name, value] : *world) {
    if (key_of_world(name.str()) == nullptr) return;
  }
  toml::table keys = std::move(*root.get_as<toml::table>("world"));
  root.erase("world");
  for (auto&& [name, node] : keys) {
    const toml::key key(key_of_world(name.str()), name.source());
    node.visit([&](auto& value) { root.insert_or_assign(key, std::move(value)); });
  }
}

}  // namespace

Result<void> rename_old_keys(toml::table& root, std::vector<std::string>& warnings) {
  flatten_world(root);
  Renamer renamer(warnings);
  renamer.walk(root, {});
  return renamer.result();
}

Result<void> rename_old_keys(Assignment& set, std::vector<std::string>& warnings) {
  if (set.key.starts_with("world.")) {
    const char* const name = key_of_world(std::string_view(set.key).substr(6));
    if (name != nullptr) set.key = name;
  }
  const Parts key = parts_of(set.key);
  if (const auto now = renamed(key)) {
    warnings.push_back("warning: --set " + is_now_called(key, *now));
    set.key = dotted(*now);
  }
  toml::table* const value = set.holder.get_as<toml::table>("value");
  if (value == nullptr) return {};
  Renamer renamer(warnings);
  renamer.walk(*value, key);
  return renamer.result();
}

}  // namespace peerd::config
