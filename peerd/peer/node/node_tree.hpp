#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/scene/scene.hpp"

namespace peerd {

// A NodeRow is a node where it stands in the tree of all nodes. The names of the rows above it and its own, joined by
// '/', are its path: of an instance the one that Scene::path_of gives; below that the place of a child ("2") or the
// field that holds the node ("appearance"; of a list of nodes "source.1").
struct NodeRow {
  std::uint32_t depth = 0;  // 0: the top level
  std::uint32_t node = 0;   // into Document::nodes
  std::string name;

  friend bool operator==(const NodeRow&, const NodeRow&) = default;
};

// A NodeTree has all nodes of a scene in depth-first order, a node that is USEd in each of its places. A Script's own
// fields are left out: they may refer to nodes around it.
struct NodeTree {
  static constexpr std::size_t kRows = 200'000;

  std::vector<NodeRow> rows;
  std::size_t left_out = 0;  // rows beyond the limit
};
[[nodiscard]] NodeTree node_tree(const Scene& scene, std::size_t rows_max = NodeTree::kRows);

// Returns the node of an instance by its path, any node by its DEF name, or one by its path in the tree, as an index
// into Document::nodes.
[[nodiscard]] std::optional<std::uint32_t> node_at(const Scene& scene, std::string_view path);

}  // namespace peerd
