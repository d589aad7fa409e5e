#include "peerd/cli/commands/new_command.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <map>
#include <ostream>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "peerd/cli/shell/print.hpp"
#include "peerd/input/input_error.hpp"
#include "peerd/input/json_text.hpp"
#include "peerd/input/path_text.hpp"
#include "peerd/input/printable.hpp"
#include "peerd/input/world_file.hpp"

namespace peerd {
namespace {

namespace fs = std::filesystem;

constexpr int kWrongName = 2, kCantWrite = 3;
constexpr std::size_t kPathShown_bytes = 200;
constexpr std::size_t kNameMax = 60;  // with its extension it is a file's name anywhere

constexpr std::string_view kNewWorld = R"wrl(#VRML V2.0 utf8

# A lane with a wall at each end. A car drives to and fro in it, and a ball rolls between the car and the right wall.
# Metres, radians, seconds; y is up. The scenario NAME.toml says which peer runs the car and which the ball.

WorldInfo { title "NAME" }
Viewpoint { position 0 12 16 orientation 1 0 0 -0.6 description "From above" }

DEF GROUND Transform {
  translation 0 -0.6 0
  children Shape {
    appearance Appearance { material Material { diffuseColor 0.35 0.4 0.35 } }
    geometry Box { size 24 0.2 8 }
  }
}

DEF WALL_LEFT Transform {
  translation -11 0.5 0
  children DEF WALL Shape {
    appearance Appearance { material Material { diffuseColor 0.7 0.7 0.7 } }
    geometry Box { size 0.5 2 8 }
  }
}
DEF WALL_RIGHT Transform { translation 11 0.5 0 children USE WALL }

# The car goes where the scenario's formula, a hand or a program puts it. Others predict it by dead reckoning and get an
# update once that is off by distanceThreshold [m].
DEF CAR Transform {
  translation -5 0 0
  distanceThreshold 0.2
  children Shape {
    appearance Appearance { material Material { diffuseColor 0.8 0.2 0.1 } }
    geometry Box { size 2 1 1.2 }
  }
}

# The ball goes on by itself from velocityVector [m/s], and bounces off what it meets: its velocity is mirrored
# (responseType 0), and by responseType 2 it would follow Newton's law, with mass and restitution.
DEF BALL Transform {
  translation 4 0 0
  velocityVector -2 0 0
  distanceThreshold 0.2
  collisionResponse CollisionResponse { responseType 0 }
  children Shape {
    appearance Appearance { material Material { diffuseColor 0.1 0.4 0.8 } }
    geometry Sphere { radius 0.5 }
  }
}

# Who can meet whom: no other pair is ever tested.
CollisionInterest { objectPath "BALL" interests [ "CAR" "WALL_LEFT" "WALL_RIGHT" ] collisionType 1 }
)wrl";

constexpr std::string_view kNewScenario =
    R"toml(# Two peers share NAME.wrl. `peerd sim` runs both on a simulated network, `peerd scenario` between real processes, and
# `peerd run -c NAME.toml --peer a` runs one of them for as long as you like.

world = "NAME.wrl"
duration_s = 20
seed = 1

[network]                  # of `peerd sim`
latency_ms = 50
loss = 0.01

[peer.a]
id = 1
owns = ["CAR"]

[peer.b]
id = 2
owns = ["BALL"]

# t is in seconds; until t = 0, when both peers are there, the car waits at its first place.
[motion.CAR]
x = "-6 + 3*sin(t)"
before_start = "hold"

# What a run must show; `peerd sim` ends with exit code 1 where it does not.
[expect.one-outcome]
that = "collisions.shared.disagreed"
equals = 0

[expect.same-world]
that = "state_roots_equal"
equals = true
)toml";

bool is_good_name(std::string_view name) {
  const auto good = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '_'; };
  return !name.empty() && name.size() <= kNameMax && name.front() != '-' && std::ranges::all_of(name, good);
}

