#include "core/motion/inert_parts.hpp"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/geometry/tessellate.hpp"
#include "core/motion/carriers.hpp"
#include "core/motion/key_sensors.hpp"
#include "core/motion/predefined_motion.hpp"
#include "core/motion/sensor_events.hpp"
#include "core/vrml/document.hpp"

namespace peerd {
namespace {

using vrml::Access;
using vrml::FieldSpec;
using vrml::NodeRole;
using vrml::Position;

// Warnings of one text, each at its places.
class Notes {
 public:
  void add(Position at, const std::string& text) { places_[text].insert(at); }
  void write(vrml::Problems& problems) const {
    for (const auto& [text, places] : places_) {
      const std::size_t more = places.size() - 1;
      problems.warning(*places.begin(), more == 0 ? text : text + " (and " + std::to_string(more) + " more like it)");
    }
  }

 private:
  std::map<std::string, std::set<Position>> places_;
};

// Finds the ROUTEs that are never run. Events come from TimeSensors alone (PredefinedMotion); what KeySensors and
// Scripts send or take is warned of where the scene is built.
class RouteCheck {
 public:
  RouteCheck(const vrml::Document& document, vrml::Problems& problems, Notes& notes)
      : document_(document), problems_(problems), notes_(notes) {}

  void check() {
    if (document_.routes.empty()) return;
    for (std::uint32_t r = 0; r < document_.routes.size(); ++r) {
      const vrml::Route& route = document_.routes[r];
      from_[{route.from_node, route.from}].push_back(r);
    }
    find_live();
    find_bending();
    for (const vrml::Route& route : document_.routes) check(route);
  }

 private:
  // A field that sends or takes events; an exposedField does both.
  using Port = std::pair<std::uint32_t, const FieldSpec*>;

  [[nodiscard]] const vrml::NodeType& type_of(std::uint32_t node) const { return *document_.nodes[node].type; }
  [[nodiscard]] bool is_interpolator(std::uint32_t node) const { return type_of(node).name.ends_with("Interpolator"); }
  // Whether warnings name what the node does not do already: a KeySensor, a Script, an EXTERNPROTO that was not found.
  [[nodiscard]] bool is_named(std::uint32_t node) const {
    const vrml::NodeType& type = type_of(node);
    return type.role == NodeRole::kKeySensor || vrml::find_node_type(type.name) != &type;
  }

  void find_live() {
    std::vector<Port> reached;
    for (const auto& [port, routes] : from_) {
      if (type_of(port.first).name == "TimeSensor" && port.second->access == Access::kEventOut) reached.push_back(port);
    }
    live_.insert(reached.begin(), reached.end());
    while (!reached.empty()) {
      const auto at = from_.find(reached.back());
      reached.pop_back();
      if (at == from_.end()) continue;
      for (const std::uint32_t r : at->second) {
        const vrml::Route& route = document_.routes[r];
        if (is_named(route.to_node)) continue;
        Port next{route.to_node, route.to};
        if (is_interpolator(route.to_node)) {
          if (route.to->name != "set_fraction") continue;  // keys take no ROUTEs
          next.second = vrml::find_field(type_of(route.to_node), "value_changed");
        }
        if (live_.insert(next).second) reached.push_back(next);
      }
    }
  }

  void find_bending() {
    for (const vrml::Node& node : document_.nodes) {
      const vrml::Field* const coord = node.type->name == "IndexedFaceSet" ? node.find("coord") : nullptr;
      if (coord != nullptr && coord->count == 1) bending_.insert(coord->as<vrml::NodeRef>()[0].index);
    }
  }

  [[nodiscard]] bool moves(const vrml::Route& route) const {
    const std::string_view name = route.to->name;
    switch (type_of(route.to_node).role) {
      case NodeRole::kTransform:
        return name == "translation" || name == "rotation" || name == "scale" || name == "scaleOrientation" ||
               name == "center";
      default:
        return type_of(route.to_node).name == "TimeSensor" || is_interpolator(route.to_node) ||
               (name == "point" && bending_.contains(route.to_node));
    }
  }

  // Whether a viewer's page runs the ROUTE, by an edit.
  [[nodiscard]] bool is_run_by_people(const vrml::Route& route) const {
    const auto events = events_by_people(type_of(route.from_node).name);
    return route.to->access == Access::kExposedField && std::ranges::find(events, route.from->name) != events.end();
  }

