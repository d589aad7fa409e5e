#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

// Worlds that live by themselves, made by chance, as plain data. What makes their text, and the oracle that says where
// everything is, both read these structs; nothing here is of the project's libraries.
namespace peerd::living {

using Three = std::array<float, 3>;  // [m], as the file has it
using Turn = std::array<float, 4>;   // an axis, not unit, and an angle [rad]

// A TimeSensor. It runs from start_s on, until stop_s where that is later; without `loop`, for one cycle at most.
struct Clock {
  double cycle_s = 1.0, start_s = 0.0, stop_s = 0.0;
  bool loop = true;
};

// An interpolator and its ROUTEs: from fraction key[i] to key[i + 1] the field goes from value[i] to value[i + 1], the
// shorter way where it is a rotation. Until its clock starts the field is as the file has it.
template <class V>
struct Path {
  int clock = -1;            // into World::clocks; none: nothing drives the field
  std::vector<float> key{};  // not decreasing, the first is 0 and the last is 1; at equal keys the value jumps
  std::vector<V> value{};
  [[nodiscard]] bool drives() const { return clock >= 0; }
};

enum class FormKind : std::uint8_t { kBox, kCone, kCylinder, kSphere, kFaces };

struct Form {
  FormKind kind = FormKind::kBox;
  Three size{};  // the edges of a Box; radius and height of a Cone or a Cylinder; radius of a Sphere
  // Faces only. The triangles cover the polygons, which are flat, or triangles themselves where the points move.
  std::vector<Three> points{};
  std::vector<std::vector<int>> polygons{};
  std::vector<std::array<int, 3>> triangles{};
  Path<std::vector<Three>> bend{};  // of all points
};

enum class NodeKind : std::uint8_t { kGroup, kTransform, kShape };

// Nobody owns a node with an owner of -1.
struct Node {
  NodeKind kind = NodeKind::kGroup;
  int parent = -1;
  int use_of = -1;  // the node that it is another instance of; its own children are instances of that one's
  int owner = -1;   // into World::peers
  int form = -1;    // of a Shape, into World::forms
  Three translation{}, scale{1, 1, 1}, center{}, velocity{};
  Turn rotation{0, 0, 1, 0}, scale_orientation{0, 0, 1, 0};
  Path<Three> translations{}, scales{};
  Path<Turn> rotations{};

  // Whether the fields of this node change.
  [[nodiscard]] bool moves() const {
    return translations.drives() || scales.drives() || rotations.drives() || velocity != Three{};
  }
};

enum class InterestType : std::uint8_t { kBox, kWitness, kAllPairs };

struct Interest {
  int collider = -1;
  std::vector<int> collidees{};
  InterestType type = InterestType::kBox;
};

struct World {
  std::uint64_t seed = 0;
  double duration_s = 0.0;
  int latency_ms = 0, tick_hz = 60;
  std::vector<std::string> peers{};  // ids are 1, 2, ..
  std::vector<Clock> clocks{};
  std::vector<Form> forms{};
  std::vector<Node> nodes{};  // a parent before its children, and all that is below a node right behind it
  std::vector<Interest> interests{};
  std::string decoration{};  // VRML of interpolators that drive nothing that collides
};

// Of 4 to 14 moving Transforms in trees of up to five levels, whose fields are driven by interpolators or, where
// nothing drives them, by a velocityVector; uneven and mirrored scales; primitives, open and concave face sets, and
// face sets that bend; interests of all types between any nodes. One peer, two or none owns some of those that a
// velocityVector moves. Nothing answers its contacts. The same seed gives the same world on every machine.
[[nodiscard]] World make_world(std::uint64_t seed);

[[nodiscard]] std::string path_of(const World& world, int node);  // as an interest names it
[[nodiscard]] std::string vrml_of(const World& world);
[[nodiscard]] std::string scenario_of(const World& world);  // TOML; its world is living.wrl

}  // namespace peerd::living
