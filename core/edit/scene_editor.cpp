#include "core/edit/scene_editor.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <span>
#include <utility>

#include "core/edit/number_text.hpp"
#include "core/parser/parser.hpp"
#include "core/scene/path_resolver.hpp"

namespace peerd {
namespace {

using vrml::NodeRef;
using vrml::NodeRole;

bool is_instance(const vrml::Node& node) {
  return node.type->role >= NodeRole::kGroup && node.type->role <= NodeRole::kShape;
}

// The field in which the instances below a node stand.
const vrml::FieldSpec* list_field(const vrml::Node& node) {
  switch (node.type->role) {
    case NodeRole::kShape:
      return nullptr;
    case NodeRole::kInline:
      return &vrml::inline_content();
    case NodeRole::kLod:
      return vrml::find_field(*node.type, "level");
    case NodeRole::kSwitch:
      return vrml::find_field(*node.type, "choice");
    default:
      return vrml::find_field(*node.type, "children");
  }
}

std::unexpected<std::string> gone() { return std::unexpected(std::string("it is not in the scene any more")); }

std::string first_error(const ReadResult& result) {
  const auto error = std::ranges::find(result.diagnostics, Severity::kError, &Diagnostic::severity);
  assert(error != result.diagnostics.end());
  return render(result, *error);
}

}  // namespace

SceneEditor::SceneEditor(const Scene& scene) : scene_(scene), document_(scene.document) {
  drafts_.resize(scene.instances.size());
  live_ = drafts_.size();
  instances_of_.resize(document_.node_count());
  for (std::uint32_t i = 0; i < drafts_.size(); ++i) {
    const Instance& instance = scene.instances[i];
    drafts_[i].id = scene.id_of(i);
    drafts_[i].node = instance.node;
    ++instances_of_[instance.node];
    if (instance.parent < 0) {
      top_level_.push_back(i);
    } else {
      drafts_[i].parent = static_cast<std::uint32_t>(instance.parent);
      drafts_[drafts_[i].parent].children.push_back(i);
    }
  }
  for (const CollisionInterest& interest : scene.interests) interests_.emplace(interest.node, interest);
  for (const KeySensor& sensor : scene.key_sensors) recipients_.emplace(sensor.node, sensor.recipient);
}

std::optional<std::uint32_t> SceneEditor::draft_of(ObjectId id) const {
  std::optional<std::uint32_t> draft = scene_.ids.find(id, scene_.instances.size());
  if (const auto added = added_objects_.find(id); added != added_objects_.end()) draft = added->second;
  return draft && !drafts_[*draft].removed ? draft : std::nullopt;
}

std::optional<std::uint32_t> SceneEditor::node_of(NodeId id) {
  const auto added = added_nodes_.find(id);
  const auto node = added != added_nodes_.end() ? std::optional(added->second)
                                                : scene_.document->ids.find(id, scene_.document->nodes.size());
  if (!node || !has_dropped_) return node;
  if (!reached_) reached_ = document_.reached();
  return *node >= reached_->size() || (*reached_)[*node] ? node : std::nullopt;
}

std::expected<SceneEditor::Spot, std::string> SceneEditor::children_of(std::optional<std::uint32_t> parent) {
  if (!parent) return Spot{&top_level_, &document_.top_level(), top_level_.size(), document_.top_level().size()};
  const std::uint32_t node = drafts_[*parent].node;
  const vrml::FieldSpec* const field = list_field(document_.node(node));
  if (field == nullptr) return std::unexpected("a Shape has nothing below it");
  if (instances_of_[node] > 1) {
    return std::unexpected("what stands there is in " + std::to_string(instances_of_[node]) +
                           " places at once, by USE");
  }
  std::vector<NodeRef>& refs = document_.list(node, *field);
  std::vector<std::uint32_t>& drafts = drafts_[*parent].children;
  return Spot{&drafts, &refs, drafts.size(), refs.size()};
}

std::expected<SceneEditor::Spot, std::string> SceneEditor::spot_of(std::uint32_t draft) {
  const std::uint32_t parent = drafts_[draft].parent;
  auto spot = children_of(parent == kNone ? std::nullopt : std::optional(parent));
  if (!spot) return spot;
  spot->draft = static_cast<std::size_t>(std::ranges::find(*spot->drafts, draft) - spot->drafts->begin());
  std::size_t instances = 0;
  for (spot->ref = 0; spot->ref < spot->refs->size(); ++spot->ref) {
    const NodeRef& ref = (*spot->refs)[spot->ref];
    if (!ref.is_node() || !is_instance(document_.node(ref.index))) continue;
    if (instances++ == spot->draft) return spot;
  }
  return std::unexpected("it is the proxy of a Collision");
}

std::expected<SceneEditor::Spot, std::string> SceneEditor::spot_at(const ScenePlace& place) {
  std::optional<std::uint32_t> parent;
  if (place.parent && !(parent = draft_of(*place.parent))) {
    return std::unexpected("what it should stand in is not in the scene any more");
  }
  if (!place.before) return children_of(parent);
  const auto before = draft_of(*place.before);
  if (!before || drafts_[*before].parent != parent.value_or(kNone)) {
    return std::unexpected("what it should stand in front of does not stand there");
  }
  return spot_of(*before);
}

std::uint32_t SceneEditor::depth_of(std::optional<std::uint32_t> draft) const {
  std::uint32_t depth = 0;
  for (std::uint32_t d = draft.value_or(kNone); d != kNone; d = drafts_[d].parent) ++depth;
  return depth;
}

std::uint32_t SceneEditor::height_of(std::uint32_t draft) const {
  std::uint32_t height = 0;
  for (const std::uint32_t child : drafts_[draft].children) height = std::max(height, height_of(child));
  return height + 1;
}

std::expected<SceneEditor::Added, std::string> SceneEditor::add(
    std::string_view text, const ScenePlace& place, const FirstIds& first, const ReadOptions& options,
    const std::function<std::optional<ObjectId>(std::string_view)>& find) {
  const auto spot = spot_at(place);
  if (!spot) return std::unexpected(spot.error());
  ReadOptions reading = options;
  reading.around = {find, first.object};
  reading.world_times = true;
  reading.only_vrml = true;
  reading.limits = options.limits.of_added(text.size());
  const ReadResult result = read_world(text, reading);
  if (!result.scene) return std::unexpected(first_error(result));
  const Scene& content = *result.scene;
  const auto parent = place.parent ? draft_of(*place.parent) : std::nullopt;
  std::uint32_t height = 0;
  for (std::uint32_t i = 0; i < content.instances.size(); ++i) {
    std::uint32_t depth = 1;
    for (std::int32_t up = content.instances[i].parent; up >= 0; ++depth) {
      up = content.instances[static_cast<std::size_t>(up)].parent;
    }
    height = std::max(height, depth);
  }
  if (depth_of(parent) + height > vrml::kMaxNesting) {
    return std::unexpected("its nodes would be nested more than " + std::to_string(vrml::kMaxNesting) + " deep");
  }
  if (live_ + content.instances.size() > ReadLimits{}.instances) {
    return std::unexpected("the world would have more than " + std::to_string(ReadLimits{}.instances) + " instances");
  }
  const std::uint32_t begin = document_.append(content.document, first.node);
  instances_of_.resize(document_.node_count());
  for (std::uint32_t i = begin; i < document_.node_count(); ++i) added_nodes_.emplace(document_.id_of(i), i);
  std::vector<NodeRef> refs;
  for (const NodeRef& ref : content.document->top_level) {
    if (ref.is_node()) refs.push_back({ref.index + begin, ref.at});
  }
  spot->refs->insert(spot->refs->begin() + static_cast<std::ptrdiff_t>(spot->ref), refs.begin(), refs.end());
  add_drafts(content, begin, parent, *spot);
  for (CollisionInterest interest : content.interests) {
    interest.node += begin;
    interests_.emplace(interest.node, interest);
  }
  for (const KeySensor& sensor : content.key_sensors) recipients_.emplace(sensor.node + begin, sensor.recipient);
  drop_interests_without_ends();
  return Added{static_cast<std::uint32_t>(content.instances.size()),
               static_cast<std::uint32_t>(content.document->nodes.size())};
}

void SceneEditor::add_drafts(const Scene& content, std::uint32_t first_node, std::optional<std::uint32_t> parent,
                             const Spot& spot) {
  const auto begin = static_cast<std::uint32_t>(drafts_.size());
  std::vector<std::uint32_t> tops;
  std::vector<Draft> all;
  for (std::uint32_t i = 0; i < content.instances.size(); ++i) {
    const Instance& instance = content.instances[i];
    Draft& draft = all.emplace_back(Draft{content.id_of(i), instance.node + first_node, parent.value_or(kNone), {}});
    ++instances_of_[draft.node];
    added_objects_.emplace(draft.id, begin + i);
    if (instance.parent < 0) {
      tops.push_back(begin + i);
    } else {
      draft.parent = begin + static_cast<std::uint32_t>(instance.parent);
      all[static_cast<std::size_t>(instance.parent)].children.push_back(begin + i);
    }
  }
  spot.drafts->insert(spot.drafts->begin() + static_cast<std::ptrdiff_t>(spot.draft), tops.begin(), tops.end());
  drafts_.insert(drafts_.end(), std::make_move_iterator(all.begin()), std::make_move_iterator(all.end()));
  live_ += all.size();
}

SceneEditor::Below SceneEditor::below(ObjectId id) const {
  const auto draft = draft_of(id);
  if (!draft) return {};
  Below below;
  std::vector<std::uint32_t> open{*draft};
  while (!open.empty()) {
    const Draft& next = drafts_[open.back()];
    open.pop_back();
    below.objects.push_back(next.id);
    open.insert(open.end(), next.children.begin(), next.children.end());
  }
  for (const std::uint32_t node : document_.below(drafts_[*draft].node)) below.nodes.push_back(document_.id_of(node));
  std::ranges::sort(below.objects);
  std::ranges::sort(below.nodes);
  return below;
}

bool SceneEditor::is_within(ObjectId id, ObjectId above) const {
  const auto draft = draft_of(id), end = draft_of(above);
  if (!draft || !end) return false;
  std::uint32_t up = *draft;
  while (up != *end && up != kNone) up = drafts_[up].parent;
  return up != kNone;
}

void SceneEditor::mark_removed(std::uint32_t draft) {
  drafts_[draft].removed = true;
  --instances_of_[drafts_[draft].node];
  --live_;
  for (const std::uint32_t child : drafts_[draft].children) mark_removed(child);
}

std::expected<void, std::string> SceneEditor::remove(ObjectId id) {
  const auto draft = draft_of(id);
  if (!draft) return gone();
  const auto spot = spot_of(*draft);
  if (!spot) return std::unexpected(spot.error());
  spot->drafts->erase(spot->drafts->begin() + static_cast<std::ptrdiff_t>(spot->draft));
  spot->refs->erase(spot->refs->begin() + static_cast<std::ptrdiff_t>(spot->ref));
  mark_removed(*draft);
  note_dropped();
  drop_interests_without_ends();
  return {};
}

std::expected<void, std::string> SceneEditor::remove(NodeId id) {
  const auto node = node_of(id);
  if (!node) return gone();
  if (is_instance(document_.node(*node))) return std::unexpected("it is an instance of the scene");
  document_.drop(std::span(&*node, 1));
  note_dropped();
  may_fail_ = true;
  interests_.erase(*node);
  recipients_.erase(*node);
  return {};
}

std::expected<void, std::string> SceneEditor::move(ObjectId id, const ScenePlace& place) {
  const auto draft = draft_of(id);
  if (!draft) return gone();
  if (place.before == id) return std::unexpected("it cannot stand in front of itself");
  const auto parent = place.parent ? draft_of(*place.parent) : std::nullopt;
  for (std::uint32_t up = parent.value_or(kNone); up != kNone; up = drafts_[up].parent) {
    if (up == *draft) return std::unexpected("it cannot stand in itself");
  }
  if (depth_of(parent) + height_of(*draft) > vrml::kMaxNesting) {
    return std::unexpected("its nodes would be nested more than " + std::to_string(vrml::kMaxNesting) + " deep");
  }
  const auto from = spot_of(*draft);
  if (!from) return std::unexpected(from.error());
  if (const auto to = spot_at(place); !to) return std::unexpected(to.error());
  const NodeRef ref = (*from->refs)[from->ref];
  from->drafts->erase(from->drafts->begin() + static_cast<std::ptrdiff_t>(from->draft));
  from->refs->erase(from->refs->begin() + static_cast<std::ptrdiff_t>(from->ref));
  const auto to = spot_at(place);  // its place has changed where it stays among its siblings
  assert(to);
  to->drafts->insert(to->drafts->begin() + static_cast<std::ptrdiff_t>(to->draft), *draft);
  to->refs->insert(to->refs->begin() + static_cast<std::ptrdiff_t>(to->ref), ref);
  drafts_[*draft].parent = parent.value_or(kNone);
  return {};
}

std::expected<std::uint32_t, std::string> SceneEditor::set(NodeId id, std::string_view field, std::string_view value,
                                                           NodeId first) {
  const auto node = node_of(id);
  if (!node) return gone();
  const vrml::NodeType& type = *document_.node(*node).type;
  const vrml::FieldSpec* const spec = vrml::find_field(type, field);
  if (spec == nullptr || !vrml::has_value(spec->access)) {
    return std::unexpected("a " + std::string(type.name) + " has no field " + vrml::quoted(field));
  }
  if (vrml::find_node_type(type.name) != &type) return std::unexpected("the fields of this node cannot be set");
  if (interests_.contains(*node) || recipients_.contains(*node)) {
    const bool names = spec->type == vrml::FieldType::kSFString || spec->type == vrml::FieldType::kMFString;
    if (names) return std::unexpected("what it names stays what it was; another one can be added in its place");
  }
  if (is_instance(document_.node(*node)) && (spec == list_field(document_.node(*node)) || field == "proxy")) {
    return std::unexpected("what stands in it is added, moved and removed");
  }
  const std::string text =
      "#VRML V2.0 utf8\n" + std::string(type.name) + " { " + std::string(field) + " " + std::string(value) + "\n}";
  vrml::Problems problems;
  const std::shared_ptr<const vrml::Document> parsed = vrml::parse({"value", text, nullptr}, problems);
  if (problems.errors() > 0) return std::unexpected(problems.first_error());
  if (parsed->top_level.size() != 1 || !parsed->routes.empty()) return std::unexpected("it is more than one value");
  const vrml::Node& wrapper = parsed->nodes[parsed->top_level[0].index];
  if (wrapper.type != &type || wrapper.given().size() != 1 || wrapper.given()[0].spec != spec) {
    return std::unexpected("it is more than one value");
  }
  const vrml::Field& set = wrapper.given()[0];
  may_fail_ |= !is_instance(document_.node(*node)) || vrml::holds_nodes(spec->type);
  if (!vrml::holds_nodes(spec->type)) {
    document_.set(*node, set);
    return 0;
  }
  const std::uint32_t begin = document_.append(parsed, first);
  instances_of_.resize(document_.node_count());
  for (std::uint32_t i = begin; i < document_.node_count(); ++i) added_nodes_.emplace(document_.id_of(i), i);
  std::vector<NodeRef>& list = document_.list(*node, *spec);
  if (!list.empty()) note_dropped();
  list.clear();
  for (const NodeRef& ref : set.as<NodeRef>()) {
    list.push_back({ref.is_node() ? ref.index + begin : NodeRef::kNull, ref.at});
  }
  return static_cast<std::uint32_t>(parsed->nodes.size());
}

std::expected<void, std::string> SceneEditor::set_placement(ObjectId id, const Placement& placement) {
  const auto draft = draft_of(id);
  if (!draft) return gone();
  const std::uint32_t node = drafts_[*draft].node;
  if (document_.node(node).type->name != "Transform") return std::unexpected("it is no Transform");
  const std::array fields{std::pair("translation", text_of_numbers(placement.translation)),
                          std::pair("rotation", text_of_numbers(placement.rotation))};
  for (const auto& [field, value] : fields) {
    if (const auto set = this->set(document_.id_of(node), field, value, {}); !set) return std::unexpected(set.error());
  }
  return {};
}

std::expected<vrml::Route, std::string> SceneEditor::route(NodeId from, std::string_view event_out, NodeId to,
                                                           std::string_view event_in) {
  const auto from_node = node_of(from), to_node = node_of(to);
  if (!from_node || !to_node) return gone();
  const auto field_of = [&](std::uint32_t node, std::string_view name) {
    return vrml::find_field(*document_.node(node).type, name);
  };
  const vrml::FieldSpec *const out = field_of(*from_node, event_out), *const in = field_of(*to_node, event_in);
  if (out == nullptr || !vrml::sends_events(out->access)) {
    return std::unexpected(vrml::quoted(event_out) + " sends no event");
  }
  if (in == nullptr || !vrml::takes_events(in->access)) {
    return std::unexpected(vrml::quoted(event_in) + " takes no event");
  }
  if (out->type != in->type) return std::unexpected("the two are of different types");
  return vrml::Route{*from_node, *to_node, out, in, 0};
}

std::expected<void, std::string> SceneEditor::add_route(NodeId from, std::string_view event_out, NodeId to,
                                                        std::string_view event_in) {
  const auto added = route(from, event_out, to, event_in);
  if (!added) return std::unexpected(added.error());
  const auto same = [&](const vrml::Route& r) {
    return r.from_node == added->from_node && r.from == added->from && r.to_node == added->to_node && r.to == added->to;
  };
  if (std::ranges::none_of(document_.routes(), same)) document_.routes().push_back(*added);
  return {};
}

std::expected<void, std::string> SceneEditor::remove_route(NodeId from, std::string_view event_out, NodeId to,
                                                           std::string_view event_in) {
  const auto removed = route(from, event_out, to, event_in);
  if (!removed) return std::unexpected(removed.error());
  const auto erased = std::erase_if(document_.routes(), [&](const vrml::Route& r) {
    return r.from_node == removed->from_node && r.from == removed->from && r.to_node == removed->to_node &&
           r.to == removed->to;
  });
  if (erased == 0) return std::unexpected("there is no such ROUTE");
  return {};
}

void SceneEditor::drop_interests_without_ends() {
  std::vector<std::uint32_t> dropped;
  const auto is_gone = [&](ObjectId end) { return !draft_of(end); };
  for (auto& [node, interest] : interests_) {
    for (InterestSide* const side : {&interest.colliders, &interest.collidees, &interest.except}) {
      side->ends.resize(side->named);
      std::erase_if(side->ends, is_gone);
      side->named = side->ends.size();
      std::erase_if(side->patterns, [&](const NamePattern& p) { return p.below && is_gone(*p.below); });
    }
    const auto has_none = [](const InterestSide& side) { return side.ends.empty() && side.patterns.empty(); };
    if (has_none(interest.colliders) || has_none(interest.collidees)) dropped.push_back(node);
  }
  if (!dropped.empty()) {
    document_.drop(dropped);
    note_dropped();
  }
  for (const std::uint32_t node : dropped) interests_.erase(node);
  for (auto& [node, recipient] : recipients_) {
    if (recipient && !draft_of(*recipient)) recipient.reset();
  }
}

vrml::Bindings SceneEditor::bindings(const std::vector<std::uint32_t>& place) const {
  vrml::Bindings bound;
  std::vector<ObjectId> ids;
  std::vector<std::uint32_t> open(top_level_.rbegin(), top_level_.rend());
  while (!open.empty()) {
    const Draft& draft = drafts_[open.back()];
    open.pop_back();
    ids.push_back(draft.id);
    open.insert(open.end(), draft.children.rbegin(), draft.children.rend());
  }
  bound.ids = LastingIds<ObjectId>(std::move(ids));
  for (const auto& [node, interest] : interests_) {
    if (place[node] != NodeRef::kNull) bound.interests.emplace(place[node], interest);
  }
  for (const auto& [node, recipient] : recipients_) {
    if (place[node] != NodeRef::kNull) bound.recipients.emplace(place[node], recipient);
  }
  for (const PendingInline& pending : scene_.pending_inlines) {
    const std::uint32_t node = place[scene_.at(pending.instance).node];
    if (node != NodeRef::kNull) bound.bases.emplace(node, pending.base);
  }
  return bound;
}

// Names what interests and KeySensors have been bound to as a reader would find it, by the words that they had where
// these still lead there.
void SceneEditor::rewrite_paths(const Scene& scene, vrml::Document& document) const {
  vrml::PathResolver paths(scene);
  // The path depends on the scene alone, so that it does not matter in which steps that was edited.
  const auto path_to = [&](ObjectId id) {
    const std::string_view def = scene.at(id).def;
    return !def.empty() && paths.find(def) == id ? std::string(def) : scene.path_of(id);
  };
  for (const CollisionInterest& interest : scene.interests) {
    const auto names_of = [&](const InterestSide& side) {
      std::vector<std::string> names;
      for (std::size_t i = 0; i < side.named; ++i) names.push_back(path_to(side.ends[i]));
      for (const NamePattern& p : side.patterns) names.push_back(p.below ? path_to(*p.below) + '/' + p.path : p.path);
      return names;
    };
    vrml::set_strings(document, interest.node, "objectPath", names_of(interest.colliders));
    vrml::set_strings(document, interest.node, "interests", names_of(interest.collidees));
    if (document.nodes[interest.node].find("except") != nullptr) {
      vrml::set_strings(document, interest.node, "except", names_of(interest.except));
    }
    if (document.nodes[interest.node].find("collisionInterests") != nullptr) {
      vrml::set_strings(document, interest.node, "collisionInterests", {});
    }
    document.nodes[interest.node].scope = 0;
  }
  for (const KeySensor& sensor : scene.key_sensors) {
    const vrml::Field* const named = document.nodes[sensor.node].find("recipient");
    if (!sensor.recipient && (named == nullptr || named->count == 0)) continue;
    const std::string recipients[] = {sensor.recipient ? path_to(*sensor.recipient) : std::string()};
    vrml::set_strings(document, sensor.node, "recipient", recipients);
    document.nodes[sensor.node].scope = 0;
  }
}

std::expected<Scene, std::string> SceneEditor::finish() {
  auto [document, place] = document_.finish();
  const vrml::Bindings bound = bindings(place);
  auto scene = vrml::rebuild_scene(document, scene_.tessellation, ReadLimits{}, bound);
  if (!scene) return std::unexpected(scene.error());
  rewrite_paths(*scene, *document);
  return scene;
}

}  // namespace peerd
