#pragma once
#include <cstddef>
#include <expected>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "collision/tree/wide_tree.hpp"

namespace peerd::collision {

// A WideTree as a file, a Shape's `hierarchyFile` (thesis, C.4), which a machine of the same byte order maps and uses
// as it lies. 64 bytes of header, then the nodes, the leaves, and their faces, as in memory.
//
//   offset  bytes  what
//        0      8  "PEERDHRC"
//        8      4  version, 4; any other is refused, and so is the other byte order
//       12      4  bytes of the header, 64
//       16      8  fingerprint of the soup: its vertices and faces
//       24      8  checksum of all that follows the header
//       32      4  triangles
//       36      4  nodes
//       40      4  leaves
//       44     20  0
//
// Files are for one machine, or for machines that trust their writer: the checksum finds accidents. But nothing that a
// file holds makes a query read beyond its arrays.

inline constexpr std::string_view kHierarchyMagic = "PEERDHRC";

// Builds the tree to its end, and returns the file.
[[nodiscard]] std::string write_hierarchy(WideTree& tree);

// The tree in `bytes`, which stay where they are as long as `owner`, at an address that is a multiple of 64. The error
// says in a few words why it doesn't fit: another soup's, damaged, cut short, of another version.
[[nodiscard]] std::expected<WideTree, std::string> read_hierarchy(const TriangleSoup& soup,
                                                                  std::shared_ptr<const void> owner,
                                                                  std::span<const std::byte> bytes);

}  // namespace peerd::collision
