#include "collision/tree/hierarchy_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "collision/query/wide_query.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::collision::hierarchy_file_test {

using ::testing::ElementsAreArray;
using ::testing::HasSubstr;
using Ref = WideTree::Ref;

constexpr std::size_t kHeaderBytes = 64;

// A file at an address that is a multiple of 64, as a mapped one is.
struct Mapped {
  std::shared_ptr<std::byte[]> memory;
  std::span<const std::byte> bytes;
};
Mapped mapped(const std::string& file) {
  struct alignas(64) Block {
    std::byte bytes[64];
  };
  const auto blocks = std::make_shared<Block[]>(file.size() / sizeof(Block) + 1);
  std::memcpy(blocks.get(), file.data(), file.size());
  auto* const first = blocks[0].bytes;
  return {std::shared_ptr<std::byte[]>(blocks, first), {first, file.size()}};
}
std::expected<WideTree, std::string> read(const TriangleSoup& soup, const std::string& file) {
  const Mapped m = mapped(file);
  return read_hierarchy(soup, m.memory, m.bytes);
}

// The parts of a file, to be changed and put together again with a checksum that fits: the hash of the format, written
// down a second time.
struct Forged {
  std::string header;
  std::vector<WideTree::Node> nodes;
  std::vector<WideTree::Leaf> leaves;
  std::vector<std::uint32_t> faces;

  explicit Forged(const std::string& file) : header(file.substr(0, kHeaderBytes)) {
    nodes.resize(number(36));
    leaves.resize(number(40));
    faces.resize(number(32));
    std::memcpy(nodes.data(), file.data() + kHeaderBytes, nodes.size() * sizeof(WideTree::Node));
    const char* const behind = file.data() + kHeaderBytes + nodes.size() * sizeof(WideTree::Node);
    std::memcpy(leaves.data(), behind, leaves.size() * sizeof(WideTree::Leaf));
    std::memcpy(faces.data(), behind + leaves.size() * sizeof(WideTree::Leaf), faces.size() * sizeof(std::uint32_t));
  }
  [[nodiscard]] std::uint32_t number(std::size_t offset) const {
    std::uint32_t value = 0;
    std::memcpy(&value, header.data() + offset, sizeof value);
    return value;
  }
  void set_number(std::size_t offset, std::uint32_t value) {
    std::memcpy(header.data() + offset, &value, sizeof value);
  }

  [[nodiscard]] std::string file() {
    std::string body;
    const auto append = [&](const auto& entries) {
      body.append(reinterpret_cast<const char*>(entries.data()), entries.size() * sizeof entries[0]);
    };
    append(nodes);
    append(leaves);
    append(faces);
    set_number(36, static_cast<std::uint32_t>(nodes.size()));
    set_number(40, static_cast<std::uint32_t>(leaves.size()));
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (std::size_t i = 0; i < body.size(); i += 8) {
      std::uint64_t word = 0;
      std::memcpy(&word, body.data() + i, std::min(sizeof word, body.size() - i));
      hash = std::rotl((hash ^ word) * 0x100000001b3u, 29);
    }
    std::memcpy(header.data() + 24, &hash, sizeof hash);
    return header + body;
  }
};

std::string written(const TriangleSoup& soup) {
  WideTree tree(soup);
  return write_hierarchy(tree);
}

TEST(HierarchyFile, ATreeThatWasReadAnswersAsTheOneThatWasWritten) {
  const TriangleSoup a = torus(16, 20, true), b = random_soup(300, 0.1, 61), few = random_soup(5, 0.6, 62);
  Numbers numbers(63);
  for (const TriangleSoup* soup : {&a, &few}) {
    auto from_file = read(*soup, written(*soup));
    ASSERT_TRUE(from_file.has_value()) << from_file.error();
    EXPECT_FALSE(from_file->refittable());
    EXPECT_EQ(from_file->nodes_built(), 0u);
    WideTree built(*soup), other(b);
    WideQuery query;
    for (int i = 0; i < 20; ++i) {
      const RelativeMotion motion(random_pose(numbers, 0.7), random_pose(numbers, 0.7));
      const std::vector<PolygonPair> expected = query.all_pairs(built, other, motion);
      EXPECT_EQ(query.all_pairs(*from_file, other, motion), expected);
    }
    built.build_all();
    EXPECT_THAT(from_file->faces_below(WideTree::kRoot), ElementsAreArray(built.faces()));
  }
}

// The helper's checksum is the format's: an unchanged file passes.
TEST(HierarchyFile, PartsPutTogetherAgainAreTheFile) {
  const TriangleSoup soup = random_soup(200, 0.1, 64);
  const std::string file = written(soup);
  EXPECT_EQ(Forged(file).file(), file);
}

