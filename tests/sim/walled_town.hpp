#pragma once
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

#include "tests/sim/chance.hpp"

// A generated town of walled districts, in two rows. Two peers run its traffic: cars that are driven round the blocks,
// boxes that lie about, and bodies that bounce about without end; boxes of nobody's lie about, too. In every second
// district a viewer owns the first car and the first box, and looks out of that car, ahead and by a mirror. The same
// numbers make the same town.
namespace peerd::sim::testing_support {

struct TownSize {
  int columns = 5, cars = 30, boxes = 2, bodies = 0;  // of each of two rows; of each district
  int loose = 0;                                      // boxes of nobody, of each district
  std::uint64_t seed = 1;
};

struct Town {
  std::string world, scenario;       // texts; the scenario names its world "../worlds/walled-town.wrl"
  std::vector<std::string> viewers;  // names of the peers that look, by district
};

class TownWriter {
 public:
  explicit TownWriter(const TownSize& size) : size_(size), chance_(size.seed) {}

  Town write() {
    for (int d = 0; d < 2 * size_.columns; ++d) add_district(d);
    add_interests();
    Town town{kHead + world_, kScenarioHead, {}};
    for (const bool east : {false, true}) {
      town.scenario += std::string("\n[peer.") + (east ? "east" : "west") + "]\nid = " + (east ? "2" : "1") +
                       "\nowns = [\"*_?_" + (east ? "E" : "W") + "*\"" + (east ? east_ : west_) + "]\n";
    }
    town.scenario += tables_ + kExpectations;
    town.viewers = viewers_;
    return town;
  }

 private:
  static constexpr double kDistrict_m = 160.0, kBlock_m = 60.0, kWall_m = 72.0;
  inline static const std::string kHead =
      "#VRML V2.0 utf8\n\n"
      "# Walled districts with cars and boxes; tests/sim/walled_town.hpp makes this town.\n"
      "Viewpoint { position 0 300 250 orientation 1 0 0 -0.9 }\n"
      "Switch {\n  choice [\n"
      "    DEF ALONG Shape { geometry Box { size 144 3 0.5 } }\n"
      "    DEF ACROSS Shape { geometry Box { size 0.5 3 144 } }\n"
      "    DEF HOUSE Shape { geometry Box { size 40 3 40 } }\n"
      "    DEF HULL Shape { geometry Box { size 1.8 1.2 4.4 } }\n"
      "    DEF CRATE Shape { geometry Box { size 0.8 0.8 0.8 } }\n"
      "  ]\n}\n";

  inline static const std::string kExpectations =
      "\n# What the report must show (docs/reference/configuration.md, [expect.NAME]).\n"
      "[expect.peers-show-the-same]\nthat = \"counters.ghosts_differ\"\nequals = 0\n"
      "\n[expect.same-at-rest]\nthat = \"rest.ghost_error_max_m\"\nat_most = 1e-6\nobject = \"BOX_*\"\n"
      "observer = \"west\"\n";
  inline static const std::string kScenarioHead =
      "# Traffic in a town of walled districts, of which each of five viewers sees a tenth: contacts that nobody sees "
      "are not\n"
      "# predicted (docs/reference/configuration.md, skip_unseen). tests/sim/walled_town.hpp makes this scenario.\n"
      "#\n"
      "#   peerd sim configs/scenarios/walled-town.toml\n\n"
      "world = \"../worlds/walled-town.wrl\"\nduration_s = 8\n\n[network]\nlatency_ms = 60\njitter_ms = 10\n";

  static std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2f", value);
    return text;
  }
  static std::string at(double x, double y, double z) {
    return "translation " + number(x) + " " + number(y) + " " + number(z);
  }
  static std::string interest(const std::string& of, const std::string& in) {
    return "CollisionInterest { objectPath \"" + of + "\" interests [" + in + " ] collisionType 1 }\n";
  }

  // A place beside or in a street of the district about (x, z).
  std::string in_a_street(double x, double height, double z, double aside, double along) {
    const double street = kBlock_m * (static_cast<double>(chance_.below(3)) - 1.0) + aside;
    const double way = kBlock_m * (static_cast<double>(chance_.below(2)) - 0.5) + along;
    const bool is_across = chance_.happens(0.5);
    return at(x + (is_across ? street : way), height, z + (is_across ? way : street));
  }

  void add_walls(const std::string& name, double x, double z) {
    world_ += "DEF WALLS_" + name + " Group {\n  children [\n";
    const auto wall = [&](double dx, double dz, const char* shape) {
      world_ += "    Transform { " + at(x + dx, 1.5, z + dz) + " children USE " + shape + " }\n";
    };
    for (const double side : {-kWall_m, kWall_m}) {
      wall(0.0, side, "ALONG");
      wall(side, 0.0, "ACROSS");
    }
    for (const double dx : {-kBlock_m / 2, kBlock_m / 2}) {
      for (const double dz : {-kBlock_m / 2, kBlock_m / 2}) wall(dx, dz, "HOUSE");
    }
    world_ += "  ]\n}\n";
  }