  void check(const vrml::Route& route) {
    const std::string_view from = type_of(route.from_node).name, to = type_of(route.to_node).name;
    if (route.from->name == "notColliding" && type_of(route.from_node).role == NodeRole::kTransform) {
      problems_.warning(route.at,
                        "no peer runs this ROUTE from notColliding: peers find contacts at different times, and what "
                        "ROUTEs move must be the same function of world time on all of them");
      return;
    }
    if (is_named(route.from_node) || is_named(route.to_node)) return;
    if (!live_.contains({route.from_node, route.from})) {
      if (is_run_by_people(route)) return;
      notes_.add(route.at, "this ROUTE is never run: no TimeSensor leads to it, and nothing else makes a " +
                               std::string(from) + " send events in a peer");
      return;
    }
    const bool goes_on = from_.contains({route.to_node, route.to});
    if (goes_on || moves(route)) return;
    if (type_of(route.to_node).role == NodeRole::kDisplay || to == "Coordinate") {
      notes_.add(route.at, "no peer runs this ROUTE: what it changes is only seen or heard");
    } else {
      notes_.add(route.at, "no peer runs this ROUTE: " + std::string(to) + '.' + std::string(route.to->name) +
                               " stays as the file has it");
    }
  }

  const vrml::Document& document_;
  vrml::Problems& problems_;
  Notes& notes_;
  std::map<Port, std::vector<std::uint32_t>> from_;  // the ROUTEs that begin there
  std::set<Port> live_;                              // ports that events of TimeSensors reach
  std::set<std::uint32_t> bending_;                  // Coordinates of IndexedFaceSets
};

// Finds the fields of nodes that do nothing.
class NodeCheck {
 public:
  NodeCheck(const Scene& scene, bool maps_hierarchies, Notes& notes)
      : scene_(scene), nodes_(scene.document->nodes), maps_hierarchies_(maps_hierarchies), notes_(notes) {}

  void check() {
    check_shapes();
    check_ends();
    check_transforms();
    check_billboards();
  }

 private:
  void check_shapes() {
    for (const vrml::Node& node : nodes_) {
      if (node.type->role != NodeRole::kShape) continue;
      for (const vrml::Field& field : node.given()) {
        const std::string_view name = field.spec->name;
        if (name == "splitThreshold" && field.as<std::int32_t>()[0] != ShapeFields{}.split_threshold) {
          notes_.add(field.at,
                     "splitThreshold does nothing: it is of the plain k-DOP tree, and another engine is in use");
        } else if (name == "convexHull" && field.count > 0) {
          notes_.add(field.at, "convexHull does nothing: it is of the plain k-DOP tree, and another engine is in use");
        } else if (name == "hierarchyFile" && !maps_hierarchies_ && !field.as<std::string_view>()[0].empty()) {
          notes_.add(field.at,
                     "hierarchyFile is for peerd bake and peerd collide: a peer builds its hierarchies itself");
        }
      }
    }
  }

  void check_ends() {
    auto interest = scene_.interests.begin();
    for (const vrml::Node& node : nodes_) {
      if (node.type->role != NodeRole::kCollisionInterest) continue;
      assert(interest != scene_.interests.end() && "a good world has an interest for each of these nodes");
      const vrml::Field* const list = node.find(node.find("interests") != nullptr ? "interests" : "collisionInterests");
      colliders_.insert(interest->colliders.ends.begin(), interest->colliders.ends.end());
      check_side(interest->colliders, node.find("objectPath")->at);
      check_side(interest->collidees, list->at);
      ++interest;
    }
  }

  // A pattern may find nodes without polygons among others. They are reported only where the pattern finds no node with
  // polygons.
  void check_side(const InterestSide& side, Position at) {
    const std::span<const ObjectId> ends(side.ends), found = ends.subspan(side.named);
    const bool finds_some = std::ranges::any_of(found, [&](ObjectId end) { return collides(end); });
    for (const ObjectId end : finds_some ? ends.first(side.named) : ends) check_end(end, at);
  }

  // An end of several interests is reported where it is first named.
  void check_end(ObjectId end, Position at) {
    if (!ends_.insert(end).second || collides(end)) return;
    notes_.add(at, "interests in " + vrml::quoted(scene_.path_of(end)) + " find nothing: no polygons in it collide");
  }

  [[nodiscard]] bool collides(ObjectId id) {
    if (solid_before_.empty()) count_solid();
    return solid_before_[scene_.at(id).subtree_end] > solid_before_[scene_.index_of(id)];
  }

  void count_solid() {
    std::vector<std::optional<bool>> has_polygons(scene_.geometries.size());
    solid_before_.push_back(0);
    for (const Instance& i : scene_.instances) {
      bool solid = i.collides && i.geometry != Instance::kNone;
      if (solid) {
        std::optional<bool>& known = has_polygons[i.geometry];
        if (!known) known = mesh_size(scene_.geometries[i.geometry], scene_.tessellation).polygons > 0;
        solid = *known;
      }
      solid_before_.push_back(solid_before_.back() + (solid ? 1 : 0));
    }
  }