// A free slot of a node. The last node has leaves and free slots.
bool has_free_slot(const WideTree::Node& node) {
  return std::ranges::any_of(node.children, [](Ref ref) { return ref.kind() == Ref::kNone; });
}
Ref& free_slot(WideTree::Node& node) {
  const auto slot = std::ranges::find_if(node.children, [](Ref ref) { return ref.kind() == Ref::kNone; });
  if (slot == node.children.end()) throw std::logic_error("the node is full");
  return *slot;
}
Ref& slot_of_node(Forged& f, std::uint32_t index) {
  for (WideTree::Node& node : f.nodes) {
    for (Ref& ref : node.children) {
      if (ref.kind() == Ref::kNode && ref.index() == index) return ref;
    }
  }
  throw std::logic_error("the node has no parent");
}

struct Forgery {
  const char* name;
  std::function<void(Forged&)> change;
};
// The files are of a tree of more than two levels. Child 0 of the root is a node; the last node's children are leaves.
const Forgery kForgeries[] = {
    {"NodeOutOfRange",
     [](Forged& f) { f.nodes[0].children[0] = Ref(Ref::kNode, static_cast<std::uint32_t>(f.nodes.size())); }},
    {"LeafOutOfRange",
     [](Forged& f) { f.nodes.back().children[0] = Ref(Ref::kLeaf, static_cast<std::uint32_t>(f.leaves.size())); }},
    {"LeafFarOutOfRange", [](Forged& f) { f.nodes.back().children[0] = Ref(Ref::kLeaf, 0x3fff'ffff); }},
    {"ChildIsItsParent",
     [](Forged& f) { f.nodes.back().children[0] = Ref(Ref::kNode, static_cast<std::uint32_t>(f.nodes.size() - 1)); }},
    {"ChildIsTheRoot", [](Forged& f) { f.nodes.back().children[0] = Ref(Ref::kNode, 0); }},
    {"ChildStandsBeforeItsParent",
     [](Forged& f) {  // two nodes that are each other's children, cut off from the root
       f.nodes[0].children[0] = Ref();
       f.nodes[2].children[0] = Ref(Ref::kNode, 1);
     }},
    {"SharedNode", [](Forged& f) { f.nodes[0].children[1] = f.nodes[0].children[0]; }},
    {"SharedLeaf", [](Forged& f) { f.nodes.back().children[1] = f.nodes.back().children[0]; }},
    {"Pending", [](Forged& f) { f.nodes.back().children[0] = Ref(Ref::kPending, 0); }},
    {"OrphanedNode", [](Forged& f) { f.nodes[0].children[0] = Ref(); }},
    {"OrphanedLeaf", [](Forged& f) { f.nodes.back().children[0] = Ref(); }},
    {"EmptyLeaf", [](Forged& f) { f.leaves[1].count = 0; }},
    {"LeafOfNine", [](Forged& f) { f.leaves[1].count = 9; }},
    {"FaceOutOfRange", [](Forged& f) { f.faces[1] = f.number(32); }},
    {"LeafBehindTheFaces", [](Forged& f) { f.leaves[1].first_face = f.number(32) - f.leaves[1].count + 1; }},
    {"LeafWhoseFacesOverflow", [](Forged& f) { f.leaves[1].first_face = ~0u; }},
    {"LeafThatSharesAFace", [](Forged& f) { f.leaves[1].first_face -= 1; }},
    {"LeafWithTheFacesOfAnother", [](Forged& f) { f.leaves[1].first_face = f.leaves[0].first_face; }},
    {"LeafThatLosesAFace",
     [](Forged& f) {
       std::ranges::find_if(f.leaves, [](const WideTree::Leaf& leaf) { return leaf.count > 1; })->count -= 1;
     }},
    {"ChildrenInAnotherOrder", [](Forged& f) { std::swap(f.nodes[0].children[0], f.nodes[0].children[1]); }},
    {"NodeWithoutChildren",
     [](Forged& f) {
       f.nodes.push_back(childless_node());
       free_slot(*std::ranges::find_if(f.nodes, has_free_slot)) =
           Ref(Ref::kNode, static_cast<std::uint32_t>(f.nodes.size() - 1));
     }},
    // The forgeries below leave nothing unseen: one condition alone refuses each.
    {"LeafSharedThroughAFreeSlot", [](Forged& f) { free_slot(f.nodes.back()) = f.nodes.back().children[0]; }},
    {"NodeSharedThroughAFreeSlot",
     [](Forged& f) {
       free_slot(*std::ranges::find_if(f.nodes, has_free_slot)) =
           Ref(Ref::kNode, static_cast<std::uint32_t>(f.nodes.size() - 1));
     }},
    {"NodeThatHangsBelowItself",
     [](Forged& f) {
       const auto last = static_cast<std::uint32_t>(f.nodes.size() - 1);
       slot_of_node(f, last) = Ref();
       free_slot(f.nodes[last]) = Ref(Ref::kNode, last);
     }},
    {"NodeBehindALaterParent",
     [](Forged& f) {
       slot_of_node(f, 1) = Ref();
       free_slot(f.nodes.back()) = Ref(Ref::kNode, 1);
     }},
    {"PendingInPlaceOfALeaf",
     [](Forged& f) {
       Ref& ref = f.nodes.back().children[0];
       ref = Ref(Ref::kPending, ref.index());
     }},
    {"OneMoreLeafThatIsEmpty",
     [](Forged& f) {
       f.leaves.push_back(f.leaves[0]);
       f.leaves.back().count = 0;
       free_slot(f.nodes.back()) = Ref(Ref::kLeaf, static_cast<std::uint32_t>(f.leaves.size() - 1));
     }},
    {"BoxOfAFreeSlot",
     [](Forged& f) {
       WideTree::Node& last = f.nodes.back();
       const auto slot = static_cast<std::size_t>(&free_slot(last) - last.children.data());
       last.oriented_half[2][slot] = 1.0F;
     }},
    {"MissingFace", [](Forged& f) { f.faces[1] = f.faces[0]; }},
};

TEST(HierarchyFile, RefusesForgedTreesWithRightChecksums) {
  const TriangleSoup soup = random_soup(1003, 0.1, 65);  // not a multiple of 8: one leaf has unused lanes
  const std::string file = written(soup);
  for (const Forgery& forgery : kForgeries) {
    Forged forged(file);
    ASSERT_GT(forged.nodes.size(), 3u);
    ASSERT_EQ(forged.nodes[0].children[0].kind(), Ref::kNode);
    ASSERT_EQ(forged.nodes.back().children[0].kind(), Ref::kLeaf);
    forgery.change(forged);
    const auto tree = read(soup, forged.file());
    ASSERT_FALSE(tree.has_value()) << forgery.name;
    EXPECT_THAT(tree.error(), HasSubstr("it is no tree")) << forgery.name;
  }
}

TEST(HierarchyFile, ATreeWithoutNodesIsOneLeaf) {
  const TriangleSoup soup = random_soup(8, 0.3, 66);
  const std::string file = written(soup);
  ASSERT_EQ(Forged(file).nodes.size(), 0u);
  ASSERT_TRUE(read(soup, file).has_value());
  Forged none(file);
  none.leaves.clear();
  EXPECT_FALSE(read(soup, none.file()).has_value());
  Forged two(file);
  two.leaves.push_back(two.leaves[0]);
  EXPECT_FALSE(read(soup, two.file()).has_value());
}

TEST(HierarchyFile, SaysWhatIsWrong) {
  const TriangleSoup soup = random_soup(100, 0.1, 67);
  const std::string file = written(soup);
  const auto error = [&](const std::string& changed) { return read(soup, changed).error(); };
  const auto with = [&](std::size_t offset, char c) {
    std::string changed = file;
    changed[offset] = c;
    return changed;
  };
  EXPECT_EQ(error(""), "it is no hierarchy file");
  EXPECT_EQ(error(file.substr(0, kHeaderBytes - 1)), "it is no hierarchy file");
  EXPECT_EQ(error(with(0, 'X')), "it is no hierarchy file");
  EXPECT_EQ(error(with(8, 1)), "it is of another version");
  EXPECT_EQ(error(with(12, 65)), "it is of another version");
  EXPECT_EQ(error(with(16, static_cast<char>(file[16] ^ 1))), "it is of another mesh");
  EXPECT_EQ(error(file.substr(0, file.size() - 1)), "it is cut short or too long");
  EXPECT_EQ(error(file + '\0'), "it is cut short or too long");
  EXPECT_THAT(error(with(kHeaderBytes + 5, static_cast<char>(file[kHeaderBytes + 5] ^ 4))), HasSubstr("checksum"));
  TriangleSoup moved = soup;
  moved.vertices[7][1] = std::nextafter(moved.vertices[7][1], 9.0);
  EXPECT_EQ(read(moved, file).error(), "it is of another mesh");
}

}  // namespace peerd::collision::hierarchy_file_test
