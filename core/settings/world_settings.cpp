#include "core/settings/world_settings.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <utility>

#include "core/formats/draft/node_draft.hpp"
#include "core/scene/path_resolver.hpp"
#include "core/scene/scene_builder.hpp"

namespace peerd {
namespace {

using formats::NodeDraft;
using vrml::Document;
using vrml::NodeRef;
using vrml::Position;
using vrml::Problems;

// Makes room for `count` nodes in front of all others: every reference to a node counts on.
void shift_nodes(Document& document, std::uint32_t count) {
  const auto shifted = [&](NodeRef ref) { return ref.is_node() ? NodeRef{ref.index + count, ref.at} : ref; };
  for (vrml::Node& node : document.nodes) {
    const auto fields = document.arena.allocate<vrml::Field>(node.field_count);
    std::ranges::copy(node.given(), fields.begin());
    for (vrml::Field& field : fields) {
      if (!vrml::holds_nodes(field.spec->type)) continue;
      const auto refs = document.arena.allocate<NodeRef>(field.count);
      std::ranges::transform(field.as<NodeRef>(), refs.begin(), shifted);
      field.data = refs.data();
    }
    node.fields = fields.data();
  }
  std::ranges::transform(document.top_level, document.top_level.begin(), shifted);
  for (vrml::Route& route : document.routes) {
    route.from_node += count;
    route.to_node += count;
  }
  for (vrml::InnerName& inner : document.inner_names) inner.node += count;
}

// The visits to nodes that all patterns of a side file may ask for. They take about a second.
constexpr std::uint64_t kPatternVisits = std::uint64_t{1} << 25;

// Returns how often a path makes a PathResolver visit each node at most: once for each name of a pattern, and as often
// again for each 64 bytes, since a pattern is compared with a name byte by byte.
std::uint64_t visits_of(std::string_view path) {
  if (!vrml::parts_of_pattern(path)) return 0;
  return 1 + static_cast<std::uint64_t>(std::ranges::count(path, '/')) + path.size() / 64;
}

class Amender {
 public:
  Amender(const WorldSettings& settings, const ReadLimits& limits, Document& document, Problems& problems,
          Position begin)
      : settings_(settings), limits_(limits), document_(document), problems_(problems), begin_(begin) {}

  void amend() {
    if (!settings_.objects.empty()) add_responses();
    const std::uint64_t visits = visits_of_patterns();
    if (!settings_.objects.empty() || settings_.collides_all || visits > 0) {
      // The document is only borrowed: the scene of this moment ends with this function.
      const std::shared_ptr<const Document> borrowed(std::shared_ptr<const Document>(), &document_);
      Problems reported_later;
      ReadLimits limits = limits_;  // how much the texts may sweep is decided when the world is built
      limits.swept_base = std::numeric_limits<std::uint32_t>::max();
      scene_ = vrml::build_scene(borrowed, {}, limits, reported_later);
      if (reported_later.errors() > 0) return;  // the world is no good by itself, and says so when it is built
    }
    if (visits * scene_.instances.size() > limits_.expansion * kPatternVisits) {
      return problems_.error(at(0), "the patterns visit " + std::to_string(visits * scene_.instances.size()) +
                                        " nodes, more than " + std::to_string(limits_.expansion * kPatternVisits) +
                                        std::string(ReadLimits::kRaised));
    }
    set_fields();
    if (settings_.collides_all) collide_all();
    for (const InterestSetting& interest : settings_.interests) add_interest(interest);
    scene_ = {};
  }

 private:
  [[nodiscard]] Position at(std::size_t offset) const { return begin_ + static_cast<Position>(offset); }

  void add_responses() {
    for (const ObjectSetting& object : settings_.objects) {
      if (!object.response) continue;
      responses_[object.offset] = static_cast<std::uint32_t>(responses_.size());
    }
    if (responses_.empty()) return;
    shift_nodes(document_, static_cast<std::uint32_t>(responses_.size()));
    std::vector<vrml::Node> nodes = std::exchange(document_.nodes, {});
    for (const ObjectSetting& object : settings_.objects) {
      if (!object.response) continue;
      const CollisionResponse& response = *object.response;
      NodeDraft draft(document_, "CollisionResponse", at(object.offset));
      draft.integer("responseType", static_cast<std::int32_t>(response.type)).flag("setBack", response.set_back);
      if (response.type == ResponseType::kImpulse) {
        draft.floats("mass", {static_cast<float>(response.mass_kg)});
        draft.floats("restitution", {static_cast<float>(response.restitution)});
        draft.floats("friction", {static_cast<float>(response.friction_m_s2)});
      }
      static_cast<void>(draft.add());
    }
    document_.nodes.insert(document_.nodes.end(), nodes.begin(), nodes.end());
  }

  [[nodiscard]] std::uint64_t visits_of_patterns() const {
    std::uint64_t visits = 0;
    for (const ObjectSetting& object : settings_.objects) visits += visits_of(object.object);
    for (const InterestSetting& interest : settings_.interests) {
      visits += visits_of(interest.object);
      for (const std::string& path : interest.with) visits += visits_of(path);
      for (const std::string& path : interest.except) visits += visits_of(path);
    }
    return visits;
  }

