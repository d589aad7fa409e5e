#include "collision/tree/hierarchy_file.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

namespace peerd::collision {
namespace {

using Ref = WideTree::Ref;

struct Header {
  std::array<char, 8> magic{};
  std::uint32_t version = 4;
  std::uint32_t header_bytes = 64;
  std::uint64_t fingerprint = 0;
  std::uint64_t checksum = 0;
  std::uint32_t triangles = 0, nodes = 0, leaves = 0;
  std::array<std::uint32_t, 5> zero{};
};
static_assert(sizeof(Header) == 64 && std::is_trivially_copyable_v<Header>);
static_assert(std::is_trivially_copyable_v<WideTree::Node> && sizeof(WideTree::Node) == 704);
static_assert(std::is_trivially_copyable_v<WideTree::Leaf> && sizeof(WideTree::Leaf) == 320);

Header new_header() {
  Header header;
  std::ranges::copy(kHierarchyMagic, header.magic.begin());
  return header;
}

// FNV-1a over words of 64 bits, the last one filled up with zeros: against accidents, at the speed of memory.
class Hash {
 public:
  void add(std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
      std::uint64_t word = 0;
      const std::size_t size = std::min(bytes.size(), sizeof word);
      std::memcpy(&word, bytes.data(), size);
      value_ = std::rotl((value_ ^ word) * 0x100000001b3u, 29);
      bytes = bytes.subspan(size);
    }
  }
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

std::uint64_t fingerprint(const TriangleSoup& soup) {
  Hash hash;
  for (const Vec3& v : soup.vertices) {
    const std::array<double, 3> xyz = {v[0] + 0.0, v[1] + 0.0, v[2] + 0.0};  // -0 is 0
    hash.add(std::as_bytes(std::span(xyz)));
  }
  hash.add(std::as_bytes(std::span(soup.faces)));
  return hash.value();
}

// Whether a child that isn't there has no box, so that no query comes to it.
bool has_no_box(const WideTree::Node& node, std::size_t child) {
  bool none = true;
  for (std::size_t k = 0; k < 3; ++k) {
    none &= node.half[k][child] == WideTree::kNoBox && node.oriented_half[k][child] == WideTree::kNoBox;
  }
  return none;
}

struct Range {
  std::uint64_t begin, end;
};
// Whether what is below each node stands in the list of faces in a row, in the order of the children, and what is below
// the root is the whole list. Children are known to stand behind their parents.
bool are_in_order(const Header& header, std::span<const WideTree::Node> nodes, std::span<const WideTree::Leaf> leaves) {
  const auto of_leaf = [&](std::size_t i) {
    return Range{leaves[i].first_face, std::uint64_t{leaves[i].first_face} + leaves[i].count};
  };
  std::vector<Range> of_nodes(nodes.size());
  for (std::size_t n = nodes.size(); n-- > 0;) {
    const auto range = [&](Ref ref) { return ref.kind() == Ref::kLeaf ? of_leaf(ref.index()) : of_nodes[ref.index()]; };
    const auto& children = nodes[n].children;
    if (children[0].kind() == Ref::kNone) return false;
    of_nodes[n] = range(children[0]);
    for (std::size_t i = 1; i < WideTree::kWidth; ++i) {
      if (children[i].kind() == Ref::kNone) continue;
      if (range(children[i]).begin != of_nodes[n].end) return false;
      of_nodes[n].end = range(children[i]).end;
    }
  }
  const Range all = nodes.empty() ? of_leaf(0) : of_nodes[0];
  return all.begin == 0 && all.end == header.triangles;
}

// Whether nodes and leaves are a tree of the mesh's faces: children stand behind their parents, and each has one
// parent, so a descent ends, and no array is overrun.
bool is_tree(const Header& header, std::span<const WideTree::Node> nodes, std::span<const WideTree::Leaf> leaves,
             std::span<const std::uint32_t> faces) {
  std::vector<bool> node_seen(nodes.size()), leaf_seen(leaves.size());
  if (nodes.empty()) {
    if (leaves.size() != 1) return false;
    leaf_seen[0] = true;
  } else {
    node_seen[0] = true;
  }
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    for (std::size_t i = 0; i < WideTree::kWidth; ++i) {
      const Ref ref = nodes[n].children[i];
      if (ref.kind() == Ref::kNone) {
        if (!has_no_box(nodes[n], i)) return false;
        continue;
      }
      if (ref.kind() == Ref::kPending) return false;
      auto& seen = ref.kind() == Ref::kNode ? node_seen : leaf_seen;
      if (ref.index() >= seen.size() || seen[ref.index()]) return false;
      if (ref.kind() == Ref::kNode && ref.index() <= n) return false;
      assert(ref.index() < seen.size());
      seen[ref.index()] = true;
    }
  }
  for (const WideTree::Leaf& leaf : leaves) {
    if (leaf.count < 1 || leaf.count > WideTree::kWidth) return false;
  }
  std::vector<bool> face_seen(header.triangles);
  for (const std::uint32_t face : faces) {
    if (face >= header.triangles) return false;
    face_seen[face] = true;
  }
  const auto all = [](const std::vector<bool>& seen) { return std::ranges::all_of(seen, [](bool s) { return s; }); };
  return all(node_seen) && all(leaf_seen) && all(face_seen) && are_in_order(header, nodes, leaves);
}

}  // namespace

