// The text of a world and of its scenario.
#include <cstddef>
#include <set>
#include <span>
#include <sstream>

#include "tests/sim/living/world.hpp"

namespace peerd::living {
namespace {

// Digits that bring a binary32 and a binary64 number back to the last bit.
std::string text_of(float number) {
  std::ostringstream text;
  text.precision(9);
  text << number;
  return text.str();
}
std::string text_of(double number) {
  std::ostringstream text;
  text.precision(17);
  text << number;
  return text.str();
}
template <std::size_t N>
std::string text_of(const std::array<float, N>& numbers) {
  std::string text;
  for (const float number : numbers) text += (text.empty() ? "" : " ") + text_of(number);
  return text;
}
template <class V>
std::string list_of(const std::vector<V>& values) {
  std::string text = "[";
  for (const V& value : values) text += (text.size() == 1 ? " " : ", ") + text_of(value);
  return text + " ]";
}

std::string name_of(const World& world, int node) {
  const Node& n = world.nodes[std::size_t(node)];
  const char letter = n.kind == NodeKind::kGroup ? 'G' : n.kind == NodeKind::kTransform ? 'T' : 'S';
  return letter + std::to_string(n.use_of < 0 ? node : n.use_of);
}

class Writer {
 public:
  explicit Writer(const World& world) : world_(world) {}

  std::string text() {
    out_ << "#VRML V2.0 utf8\n# The world that lives by seed " << world_.seed << ".\n";
    for (std::size_t i = 0; i < world_.clocks.size(); ++i) add_clock(i);
    for (int i = 0; i < int(world_.nodes.size()); ++i) {
      if (world_.nodes[std::size_t(i)].parent < 0) add_node(i, "");
    }
    out_ << world_.decoration;
    for (int i = 0; i < int(world_.nodes.size()); ++i) add_paths(i);
    for (std::size_t i = 0; i < world_.forms.size(); ++i) add_bend(i);
    for (const Interest& interest : world_.interests) add_interest(interest);
    out_ << "WorldInfo { worldTimes TRUE }\n";
    return out_.str();
  }

 private:
  void add_clock(std::size_t i) {
    const Clock& clock = world_.clocks[i];
    out_ << "DEF CLOCK" << i << " TimeSensor { cycleInterval " << text_of(clock.cycle_s) << " loop "
         << (clock.loop ? "TRUE" : "FALSE") << " startTime " << text_of(clock.start_s) << " stopTime "
         << text_of(clock.stop_s) << " }\n";
  }

  void add_node(int i, const std::string& indent) {
    const Node& node = world_.nodes[std::size_t(i)];
    const bool is_use = node.use_of >= 0;
    out_ << indent << (is_use ? "USE " : "DEF ") << name_of(world_, i);
    if (is_use) {
      out_ << '\n';
      return;
    }
    if (node.kind == NodeKind::kShape) {
      out_ << " Shape { geometry ";
      add_form(std::size_t(node.form));
      out_ << " }\n";
      return;
    }
    out_ << (node.kind == NodeKind::kGroup ? " Group {" : " Transform {");
    add_fields(node);
    out_ << " children [\n";
    for (int child = i + 1; child < int(world_.nodes.size()); ++child) {
      if (world_.nodes[std::size_t(child)].parent == i) add_node(child, indent + "  ");
    }
    out_ << indent << "] }\n";
  }

  void add_fields(const Node& node) {
    const Node plain;
    if (node.translation != plain.translation) out_ << " translation " << text_of(node.translation);
    if (node.rotation != plain.rotation) out_ << " rotation " << text_of(node.rotation);
    if (node.scale != plain.scale) out_ << " scale " << text_of(node.scale);
    if (node.scale_orientation != plain.scale_orientation) {
      out_ << " scaleOrientation " << text_of(node.scale_orientation);
    }
    if (node.center != plain.center) out_ << " center " << text_of(node.center);
    if (node.velocity != plain.velocity) out_ << " velocityVector " << text_of(node.velocity);
  }

