#include "core/scene/interest_reader.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "core/scene/interest_pairs.hpp"
#include "core/vrml/default_values.hpp"
#include "core/vrml/element_positions.hpp"

namespace peerd::vrml {

// A key is known to one peer only, but the movement that a world makes by itself must be the same on all of them.
void InterestReader::check_key_routes() {
  for (const Route& route : document_.routes) {
    const bool from_key = document_.nodes[route.from_node].type->role == NodeRole::kKeySensor;
    const bool to_key = document_.nodes[route.to_node].type->role == NodeRole::kKeySensor;
    if (from_key) routed_keys_.insert(route.from_node);
    if (from_key && !to_key) {
      problems_.warning(route.at,
                        "what a key does reaches other KeySensors only, since no other peer knows of the key: this "
                        "ROUTE to a " +
                            std::string(document_.nodes[route.to_node].type->name) + " is not run for it");
    } else if (to_key && !from_key) {
      problems_.warning(route.at, "a KeySensor takes events of other KeySensors only: this ROUTE from a " +
                                      std::string(document_.nodes[route.from_node].type->name) + " is not run");
    }
  }
}

CollisionType InterestReader::type_of(const Node& node) {
  const Field& type = value_of(node, "collisionType");
  const std::int32_t written = type.as<std::int32_t>()[0];
  if (written > 2) {
    problems_.error(type.at,
                    "collisionType must be 0 (box), 1 (witness) or 2 (all pairs), found " + std::to_string(written));
  }
  return static_cast<CollisionType>(written);
}

std::optional<ObjectId> InterestReader::add_end(InterestSide& side, std::string_view path, std::uint32_t scope,
                                                Position at) {
  const auto parts = parts_of_pattern(path);
  if (!parts) return objects_.find(path, scope, at);
  if (const auto named = objects_.find(path, scope)) return named;
  NamePattern pattern{std::nullopt, std::string(parts->path)};
  if (!parts->below.empty()) {
    pattern.below = objects_.find(parts->below, scope, at);
    if (!pattern.below) return std::nullopt;
  } else if (scope != 0) {
    problems_.error(at, quoted(path) +
                            " names nodes of the whole world: in a PROTO or an Inline a pattern begins with the name "
                            "of a group, as \"GROUP/*\" does");
    return std::nullopt;
  }
  if (paths_.find_all(pattern).empty()) problems_.warning(at, quoted(path) + " finds nothing yet");
  side.patterns.push_back(std::move(pattern));
  return std::nullopt;
}

void InterestReader::add_ends(InterestSide& side, const Node& node, std::string_view field, const InterestSide& others,
                              std::string_view what_they_are) {
  const Field* const list = node.find(field);
  if (list == nullptr) return;
  std::unordered_set<ObjectId> seen(side.ends.begin(), side.ends.end());
  const auto names = list->as<std::string_view>();
  std::optional<ElementPositions> positions;
  if (problems_.kind_of(list->at) == TextKind::kVrml) {  // a side file is not cut again
    positions.emplace(problems_.text_of(list->at), problems_.begin_of(list->at), list->at);
  }
  for (std::size_t i = 0; i < names.size() && !problems_.full(); ++i) {
    const Position at = positions ? positions->at(i) : list->at;
    const auto end = add_end(side, names[i], node.scope, at);
    if (!end) continue;
    if (std::ranges::find(others.ends, *end) != others.ends.end()) {
      problems_.error(at, quoted(names[i]) + " is " + std::string(what_they_are));
    } else if (!seen.insert(*end).second) {
      problems_.warning(at, quoted(names[i]) + " is listed twice; it counts once");
    } else {
      side.ends.push_back(*end);
    }
  }
  side.named = side.ends.size();
}

void InterestReader::add_interest(std::uint32_t index) {
  const Node& node = document_.nodes[index];
  CollisionInterest interest;
  interest.node = index;
  interest.type = type_of(node);
  InterestSide& colliders = interest.colliders;
  if (const Field* const path = node.find("objectPath")) {
    const auto end = add_end(colliders, path->as<std::string_view>()[0], node.scope, path->at);
    if (end) colliders = {{*end}, 1, {}};
  } else if (!node.damaged) {
    problems_.error(node.at, "this CollisionInterest has no objectPath: it must name the node that is registered");
  }
  for (const std::string_view field : {"interests", "collisionInterests"}) {
    add_ends(interest.collidees, node, field, colliders, "the collider itself");
  }
  if (interest.collidees.ends.empty() && interest.collidees.patterns.empty() && !node.damaged) {
    problems_.warning(node.at, "this CollisionInterest has no interests");
  }
  add_ends(interest.except, node, "except", colliders, "the collider");
  if (colliders.ends.empty() && colliders.patterns.empty()) return;
  find_ends(interest, paths_);
  scene_.interests.push_back(std::move(interest));
}

void InterestReader::add_bound_interest(std::uint32_t index, const CollisionInterest& bound) {
  CollisionInterest& interest = scene_.interests.emplace_back(bound);
  interest.node = index;
  interest.type = type_of(document_.nodes[index]);
  find_ends(interest, paths_);
}

void InterestReader::add_key_sensor(std::uint32_t index) {
  const Node& node = document_.nodes[index];
  std::optional<ObjectId> recipient;
  if (const Field* path = node.find("recipient"); path != nullptr && !path->as<std::string_view>()[0].empty()) {
    const std::string_view name = path->as<std::string_view>()[0];
    recipient = objects_.find(name, node.scope, path->at);
    if (!recipient) return;
    if (scene_.contains(*recipient) && scene_.at(*recipient).kind != NodeKind::kTransform) {
      problems_.error(path->at, quoted(name) + " is no Transform: it has no velocity that a key can change");
      return;
    }
  } else if (!routed_keys_.contains(index) && !node.damaged) {
    problems_.warning(node.at, "this KeySensor has no recipient: it moves nothing");
  }
  add_bound_key_sensor(index, recipient);
}

void InterestReader::add_bound_key_sensor(std::uint32_t index, std::optional<ObjectId> recipient) {
  const Node& node = document_.nodes[index];
  const auto velocity = value_of(node, "value").as<float>();
  const auto flag = [&](std::string_view field) { return value_of(node, field).as<bool>()[0]; };
  scene_.key_sensors.push_back({.node = index,
                                .recipient = recipient,
                                .key_value = value_of(node, "keyValue").as<std::int32_t>()[0],
                                .key_state = value_of(node, "keyState").as<std::int32_t>()[0],
                                .value = Vec3(velocity[0], velocity[1], velocity[2]),
                                .key_name = std::string(value_of(node, "key").as<std::string_view>()[0]),
                                .on_release = flag("onRelease"),
                                .absolute = flag("absoluteValue"),
                                .consume = flag("consume"),
                                .enabled = flag("enabled")});
}

}  // namespace peerd::vrml