// Returns the text with the name in the place of each NAME, and the file's in that of each FILE.
std::string filled(std::string_view text, std::string_view name, std::string_view file = "FILE") {
  std::string out;
  while (!text.empty()) {
    const bool is_name = text.starts_with("NAME"), is_place = is_name || text.starts_with("FILE");
    if (is_place) {
      out += is_name ? name : file;
    } else {
      out += text.front();
    }
    text.remove_prefix(is_place ? 4 : 1);
  }
  return out;
}

constexpr std::string_view kSideFile =
    R"toml(# What the file beside this one cannot say. docs/reference/formats.md has all keys.

# unit = "mm"                  # of its lengths: m, cm, mm, in or ft
# up = "z"                     # its axis that points up: y or z

# What may meet what: "all" is each object with each other, "none" nothing; or list paths and patterns.
collide = "all"

# [[interest]]                 # or each interest by itself
# object = "PATH"
# with = ["PATH", "PATH*"]
# type = "witness"             # box, witness or allpairs

# [object."PATH"]              # a node that moves
# velocity_m_s = [1, 0, 0]
# distance_threshold_m = 0.2   # how far others may be off before they get an update
# owned_by_founder = true      # the first peer of a session runs it
# response = "mirror"          # what a collision does to it: mirror, stop, or impulse with mass_kg, restitution,
#                              # friction_m_s2
)toml";

constexpr std::string_view kScenarioOfFile =
    R"toml(# Two peers share the world. `peerd sim` runs both on a simulated network, `peerd run -c NAME.toml --peer a` one of them.

world = FILE
duration_s = 20
seed = 1

[peer.a]
id = 1
# owns = ["PATH"]

[peer.b]
id = 2
)toml";

// Error: the file can't be written, or another one has its name.
Result<void> write_new(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary | std::ios::noreplace);
  out << text;
  out.close();
  if (!out) return std::unexpected(InputError{"error: " + file.string() + " can't be written", kCantWrite});
  return {};
}

// The paths of the first objects at the top, as comments of a side file.
std::string paths_of(const Scene& scene) {
  constexpr int kShown = 20;
  std::string text = "\n# Its objects at the top:\n";
  int shown = 0;
  for (std::uint32_t i = 0; i < scene.instances.size(); i = scene.instances[i].subtree_end) {
    if (++shown > kShown) return text + "#   ..\n";
    text += "#   " + printable(scene.path_of(scene.id_of(i)), kPathShown_bytes) + '\n';
  }
  return text;
}

// Returns the folder of a file, without links. That of a link is the one where the link is: URLs start from there.
fs::path folder_of(const fs::path& file) {
  std::error_code error;
  return fs::canonical(file.has_parent_path() ? file.parent_path() : fs::path("."), error);
}

// Returns the bytes of a world and of the files that it names, by their paths from the folder that has the world.
Result<std::map<fs::path, std::string_view>> copies_of(const fs::path& from, const WorldFile& world) {
  std::map<fs::path, std::string_view> copies{{from.filename(), world.text}};
  const fs::path around = folder_of(from);
  for (const Source& source : world.result.sources) {
    const auto load = std::ranges::find(world.loads, source.name, &WorldFile::Load::name);
    if (load == world.loads.end() || fs::path(source.name).filename().string().ends_with(".peerd.toml")) continue;
    const fs::path place = fs::path(source.name).lexically_relative(around);
    if (place.empty() || *place.begin() == "..") {
      return std::unexpected(InputError{"error: " + from.string() + " names " + source.name +
                                            ", which is outside of its folder; copy the files by hand",
                                        kWrongName});
    }
    copies.emplace(place, source.text);
  }
  return copies;
}

// Shown lists the images, sounds and scripts of a world, and a warning for each that stays behind.
struct Shown {
  std::map<fs::path, fs::path> files;  // where each is, by its path from the folder that has the world
  std::vector<std::string> left;
};

