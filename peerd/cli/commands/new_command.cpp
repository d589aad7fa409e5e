#include "peerd/cli/commands/new_command.hpp"

#include <algorithm>
#include <cctype>
#include <fstream>
#include <ostream>
#include <string_view>
#include <system_error>
#include <utility>

#include "peerd/cli/shell/print.hpp"
#include "peerd/input/input_error.hpp"

namespace peerd {
namespace {

namespace fs = std::filesystem;

constexpr int kWrongName = 2, kCantWrite = 3;
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

std::string with_name(std::string_view text, std::string_view name) {
  constexpr std::string_view kPlace = "NAME";
  std::string filled(text);
  for (auto at = filled.find(kPlace); at != std::string::npos; at = filled.find(kPlace, at + name.size())) {
    filled.replace(at, kPlace.size(), name);
  }
  return filled;
}

// Error: the file can't be written, or another one has its name.
Result<void> write_new(const fs::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary | std::ios::noreplace);
  out << text;
  out.close();
  if (!out) return std::unexpected(InputError{"error: " + file.string() + " can't be written", kCantWrite});
  return {};
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
  const fs::path world = options.folder / (name + ".wrl"), scenario = options.folder / (name + ".toml");
  for (const fs::path& file : {world, scenario}) {
    std::error_code ignored;  // what can't be asked for can't be written either, which says why
    if (fs::exists(file, ignored)) return failed({"error: there is a file " + file.string() + " already", kWrongName});
  }
  std::error_code error;
  fs::create_directories(options.folder, error);
  if (error) return failed({"error: no folder " + options.folder.string() + ": " + error.message(), kCantWrite});
  for (const auto& [file, text] : {std::pair(world, kNewWorld), std::pair(scenario, kNewScenario)}) {
    if (const auto written = write_new(file, with_name(text, name)); !written) return failed(written.error());
  }
  const std::string w = world.string(), s = scenario.string();
  out << "wrote " << w << " and " << s << "\n\nTry it:\n  peerd check " << w << "\n  peerd sim " << s
      << "\n  peerd view out/" << name << "\n\nAs two real peers, in two terminals, with a page each:\n  peerd run -c "
      << s << " --peer a --view\n  peerd run -c " << s << " --peer b --view\n";
  return 0;
}

}  // namespace peerd
