#include <algorithm>
#include <array>
#include <sstream>
#include <system_error>
#include <utility>

#include "core/vrml/path_text.hpp"
#include "peerd/input/toml_input.hpp"
#include "peerd/input/world_file.hpp"

namespace peerd {
namespace {

namespace fs = std::filesystem;

struct Unit {
  std::string_view name;
  double metres;
};
constexpr std::array<Unit, 5> kUnits{{{"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}}};

// Each entry of `collide` becomes an interest in all others, so that a list of them grows by its square.
constexpr std::size_t kCollideEntries = 256, kCollide_bytes = std::size_t{64} << 10;

// The ends of the names of files that may be worlds.
constexpr std::array<std::string_view, 9> kWorldEndings{".wrl", ".wrz", ".wrl.gz", ".gltf", ".glb",
                                                        ".obj", ".stl", ".ply",    ".off"};

// The lines of a text by their begins.
class LineTable {
 public:
  explicit LineTable(std::string_view text) : size_(text.size()) {
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '\n') begins_.push_back(i + 1);
    }
  }
  // Returns the place of a TOML value in the text, as problems count it.
  [[nodiscard]] std::size_t offset_of(const toml::source_region& at) const {
    const std::size_t line = std::clamp<std::size_t>(at.begin.line, 1, begins_.size());
    return std::min(begins_[line - 1] + std::max<std::size_t>(at.begin.column, 1) - 1, size_);
  }

 private:
  std::vector<std::size_t> begins_{0};
  std::size_t size_;
};

class SideFile {
 public:
  SideFile(const toml::table& root, std::string_view text) : lines_(text), reader_(root, "", error_) {}

  Result<WorldSettings> read() {
    read_unit();
    std::size_t up = 0;
    reader_.read_word("up", up, {"y", "z"});
    settings_.has_up = reader_.has("up");
    settings_.conversion.z_up = up == 1;
    for (const toml::table* const table : reader_.tables("interest")) read_interest(*table);
    if (const toml::table* const objects = reader_.table("object")) {
      for (const auto& [path, value] : *objects) read_object(std::string(path.str()), value);
      // A table has its keys in alphabetical order, and the last setting counts in that of the file.
      std::ranges::stable_sort(settings_.objects, {}, &ObjectSetting::offset);
    }
    read_collide();
    reader_.finish();
    if (error_) return std::unexpected(*error_);
    return std::move(settings_);
  }

 private:
  void read_unit() {
    std::string name;
    reader_.read("unit", name);
    settings_.has_unit = reader_.has("unit");
    if (name.empty()) return;
    const auto known = std::ranges::find(kUnits, name, &Unit::name);
    if (known == kUnits.end()) return reader_.fail(reader_.raw().get("unit"), "unit must be m, cm, mm, in or ft");
    settings_.conversion.metres_per_unit = known->metres;
  }

  void read_collide() {
    const toml::node* const node = reader_.raw().get("collide");
    if (node == nullptr) return;
    const auto word = node->value<std::string>();
    if (word == "none") {
      std::string taken;
      reader_.read("collide", taken);
      settings_.interests.clear();
      return;
    }
    if (word == "all") {
      std::string taken;
      reader_.read("collide", taken);
      settings_.collides_all = true;
      return;
    }
    std::vector<std::string> groups;
    reader_.read("collide", groups);
    std::size_t bytes = 0;
    for (const std::string& group : groups) bytes += group.size();
    if (groups.size() > kCollideEntries || bytes > kCollide_bytes) {
      return reader_.fail(
          node, "collide lists at most " + std::to_string(kCollideEntries) + " paths and patterns, of 64 KiB together");
    }
    for (const std::string& group : groups) {
      settings_.interests.push_back({group, {}, {}, CollisionType::kWitness, lines_.offset_of(node->source())});
      for (const std::string& other : groups) {
        // A path names one object, which does not meet itself.
        if (other != group || group.find('*') != std::string::npos) settings_.interests.back().with.push_back(other);
      }
    }
  }

  void read_interest(const toml::table& table) {
    TomlReader reader(table, "interest", error_);
    InterestSetting interest;
    interest.offset = lines_.offset_of(table.source());
    reader.require("object");
    reader.require("with");
    reader.read("object", interest.object);
    reader.read("with", interest.with);
    reader.read("except", interest.except);
    std::size_t type = static_cast<std::size_t>(interest.type);
    reader.read_word("type", type, {"box", "witness", "allpairs"});
    interest.type = static_cast<CollisionType>(type);
    reader.finish();
    settings_.interests.push_back(std::move(interest));
  }

  void read_object(const std::string& path, const toml::node& node) {
    if (!node.is_table()) return reader_.fail(&node, "object." + path + " must be a table");
    TomlReader reader(*node.as_table(), "object." + path, error_);
    ObjectSetting object;
    object.object = path;
    object.offset = lines_.offset_of(node.source());
    std::vector<double> velocity{0, 0, 0};
    reader.read("velocity_m_s", velocity, 3);
    if (reader.has("velocity_m_s")) {
      object.velocity_m_s.emplace();
      std::ranges::transform(velocity, object.velocity_m_s->begin(), [](double v) { return static_cast<float>(v); });
    }
    std::optional<double> threshold_m;
    reader.read("distance_threshold_m", threshold_m, 0.0, 1e6);
    if (threshold_m) object.distance_threshold_m = static_cast<float>(*threshold_m);
    bool owned = false;
    reader.read("owned_by_founder", owned);
    if (reader.has("owned_by_founder")) object.owned_by_founder = owned;
    std::uint32_t layers = 0;
    reader.read("layers", layers, 0, ~0U);
    if (reader.has("layers")) object.layers = layers;
    read_response(reader, object);
    reader.finish();
    settings_.objects.push_back(std::move(object));
  }

  static void read_response(TomlReader& reader, ObjectSetting& object) {
    std::size_t type = 0;
    CollisionResponse response;
    reader.read_word("response", type, {"mirror", "stop", "impulse"});
    reader.read("set_back", response.set_back);
    reader.read("mass_kg", response.mass_kg, 1e-9, 1e12);
    reader.read("restitution", response.restitution, 0.0, 1.0);
    reader.read("friction_m_s2", response.friction_m_s2, 0.0, 1e6);
    response.type = static_cast<ResponseType>(type);
    for (const char* const key : {"set_back", "mass_kg", "restitution", "friction_m_s2"}) {
      if (reader.has(key) && !reader.has("response")) reader.require("response");
    }
    for (const char* const key : {"mass_kg", "restitution", "friction_m_s2"}) {
      if (reader.has(key) && response.type != ResponseType::kImpulse) {
        reader.fail(reader.raw().get(key), reader.dotted(key) + " counts with response = \"impulse\" only");
      }
    }
    if (reader.has("response")) object.response = response;
  }

  LineTable lines_;
  std::optional<InputError> error_;
  TomlReader reader_;
  WorldSettings settings_;
};

// Returns the paths and patterns of a list with commas between them. A comma in quotes is a part of a name.
toml::array groups_of(std::string_view list) {
  toml::array groups;
  while (true) {
    list.remove_prefix(std::min(list.find_first_not_of(' '), list.size()));
    const std::size_t comma = list_entry_end(list);
    const std::string_view group = list.substr(0, comma);
    groups.push_back(std::string(group.substr(0, group.find_last_not_of(' ') + 1)));
    if (comma == list.size()) return groups;
    list.remove_prefix(comma + 1);
  }
}

// Returns whether there is a side file of that name. Error: nothing can be read there.
Result<bool> is_there(const fs::path& side) {
  std::error_code error;
  const fs::file_type type = fs::symlink_status(side, error).type();
  if (type == fs::file_type::not_found || error == std::errc::filename_too_long) return false;
  if (fs::is_regular_file(side, error)) return true;
  return std::unexpected(InputError{
      side.string() + ": error: " + (error ? "can't be read: " + error.message() : "it is no regular file")});
}

// Returns the path of a world without the end of its name.
std::string stem_of(const fs::path& world) {
  const std::string path = world.string();
  std::string_view ending;
  for (const std::string_view one : kWorldEndings) {
    if (path.ends_with(one) && one.size() > ending.size()) ending = one;
  }
  if (ending.empty()) return (world.parent_path() / world.stem()).string();
  return path.substr(0, path.size() - ending.size());
}

// Returns another world that has the short name of a side file in common with this one, and has no side file by its
// long name; empty where there is none.
fs::path sharing_world(const fs::path& world) {
  std::error_code ignored;  // what cannot be asked for cannot be read as a world either
  for (const std::string_view ending : kWorldEndings) {
    const fs::path other = stem_of(world) + std::string(ending);
    if (other.filename() == world.filename() || !fs::exists(other, ignored)) continue;
    if (!fs::exists(long_side_file(other), ignored)) return other;
  }
  return {};
}

}  // namespace

fs::path long_side_file(const fs::path& world) { return world.string() + std::string(kSideEnding); }
fs::path short_side_file(const fs::path& world) { return stem_of(world) + std::string(kSideEnding); }

Result<std::optional<fs::path>> find_side_file(const fs::path& world) {
  const fs::path longer = long_side_file(world), shorter = short_side_file(world);
  for (const fs::path& side : {longer, shorter}) {
    const auto there = is_there(side);
    if (!there) return std::unexpected(there.error());
    if (!*there) continue;
    const fs::path other = side != longer ? sharing_world(world) : fs::path();
    if (other.empty()) return side;
    const std::string name = world.filename().string();
    return std::unexpected(InputError{side.string() + ": error: it may be of " + name + " or of " +
                                      other.filename().string() + "; call it " + longer.filename().string() +
                                      " to have it for " + name});
  }
  return std::nullopt;
}

fs::path new_side_file(const fs::path& world) {
  return sharing_world(world).empty() ? short_side_file(world) : long_side_file(world);
}

Result<WorldSettings> read_side_file(const std::string& text, const std::string& name) {
  const auto root = parse_toml(text, name);
  if (!root) return std::unexpected(root.error());
  return SideFile(*root, text).read();
}

Result<std::string> with_options(const std::string& text, const std::string& name, const WorldReading& reading) {
  if (reading.collide.empty() && reading.unit.empty() && reading.up.empty()) return text;
  auto root = parse_toml(text, name);
  if (!root) return std::unexpected(root.error());
  if (!reading.unit.empty()) root->insert_or_assign("unit", reading.unit);
  if (!reading.up.empty()) root->insert_or_assign("up", reading.up);
  if (reading.collide == "all" || reading.collide == "none") {
    root->insert_or_assign("collide", reading.collide);
  } else if (!reading.collide.empty()) {
    root->insert_or_assign("collide", groups_of(reading.collide));
  }
  std::ostringstream out;
  out << *root << '\n';
  return out.str();
}

}  // namespace peerd