// Returns whether a field names files that are shown or run with its node. A link (Anchor) leads to another world.
bool names_files(const vrml::Node& node, const vrml::FieldSpec& field) {
  if (field.type != vrml::FieldType::kMFString && field.type != vrml::FieldType::kSFString) return false;
  if (node.type->name == "Anchor" || !vrml::has_value(field.access)) return false;
  return field.name == "url" || field.name.ends_with("Url") || field.name == "hierarchyFile";
}

// Finds the files behind the URLs of a world, whose reader loads only those of Inlines, EXTERNPROTOs and other formats.
class ShownFiles {
 public:
  ShownFiles(const fs::path& from, const WorldFile& world) : from_(from), around_(folder_of(from)) {
    for (const Source& source : world.result.sources) static_cast<void>(texts_.open(source));
    for (const vrml::Node& node : world.result.scene->document->nodes) {
      for (const vrml::Field& field : node.given()) {
        if (names_files(node, *field.spec)) add(field);
      }
    }
  }
  Shown take() {
    shown_.left.assign(left_.begin(), left_.end());
    return std::move(shown_);
  }

 private:
  // The URLs of one field are alternatives: where one of them leads to a file to copy, the others need not.
  void add(const vrml::Field& field) {
    std::string_view lost;
    std::string why;
    for (const std::string_view url : field.as<std::string_view>()) {
      const auto named = local_path(url);
      if (!named) continue;  // it is found from anywhere
      const fs::path file = named->is_absolute() ? *named : file_of(*named, field.at);
      const fs::path place = file.lexically_relative(around_);
      if (!named->is_absolute() && !place.empty() && *place.begin() != "..") {
        shown_.files.emplace(place, file);
        return;
      }
      if (!why.empty()) continue;
      lost = url;
      why = named->is_absolute() ? "its path is one of this machine"
            : file.empty()       ? "there is no such file"
                                 : "it is outside of the world's folder";
    }
    if (!why.empty()) leave(lost, why);
  }

  // Returns the file that a path leads to from the text that has it, or from the world's, as the viewer asks for it.
  fs::path file_of(const fs::path& named, vrml::Position at) const {
    for (const fs::path& base : {fs::path(texts_.name_of(at)), from_}) {
      std::error_code error;
      const fs::path file = fs::canonical(base.parent_path() / named, error);
      if (!error && fs::is_regular_file(file, error)) return file;
    }
    return {};
  }

  void leave(std::string_view url, const std::string& why) {
    left_.insert("warning: " + from_.string() + " names " + printable(url, kPathShown_bytes) +
                 ", which is not copied: " + why);
  }

  fs::path from_, around_;
  vrml::Problems texts_;
  std::set<std::string> left_;
  Shown shown_;
};