  // The nodes of the objects that a path or a pattern names.
  std::vector<std::uint32_t> nodes_of(const ObjectSetting& setting, vrml::PathResolver& paths) {
    std::vector<ObjectId> found;
    if (const auto one = paths.find(setting.object)) {
      found.push_back(*one);
    } else if (const auto parts = vrml::parts_of_pattern(setting.object)) {
      NamePattern pattern{std::nullopt, std::string(parts->path)};
      if (!parts->below.empty()) pattern.below = paths.find(parts->below);
      if (parts->below.empty() || pattern.below) found = paths.find_all(pattern);
    }
    std::vector<std::uint32_t> nodes;
    for (const ObjectId id : found) {
      if (scene_.at(id).kind == NodeKind::kTransform) {
        nodes.push_back(scene_.at(id).node);
      } else {
        problems_.error(at(setting.offset), vrml::quoted(scene_.path_of(id)) + " is no Transform: nothing can move it");
      }
    }
    if (found.empty())
      problems_.error(at(setting.offset), "no node of the scene is named " + vrml::quoted(setting.object));
    std::ranges::sort(nodes);
    nodes.erase(std::ranges::unique(nodes).begin(), nodes.end());
    return nodes;
  }

  // For each field, the last setting that gives it to the node; null where none does.
  struct Given {
    const ObjectSetting *velocity = nullptr, *threshold = nullptr, *owned = nullptr, *layers = nullptr,
                        *response = nullptr;
  };

  void set_fields() {
    std::map<std::uint32_t, Given> given;  // by node
    vrml::PathResolver paths(scene_);
    for (const ObjectSetting& setting : settings_.objects) {
      for (const std::uint32_t node : nodes_of(setting, paths)) {
        Given& to = given[node];
        if (setting.velocity_m_s) to.velocity = &setting;
        if (setting.distance_threshold_m) to.threshold = &setting;
        if (setting.owned_by_founder) to.owned = &setting;
        if (setting.layers) to.layers = &setting;
        if (setting.response) to.response = &setting;
      }
    }
    for (const auto& [node, from] : given) set_fields(document_.nodes[node], from);
  }

  void set_fields(vrml::Node& node, const Given& from) {
    const auto set = [&](const ObjectSetting* setting, auto add_to) {
      if (setting == nullptr) return;
      NodeDraft draft(document_, "Transform", at(setting->offset));
      add_to(draft, *setting);
      draft.give_to(node);
    };
    set(from.velocity,
        [](NodeDraft& draft, const ObjectSetting& s) { draft.floats("velocityVector", *s.velocity_m_s); });
    set(from.threshold,
        [](NodeDraft& draft, const ObjectSetting& s) { draft.floats("distanceThreshold", {*s.distance_threshold_m}); });
    set(from.owned, [](NodeDraft& draft, const ObjectSetting& s) { draft.flag("enslaved", *s.owned_by_founder); });
    set(from.layers, [](NodeDraft& draft, const ObjectSetting& s) {
      draft.integer("collisionLayers", static_cast<std::int32_t>(*s.layers));
    });
    set(from.response, [&](NodeDraft& draft, const ObjectSetting& s) {
      draft.node("collisionResponse", {responses_.at(s.offset), at(s.offset)});
    });
  }

  void collide_all() {
    // Some files hold all that they show in one node, and that one in another.
    const auto& instances = scene_.instances;
    std::string level;
    std::uint32_t begin = 0, end = static_cast<std::uint32_t>(instances.size());
    while (begin < end && instances[begin].subtree_end == end && begin + 1 < end &&
           instances[begin + 1].kind != NodeKind::kShape) {
      level = scene_.path_of(scene_.id_of(begin)) + '/';
      ++begin;
    }
    add_interest({level + "*", {level + "*"}, {}, CollisionType::kWitness, 0});
  }

  void add_interest(const InterestSetting& interest) {
    const std::vector<std::string_view> with(interest.with.begin(), interest.with.end());
    const std::vector<std::string_view> except(interest.except.begin(), interest.except.end());
    NodeDraft draft(document_, "CollisionInterest", at(interest.offset));
    draft.string("objectPath", interest.object).strings("interests", with);
    draft.integer("collisionType", static_cast<std::int32_t>(interest.type));
    if (!except.empty()) draft.strings("except", except);
    document_.top_level.push_back(draft.add());
  }

  const WorldSettings& settings_;
  const ReadLimits& limits_;
  Document& document_;
  Problems& problems_;
  Position begin_;
  Scene scene_;
  std::map<std::size_t, std::uint32_t> responses_;  // the node, by the offset of the setting that has it
};

}  // namespace

std::function<void(Document&, Problems&)> amender_of(WorldSettings settings, Source side, const ReadLimits& limits) {
  return [settings = std::move(settings), side = std::move(side), limits](Document& document, Problems& problems) {
    const auto begin = problems.open(side);
    if (!begin) return problems.error(0, "the files of this world are together too large");
    if (problems.errors() == 0) Amender(settings, limits, document, problems, *begin).amend();
  };
}

}  // namespace peerd
