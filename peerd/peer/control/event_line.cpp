#include "peerd/peer/control/event_line.hpp"

#include <cassert>

#include <nlohmann/json.hpp>

#include "peerd/input/json_text.hpp"
#include "peerd/peer/feed/json_members.hpp"
#include "peerd/peer/node/edit_operation.hpp"

namespace peerd::control {
namespace {

using namespace replication;
using nlohmann::ordered_json;

// Text of other peers may not be UTF-8: such bytes are replaced.
std::string as_line(const ordered_json& event) { return json_line(event); }

ordered_json event(const char* name) { return {{"v", feed::kMessageVersion}, {"event", name}}; }

const char* name_of(ContactKind kind) {
  switch (kind) {
    case ContactKind::kOwner:
      return "owner";
    case ContactKind::kDecided:
      return "decided";
    case ContactKind::kPredicted:
      return "predicted";
    case ContactKind::kApplied:
      return "applied";
    case ContactKind::kScene:
      return "scene";
  }
  return "?";
}

struct KindOf {
  using Kind = std::optional<EventKind>;
  Kind operator()(const ObjectGiven&) const { return EventKind::kObjects; }
  Kind operator()(const ObjectOrphaned&) const { return EventKind::kObjects; }
  Kind operator()(const ContactSeen&) const { return EventKind::kContacts; }
  Kind operator()(const Overruled&) const { return EventKind::kContacts; }
  Kind operator()(const ContactsRetracted&) const { return EventKind::kContacts; }
  Kind operator()(const PeerJoined&) const { return EventKind::kPeers; }
  Kind operator()(const PeerLost&) const { return EventKind::kPeers; }
  Kind operator()(const DataChanged&) const { return EventKind::kData; }
  Kind operator()(const MessageReceived&) const { return EventKind::kMessages; }
  Kind operator()(const SceneEdited&) const { return EventKind::kEdits; }
  template <class Other>
  Kind operator()(const Other&) const {
    return std::nullopt;
  }
};

struct EventOf {
  const PeerNode& node;

  [[nodiscard]] ordered_json seconds(SimTime at) const { return to_seconds(at.time_since_epoch()); }
  [[nodiscard]] std::string path(ObjectId object) const { return path_or_id(node.scene(), object); }
  [[nodiscard]] static ordered_json id(OperationId operation) {
    return {{"author", operation.author.value}, {"number", operation.number}};
  }
  [[nodiscard]] static ordered_json numbers(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
  [[nodiscard]] static ordered_json owner(PeerId owner) {
    return owner == kNobody ? ordered_json(nullptr) : ordered_json(owner.value);
  }

  ordered_json operator()(const ObjectGiven& g) const {
    ordered_json e = event("owner");
    e.update({{"at_s", seconds(g.at)},
              {"object", path(g.object)},
              {"id", g.object.packed()},
              {"owner", owner(g.owner)},
              {"before", owner(g.before)}});
    return e;
  }
  ordered_json operator()(const ObjectOrphaned& o) const {
    ordered_json e = event("orphaned");
    e.update({{"object", path(o.object)}, {"id", o.object.packed()}, {"before", o.owner.value}});
    return e;
  }
  ordered_json operator()(const ContactSeen& c) const {
    ordered_json e = event("contact");
    e.update({{"at_s", seconds(c.contact.at)},
              {"known_at_s", seconds(c.known_at)},
              {"kind", name_of(c.kind)},
              {"decider", owner(c.decider)},
              {"collider", path(c.contact.collider)},
              {"collidee", path(c.contact.collidee)},
              {"collider_position_m", numbers(c.contact.collider_before.position)},
              {"collidee_position_m", numbers(c.contact.collidee_before.position)},
              {"normal", numbers(c.contact.normal)}});
    return e;
  }
  ordered_json operator()(const Overruled& o) const {
    ordered_json e = event("contact_overruled");
    e.update({{"at_s", seconds(o.contact)}, {"collider", path(o.collider)}, {"collidee", path(o.collidee)}});
    return e;
  }
  ordered_json operator()(const ContactsRetracted& r) const {
    ordered_json e = event("contacts_retracted");
    e.update({{"after_s", seconds(r.since)}, {"object", path(r.object)}});
    if (r.partner) e["partner"] = path(*r.partner);
    if (r.of_ghosts_alone) e["predicted_only"] = true;
    return e;
  }
  ordered_json operator()(const PeerJoined& p) const {
    ordered_json e = event("joined");
    e.update({{"peer", p.peer.value}, {"name", p.name}, {"restarted", p.restarted}});
    return e;
  }
  ordered_json operator()(const PeerLost& p) const {
    ordered_json e = event("left");
    e.update({{"peer", p.peer.value}, {"name", p.name}, {"left_gracefully", p.left_gracefully}});
    return e;
  }
  ordered_json operator()(const DataChanged& d) const {
    ordered_json e = event("data");
    e.update({{"at_s", seconds(d.at)},
              {"node", path_or_id(node.scene(), d.node)},
              {"key", d.key},
              {"value", d.value ? ordered_json(*d.value) : ordered_json(nullptr)}});
    return e;
  }
  ordered_json operator()(const MessageReceived& m) const {
    ordered_json e = event("message");
    e.update({{"at_s", seconds(m.at)},
              {"operation", id(m.operation)},
              {"peer", m.by.value},
              {"topic", m.topic},
              {"text", m.text}});
    return e;
  }
  ordered_json operator()(const SceneEdited& s) const {
    ordered_json e = event("edit");
    e.update({{"at_s", seconds(s.at)}, {"operation", id(s.operation)}});
    if (!s.refused.empty()) e["refused"] = s.refused;
    return e;
  }
  template <class Other>
  ordered_json operator()(const Other&) const {
    assert(false && "an output without a kind");
    return {};
  }
};

}  // namespace

std::optional<EventKind> kind_of(const Output& output) { return std::visit(KindOf{}, output); }

std::string event_line(const Output& output, const PeerNode& node) {
  assert(kind_of(output));
  return as_line(std::visit(EventOf{node}, output));
}

std::string dropped_line(std::uint64_t count) {
  ordered_json e = event("dropped");
  e["count"] = count;
  return as_line(e);
}

}  // namespace peerd::control