// `peerd new FOLDER --from FILE`.
int new_from(const NewOptions& options, const std::string& name, std::ostream& out) {
  const auto world = read_world_file(options.from);
  if (!world) return failed(world.error());
  if (!(*world)->result.scene) {
    return failed({"error: " + options.from.string() + " has errors; peerd check says which", 1});
  }
  const fs::path file = options.folder / options.from.filename(), scenario = options.folder / (name + ".toml");
  // A side file that is there already, by either of its names, would be read with the copy.
  const fs::path short_side = short_side_file(file), long_side = long_side_file(file);
  for (const fs::path& one : {file, scenario, short_side, long_side}) {
    std::error_code ignored;  // what can't be asked for can't be written either, which says why
    if (fs::exists(one, ignored)) return failed({"error: there is a file " + one.string() + " already", kWrongName});
  }
  const auto copies = copies_of(options.from, **world);
  if (!copies) return failed(copies.error());
  const Shown shows = ShownFiles(options.from, **world).take();
  const std::set<fs::path> own{scenario, short_side, long_side};
  for (const auto& [place, from] : shows.files) {
    const fs::path copy = options.folder / place;
    std::error_code ignored;  // as above
    if (fs::exists(copy, ignored)) return failed({"error: there is a file " + copy.string() + " already", kWrongName});
    if (own.contains(copy)) {
      return failed(
          {"error: the world names a file " + place.string() + ", which peerd new writes itself", kWrongName});
    }
  }
  for (const auto& [place, bytes] : *copies) {
    const fs::path copy = options.folder / place;
    std::error_code error;
    fs::create_directories(copy.parent_path(), error);
    if (error) return failed({"error: no folder " + copy.parent_path().string() + ": " + error.message(), kCantWrite});
    if (const auto written = write_new(copy, std::string(bytes)); !written) return failed(written.error());
  }
  for (const auto& [place, from] : shows.files) {
    if (copies->contains(place)) continue;
    const fs::path copy = options.folder / place;
    std::error_code error;
    fs::create_directories(copy.parent_path(), error);
    if (!error) fs::copy_file(from, copy, error);
    if (error) return failed({"error: " + copy.string() + " can't be written: " + error.message(), kCantWrite});
  }
  print_warnings(shows.left);
  std::string side_text = std::string(kSideFile) + paths_of(*(*world)->result.scene);
  for (const Source& source : (*world)->result.sources) {
    if (source.name.ends_with(".peerd.toml")) side_text = source.text;  // it has one already
  }
  // A name of other bytes than UTF-8 is a URI, which begins at the root.
  const std::string shown =
      is_utf8(file.filename().native()) ? file.filename().string() : path_text(fs::absolute(file));
  const fs::path side = new_side_file(file);
  const std::string text = filled(kScenarioOfFile, name, json_line(nlohmann::json(shown)));
  for (const auto& [place, content] : {std::pair(side, side_text), {scenario, text}}) {
    if (const auto written = write_new(place, content); !written) return failed(written.error());
  }
  const std::string w = file.string(), s = scenario.string();
  out << "wrote " << w << ", " << side.string() << " and " << s << "\n\nTry it:\n  peerd check " << w
      << "\n  peerd collide " << w << "\n  peerd run -c " << s << " --peer a --view\n  peerd run -c " << s
      << " --peer b --view\n";
  return 0;
}

}  // namespace

int run_new(const NewOptions& options, std::ostream& out) {
  const std::string name =
      options.name.empty() ? fs::absolute(options.folder / "").parent_path().filename().string() : options.name;
  if (!is_good_name(name)) {
    return failed({"error: \"" + name + "\" can't be the name of a world: letters, digits, - and _, " +
                       std::to_string(kNameMax) + " at most; --name gives it another one",
                   kWrongName});
  }
  if (!options.from.empty()) return new_from(options, name, out);
  const fs::path world = options.folder / (name + ".wrl"), scenario = options.folder / (name + ".toml");
  for (const fs::path& file : {world, scenario}) {
    std::error_code ignored;  // what can't be asked for can't be written either, which says why
    if (fs::exists(file, ignored)) return failed({"error: there is a file " + file.string() + " already", kWrongName});
  }
  std::error_code error;
  fs::create_directories(options.folder, error);
  if (error) return failed({"error: no folder " + options.folder.string() + ": " + error.message(), kCantWrite});
  for (const auto& [file, text] : {std::pair(world, kNewWorld), std::pair(scenario, kNewScenario)}) {
    if (const auto written = write_new(file, filled(text, name)); !written) return failed(written.error());
  }
  const std::string w = world.string(), s = scenario.string();
  out << "wrote " << w << " and " << s << "\n\nTry it:\n  peerd check " << w << "\n  peerd sim " << s
      << "\n  peerd view out/" << name << "\n\nAs two real peers, in two terminals, with a page each:\n  peerd run -c "
      << s << " --peer a --view\n  peerd run -c " << s << " --peer b --view\n";
  return 0;
}

}  // namespace peerd