  void add_form(std::size_t i) {
    if (!written_.insert(i).second) {
      out_ << "USE FORM" << i;
      return;
    }
    const Form& form = world_.forms[i];
    out_ << "DEF FORM" << i << ' ';
    switch (form.kind) {
      case FormKind::kBox:
        out_ << "Box { size " << text_of(form.size) << " }";
        break;
      case FormKind::kCone:
        out_ << "Cone { bottomRadius " << text_of(form.size[0]) << " height " << text_of(form.size[1]) << " }";
        break;
      case FormKind::kCylinder:
        out_ << "Cylinder { radius " << text_of(form.size[0]) << " height " << text_of(form.size[1]) << " }";
        break;
      case FormKind::kSphere:
        out_ << "Sphere { radius " << text_of(form.size[0]) << " }";
        break;
      case FormKind::kFaces:
        out_ << "IndexedFaceSet { convex FALSE solid FALSE coord DEF POINTS" << i << " Coordinate { point "
             << list_of(form.points) << " } coordIndex [";
        for (const auto& polygon : form.polygons) {
          for (const int corner : polygon) out_ << ' ' << corner;
          out_ << " -1";
        }
        out_ << " ] }";
    }
  }

  void add_routes(int clock, const std::string& name, const std::string& field) {
    out_ << "ROUTE CLOCK" << clock << ".fraction_changed TO " << name << ".set_fraction\nROUTE " << name
         << ".value_changed TO " << field << '\n';
  }
  template <class V>
  void add_path(const Path<V>& path, const std::string& name, const char* interpolator, const std::string& field) {
    if (!path.drives()) return;
    out_ << "DEF " << name << ' ' << interpolator << " { key " << list_of(path.key) << " keyValue "
         << list_of(path.value) << " }\n";
    add_routes(path.clock, name, field);
  }

  void add_paths(int i) {
    const Node& node = world_.nodes[std::size_t(i)];
    if (node.use_of >= 0) return;
    const std::string name = name_of(world_, i);
    add_path(node.translations, "WAY_" + name, "PositionInterpolator", name + ".set_translation");
    add_path(node.rotations, "TURN_" + name, "OrientationInterpolator", name + ".set_rotation");
    add_path(node.scales, "SCALE_" + name, "PositionInterpolator", name + ".scale");
  }

  void add_bend(std::size_t i) {
    const auto& bend = world_.forms[i].bend;
    if (!bend.drives()) return;
    out_ << "DEF BEND" << i << " CoordinateInterpolator { key " << list_of(bend.key) << " keyValue [";
    for (const auto& points : bend.value) {
      for (const Three& point : points) out_ << ' ' << text_of(point) << ',';
    }
    out_ << " ] }\n";
    add_routes(bend.clock, "BEND" + std::to_string(i), "POINTS" + std::to_string(i) + ".set_point");
  }

  void add_interest(const Interest& interest) {
    // The thesis's listing 3.3 has another name of the field than its appendix C.1.
    const char* field = interest.type == InterestType::kWitness ? "collisionInterests" : "interests";
    out_ << "CollisionInterest { collisionType " << int(interest.type) << " objectPath \""
         << path_of(world_, interest.collider) << "\" " << field << " [";
    for (const int collidee : interest.collidees) out_ << " \"" << path_of(world_, collidee) << '"';
    out_ << " ] }\n";
  }

  const World& world_;
  std::ostringstream out_;
  std::set<std::size_t> written_;  // forms
};

}  // namespace

std::string path_of(const World& world, int node) {
  std::string path = name_of(world, node);
  if (world.nodes[std::size_t(node)].use_of < 0) return path;
  // Another instance has no name of its own, so its path is from the top.
  for (int i = world.nodes[std::size_t(node)].parent; i >= 0; i = world.nodes[std::size_t(i)].parent) {
    path = name_of(world, i) + '/' + path;
  }
  return path;
}

std::string vrml_of(const World& world) { return Writer(world).text(); }

std::string scenario_of(const World& world) {
  std::ostringstream toml;
  toml << "world = \"living.wrl\"\nduration_s = " << text_of(world.duration_s)
       << "\nsample_hz = 10\nseed = " << 1 + world.seed % 100'000 << "\n[replication]\ntick_hz = " << world.tick_hz
       << "\n[network]\nlatency_ms = " << world.latency_ms << '\n';
  for (std::size_t p = 0; p < world.peers.size(); ++p) {
    toml << "[peer." << world.peers[p] << "]\nid = " << p + 1 << "\nowns = [";
    const char* comma = "";
    for (int i = 0; i < int(world.nodes.size()); ++i) {
      if (world.nodes[std::size_t(i)].owner != int(p)) continue;
      toml << comma << '"' << path_of(world, i) << '"';
      comma = ", ";
    }
    toml << "]\n";
  }
  return toml.str();
}

}  // namespace peerd::living
