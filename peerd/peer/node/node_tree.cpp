#include "peerd/peer/node/node_tree.hpp"

#include <algorithm>
#include <charconv>
#include <span>
#include <utility>

#include "core/vrml/document.hpp"
#include "core/vrml/path_text.hpp"

namespace peerd {
namespace {

using vrml::NodeRef;
using vrml::NodeRole;

// The field whose nodes are named by their places; empty: the node has none.
std::string_view field_of_children(NodeRole role) {
  switch (role) {
    case NodeRole::kLod:
      return "level";
    case NodeRole::kSwitch:
      return "choice";
    case NodeRole::kGroup:
    case NodeRole::kTransform:
    case NodeRole::kBillboard:
    case NodeRole::kCollision:
    case NodeRole::kInline:
      return "children";
    default:
      return {};
  }
}

std::string name_in(const vrml::Field& field, std::size_t place) {
  const std::string name(field.spec->name);
  return vrml::is_list(field.spec->type) ? name + "." + std::to_string(place) : name;
}

std::optional<std::size_t> number_in(std::string_view text) {
  std::size_t number = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failed != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

class TreeMaker {
 public:
  TreeMaker(const Scene& scene, std::size_t rows_max)
      : scene_(scene), document_(*scene.document), rows_max_(rows_max) {}

  NodeTree make() {
    add_children(document_.top_level, 0, static_cast<std::uint32_t>(scene_.instances.size()), 0);
    return std::move(tree_);
  }

 private:
  // Adds children of which the scene has those in [first, end) as instances, in the same order. The proxy of a
  // Collision is an instance behind them.
  void add_children(std::span<const NodeRef> children, std::uint32_t first, std::uint32_t end, std::uint32_t depth) {
    std::uint32_t instance = first;
    for (std::uint32_t i = 0; i < children.size(); ++i) {
      if (!children[i].is_node()) continue;
      if (instance != end && scene_.instances[instance].child_index == i) {
        add_instance(instance, depth);
        instance = scene_.instances[instance].subtree_end;
      } else {
        add_part(children[i].index, std::to_string(i), depth);
      }
    }
    for (; instance != end; instance = scene_.instances[instance].subtree_end) add_instance(instance, depth);
  }

  void add_instance(std::uint32_t index, std::uint32_t depth) {
    const Instance& instance = scene_.instances[index];
    if (instance.node == Instance::kNone) return;
    const std::string path = scene_.path_of(scene_.id_of(index));
    add(instance.node, std::string(last_component(path)), depth);
    const vrml::Node& node = document_.nodes[instance.node];
    const std::string_view children = field_of_children(node.type->role);
    add_fields(node, children, node.type->role == NodeRole::kCollision ? "proxy" : "", depth + 1);
    const vrml::Field* const field = children.empty() ? nullptr : node.find(children);
    add_children(field == nullptr ? std::span<const NodeRef>() : field->as<NodeRef>(), index + 1, instance.subtree_end,
                 depth + 1);
  }

  void add_part(std::uint32_t index, std::string name, std::uint32_t depth) {
    add(index, std::move(name), depth);
    const vrml::Node& node = document_.nodes[index];
    if (node.type->role != NodeRole::kScript) add_fields(node, {}, {}, depth + 1);
  }

  void add_fields(const vrml::Node& node, std::string_view except, std::string_view nor, std::uint32_t depth) {
    for (const vrml::Field& field : node.given()) {
      if (!vrml::holds_nodes(field.spec->type) || field.spec->name == except || field.spec->name == nor) continue;
      const auto held = field.as<NodeRef>();
      for (std::size_t i = 0; i < held.size(); ++i) {
        if (held[i].is_node()) add_part(held[i].index, name_in(field, i), depth);
      }
    }
  }

  void add(std::uint32_t node, std::string name, std::uint32_t depth) {
    if (tree_.rows.size() < rows_max_) {
      tree_.rows.push_back({depth, node, std::move(name)});
    } else {
      ++tree_.left_out;
    }
  }

  const Scene& scene_;
  const vrml::Document& document_;
  std::size_t rows_max_;
  NodeTree tree_;
};

std::optional<std::uint32_t> node_in(std::span<const NodeRef> nodes, std::size_t place) {
  if (place >= nodes.size() || !nodes[place].is_node()) return std::nullopt;
  return nodes[place].index;
}

// The node that another one holds by that name in the tree.
std::optional<std::uint32_t> held_by(const vrml::Node& holder, std::string_view name) {
  if (holder.type->role == NodeRole::kScript) return std::nullopt;
  const auto place = number_in(name);
  const std::size_t dot = name.find('.');
  const vrml::Field* const field = holder.find(place ? field_of_children(holder.type->role) : name.substr(0, dot));
  if (field == nullptr || !vrml::holds_nodes(field->spec->type)) return std::nullopt;
  if (place) return node_in(field->as<NodeRef>(), *place);
  const auto in_list = dot == std::string_view::npos ? std::nullopt : number_in(name.substr(dot + 1));
  if (vrml::is_list(field->spec->type) != in_list.has_value()) return std::nullopt;
  return node_in(field->as<NodeRef>(), in_list.value_or(0));
}

}  // namespace

NodeTree node_tree(const Scene& scene, std::size_t rows_max) { return TreeMaker(scene, rows_max).make(); }

std::optional<std::uint32_t> node_at(const Scene& scene, std::string_view path) {
  const vrml::Document& document = *scene.document;
  if (const auto object = scene.find(path)) return scene.at(*object).node;
  const auto named = std::ranges::find(document.nodes, path, &vrml::Node::def);
  if (!path.empty() && named != document.nodes.end()) {
    return static_cast<std::uint32_t>(named - document.nodes.begin());
  }
  const std::size_t begin = path.size() - last_component(path).size();
  if (begin == 0) {
    const auto place = number_in(path);
    return place ? node_in(document.top_level, *place) : std::nullopt;
  }
  const auto holder = node_at(scene, path.substr(0, begin - 1));
  return holder ? held_by(document.nodes[*holder], path.substr(begin)) : std::nullopt;
}

}  // namespace peerd