  void check_transforms() {
    std::vector<ObjectId> extended;
    for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
      const Instance& instance = scene_.instances[i];
      if (instance.kind == NodeKind::kTransform && instance.extension != Instance::kNone)
        extended.push_back(scene_.id_of(i));
    }
    if (extended.empty() && scene_.key_sensors.empty()) return;
    const PredefinedMotion motion(scene_);
    const Carriers carriers(scene_, motion, {});
    for (const ObjectId id : extended) {
      check_velocity(id, motion);
      check_response(id);
      if (carriers.distorted(id)) {
        check_distorted(id);
      } else if (scene_.object(id).enslaved && !motion.fields_of(id).empty()) {
        notes_.add(place(id, "enslaved"), "enslaved gives this node no owner: a ROUTE moves it, the same on all peers");
      }
    }
    for (const auto& [node, why] : idle_responses_) {
      if (!why.empty())
        notes_.add(nodes_[node].find("collisionResponse")->at, "collisionResponse does nothing: " + why);
    }
    for (const KeySensor& sensor : scene_.key_sensors) {
      if (const auto key = key_of(sensor); !key) {
        notes_.add(nodes_[sensor.node].find("key")->at, "this KeySensor gets no key: " + key.error());
      }
      if (!sensor.recipient || !carriers.distorted(*sensor.recipient)) continue;
      notes_.add(nodes_[sensor.node].find("recipient")->at, "this KeySensor moves nothing: " + std::string(kDistorted));
    }
  }

  [[nodiscard]] Position place(ObjectId id, std::string_view field) const {
    const vrml::Field* const given = nodes_[scene_.at(id).node].find(field);
    assert(given != nullptr);
    return given->at;
  }

  void check_velocity(ObjectId id, const PredefinedMotion& motion) {
    if (scene_.object(id).velocity.isZero(0.0) || motion.drifts(id)) return;
    notes_.add(place(id, "velocityVector"),
               "velocityVector counts only while a peer owns this node: a ROUTE drives its translation");
  }

  void check_distorted(ObjectId id) {
    const ObjectFields& object = scene_.object(id);
    const auto name = [&](std::string_view field) {
      notes_.add(place(id, field), std::string(field) + " does nothing: " + std::string(kDistorted));
    };
    if (object.enslaved) name("enslaved");
    if (object.remote) name("remote");
    if (object.distance_threshold_m != ObjectFields{}.distance_threshold_m) name("distanceThreshold");
    if (object.response) name("collisionResponse");
  }

  // The restitution of an IMPULSE counts for a collidee that does not respond, too; its friction counts without any
  // contact. A node may be in the scene several times, and what acts for one of them acts.
  void check_response(ObjectId id) {
    const auto& response = scene_.object(id).response;
    if (!response) return;
    const bool impulse = response->type == ResponseType::kImpulse;
    std::string why;
    if (!ends_.contains(id) && !(impulse && response->friction_m_s2 > 0.0)) {
      why = "no CollisionInterest names this node";
    } else if (ends_.contains(id) && !colliders_.contains(id) && !impulse) {
      why = "this node is the objectPath of no CollisionInterest";
    }
    const auto [known, is_new] = idle_responses_.try_emplace(scene_.at(id).node, why);
    if (!is_new && why.empty()) known->second.clear();
  }

  // Collision knows no viewer towards which one turns.
  void check_billboards() {
    for (std::uint32_t i = 0; i < scene_.instances.size(); ++i) {
      const Instance& instance = scene_.instances[i];
      if (instance.kind != NodeKind::kBillboard) continue;
      bool concerned = std::ranges::any_of(ends_, [&](ObjectId end) { return scene_.is_within(end, scene_.id_of(i)); });
      for (std::int32_t up = instance.parent; up >= 0 && !concerned;) {
        const auto above = static_cast<std::uint32_t>(up);
        concerned = ends_.contains(scene_.id_of(above));
        up = scene_.instances[above].parent;
      }
      if (concerned)
        notes_.add(nodes_[instance.node].at, "this Billboard collides as the file has it: it is not turned");
    }
  }

  static constexpr std::string_view kDistorted =
      "no owner moves what a driven scale changes, or what turns below an uneven scale";

  const Scene& scene_;
  const std::vector<vrml::Node>& nodes_;
  bool maps_hierarchies_;
  Notes& notes_;
  std::set<ObjectId> ends_, colliders_;
  std::vector<std::uint32_t> solid_before_;              // the number of Shapes that collide before each instance
  std::map<std::uint32_t, std::string> idle_responses_;  // by node; empty: it acts
};

}  // namespace

void warn_of_inert_parts(ReadResult& result, bool maps_hierarchies) {
  if (!result.scene) return;
  vrml::Problems problems;
  for (Source& source : result.sources) {
    [[maybe_unused]] const auto begin = problems.open(std::move(source));
    assert(begin && "they have been open before");
  }
  Notes notes;
  RouteCheck(*result.scene->document, problems, notes).check();
  NodeCheck(*result.scene, maps_hierarchies, notes).check();
  notes.write(problems);
  auto report = problems.take();
  result.sources = std::move(report.sources);
  std::vector<Diagnostic> all;
  std::ranges::merge(
      result.diagnostics, report.diagnostics, std::back_inserter(all), {},
      [](const Diagnostic& d) { return std::pair(d.source, d.offset); },
      [](const Diagnostic& d) { return std::pair(d.source, d.offset); });
  result.diagnostics = std::move(all);
}

}  // namespace peerd