  void add_movable(const std::string& object, const std::string& place, const std::string& more) {
    world_ += "DEF " + object + " Transform { " + place + " distanceThreshold 0.25 " + more + " children USE CRATE }\n";
  }

  void add_district(int d) {
    const std::string name(1, static_cast<char>('A' + d)), viewer(1, static_cast<char>('a' + d));
    const double x = kDistrict_m * (d % size_.columns - 0.5 * (size_.columns - 1));
    const double z = kDistrict_m * (d / size_.columns - 0.5);
    const bool has_viewer = d % 2 == 0;
    add_walls(name, x, z);
    for (int i = 0; i < size_.cars; ++i) {
      const bool of_viewer = has_viewer && i == 0;
      const std::string car = "CAR_" + name + (of_viewer ? "_" : "_T") + std::to_string(i);
      const double lane = chance_.one_of({-1.75, 1.75});
      world_ += "DEF " + car + " Transform { " + in_a_street(x, 0.7, z, lane, chance_.between(-12.0, 12.0)) +
                " children USE HULL }\n";
    }
    interests_ += interest("CAR_" + name + "_*", " \"WALLS_" + name + "\"");
    (d / 2 % 2 == 0 ? west_ : east_) += ", \"CAR_" + name + "_T*\"";
    for (int i = 0; i < size_.boxes; ++i) {
      const bool of_viewer = has_viewer && i == 0;
      const std::string box = "BOX_" + name + (of_viewer ? "_" : i % 2 == 0 ? "_W" : "_E") + std::to_string(i);
      add_movable(box, in_a_street(x, 0.5, z, chance_.between(-3.0, 3.0), chance_.between(-22.0, 22.0)),
                  "collisionResponse CollisionResponse { responseType 2 mass 20 restitution 0.9 friction 6 }");
    }
    for (int i = 0; i < size_.bodies; ++i) {
      const std::string body = "BODY_" + name + (i % 2 == 0 ? "_W" : "_E") + std::to_string(i);
      add_movable(body, in_a_street(x, 1.6, z, chance_.between(-3.0, 3.0), chance_.between(-22.0, 22.0)),
                  "velocityVector " + number(chance_.between(-9, 9)) + " 0 " + number(chance_.between(-9, 9)) +
                      " collisionResponse CollisionResponse { responseType 2 mass 5 }");
    }
    for (int i = 0; i < size_.loose; ++i) {
      add_movable("LOOSE_" + name + std::to_string(i),
                  in_a_street(x, 0.5, z, chance_.between(-3.0, 3.0), chance_.between(-22.0, 22.0)),
                  "collisionResponse CollisionResponse { responseType 2 mass 20 restitution 0.5 friction 6 }");
    }
    tables_ += "\n[motion.\"CAR_" + name + "_*\".drive]\nspeed_m_s = 11\norigin_m = [" + number(x - kBlock_m) + ", " +
               number(z - kBlock_m) + "]\nblock_m = 60\nblocks = 2\n";
    if (!has_viewer) return;
    tables_ += "\n[peer." + viewer + "]\nid = " + std::to_string(d + 3) + "\nowns = [\"CAR_" + name + "_0\", \"BOX_" +
               name + "_0\"]\nskip_unseen = true\n\n[peer." + viewer + ".viewpoint]\nobject = \"CAR_" + name +
               "_0\"\nposition = [0, 1, 0]\nfield_of_view_deg = 75\nfar_m = 180\n\n[[peer." + viewer +
               ".view]]\nobject = \"CAR_" + name +
               "_0\"\nposition = [0, 1, 0]\nangle_deg = 180\nfield_of_view_deg = 20\nfar_m = 60\n";
    viewers_.push_back(viewer);
  }

  // What can move answers walls, cars, and what else can move, which answers it.
  void add_interests() {
    std::vector<std::string> movables;
    if (size_.boxes > 0) movables.emplace_back("BOX_*");
    if (size_.bodies > 0) movables.emplace_back("BODY_*");
    if (size_.loose > 0) movables.emplace_back("LOOSE_*");
    std::string all = " \"WALLS_*\" \"CAR_*\"";
    for (const std::string& each : movables) all += " \"" + each + "\"";
    world_ += interests_;
    for (const std::string& each : movables) world_ += interest(each, all);
  }

  TownSize size_;
  Chance chance_;
  std::string world_, tables_, interests_, west_, east_;
  std::vector<std::string> viewers_;
};

inline Town walled_town(const TownSize& size) { return TownWriter(size).write(); }

}  // namespace peerd::sim::testing_support