std::string write_hierarchy(WideTree& tree) {
  tree.build_all();
  const std::size_t node_bytes = tree.nodes().size() * sizeof(WideTree::Node);
  const std::size_t leaf_bytes = tree.leaves().size() * sizeof(WideTree::Leaf);
  const std::span faces = tree.faces();
  std::string out(sizeof(Header) + node_bytes + leaf_bytes + faces.size_bytes(), '\0');
  char* at = out.data() + sizeof(Header);
  for (const WideTree::Node& node : tree.nodes())
    at = std::copy_n(reinterpret_cast<const char*>(&node), sizeof node, at);
  for (const WideTree::Leaf& leaf : tree.leaves())
    at = std::copy_n(reinterpret_cast<const char*>(&leaf), sizeof leaf, at);
  std::memcpy(at, faces.data(), faces.size_bytes());
  const auto body = std::as_bytes(std::span(out)).subspan(sizeof(Header));
  Header header = new_header();
  header.fingerprint = fingerprint(tree.soup());
  header.triangles = static_cast<std::uint32_t>(tree.soup().faces.size());
  header.nodes = static_cast<std::uint32_t>(tree.nodes().size());
  header.leaves = static_cast<std::uint32_t>(tree.leaves().size());
  Hash hash;
  hash.add(body);
  header.checksum = hash.value();
  std::memcpy(out.data(), &header, sizeof header);
  return out;
}

std::expected<WideTree, std::string> read_hierarchy(const TriangleSoup& soup, std::shared_ptr<const void> owner,
                                                    std::span<const std::byte> bytes) {
  assert(reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(WideTree::Node) == 0);
  const Header expected = new_header();
  Header header;
  if (bytes.size() < sizeof header) return std::unexpected("it is no hierarchy file");
  std::memcpy(&header, bytes.data(), sizeof header);
  if (header.magic != expected.magic) return std::unexpected("it is no hierarchy file");
  if (header.version != expected.version || header.header_bytes != expected.header_bytes) {
    return std::unexpected("it is of another version");
  }
  if (header.triangles != soup.faces.size() || header.fingerprint != fingerprint(soup)) {
    return std::unexpected("it is of another mesh");
  }
  const std::uint64_t node_bytes = std::uint64_t{header.nodes} * sizeof(WideTree::Node);
  const std::uint64_t leaf_bytes = std::uint64_t{header.leaves} * sizeof(WideTree::Leaf);
  const std::uint64_t face_bytes = std::uint64_t{header.triangles} * sizeof(std::uint32_t);
  if (bytes.size() != sizeof header + node_bytes + leaf_bytes + face_bytes) {
    return std::unexpected("it is cut short or too long");
  }
  Hash hash;
  hash.add(bytes.subspan(sizeof header));
  if (hash.value() != header.checksum) return std::unexpected("it is damaged: its checksum is another");
  const std::span nodes(reinterpret_cast<const WideTree::Node*>(bytes.data() + sizeof header), header.nodes);
  const std::span leaves(reinterpret_cast<const WideTree::Leaf*>(bytes.data() + sizeof header + node_bytes),
                         header.leaves);
  const std::span faces(reinterpret_cast<const std::uint32_t*>(bytes.data() + sizeof header + node_bytes + leaf_bytes),
                        header.triangles);
  if (!is_tree(header, nodes, leaves, faces)) {
    return std::unexpected("it is damaged: it is no tree of the mesh's triangles");
  }
  return WideTree(soup, std::move(owner), nodes, leaves, faces);
}

}  // namespace peerd::collision
