// Maps any hierarchy file: a file that is not refused makes no query read beyond its arrays (address sanitizer), and
// none runs for ever.
//
// With a first byte of 0 the rest is the file as it is. Else it is a list of changes to a file that peerd has written,
// four bytes each: a position (16 bits, little endian, counted modulo the file), the new byte, and how many bytes of
// that value follow each other, less one; the header's checksum is made to fit afterwards, so that the changes get past
// it.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <span>
#include <string>

#include "collision/query/ray_query.hpp"
#include "collision/query/view_query.hpp"
#include "collision/query/wide_query.hpp"
#include "collision/tree/hierarchy_file.hpp"

namespace {

using namespace peerd;
using namespace peerd::collision;

constexpr std::size_t kHeaderBytes = 64, kChecksumAt = 24;

// A surface of some 200 triangles over a grid, so that there are several nodes.
const TriangleSoup& soup() {
  static const TriangleSoup made = [] {
    constexpr std::uint32_t kEdge = 11;
    TriangleSoup grid;
    for (std::uint32_t i = 0; i < kEdge * kEdge; ++i) {
      grid.vertices.emplace_back(i % kEdge, 0.25 * ((i * 7) % 5), i / kEdge);
    }
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      grid.faces.push_back({{a, b, c}, static_cast<std::uint32_t>(grid.faces.size())});
    };
    for (std::uint32_t i = 0; i + kEdge + 1 < kEdge * kEdge; ++i) {
      if (i % kEdge == kEdge - 1) continue;
      add(i, i + 1, i + kEdge);
      add(i + 1, i + kEdge + 1, i + kEdge);
    }
    for (const Vec3& vertex : grid.vertices) grid.box.merge(vertex);
    return grid;
  }();
  return made;
}

const std::string& genuine_file() {
  static const std::string file = [] {
    WideTree tree(soup());
    return write_hierarchy(tree);
  }();
  return file;
}

// The format's hash, written down once more.
std::uint64_t checksum_of(const std::string& file) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (std::size_t i = kHeaderBytes; i < file.size(); i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, file.data() + i, std::min<std::size_t>(8, file.size() - i));
    hash = std::rotl((hash ^ word) * 0x100000001b3u, 29);
  }
  return hash;
}

std::string changed_file(std::span<const std::uint8_t> changes) {
  std::string file = genuine_file();
  for (; changes.size() >= 4; changes = changes.subspan(4)) {
    const std::size_t at = (changes[0] | std::size_t{changes[1]} << 8U) % file.size();
    for (std::size_t i = at; i <= at + changes[3] && i < file.size(); ++i) file[i] = static_cast<char>(changes[2]);
  }
  const std::uint64_t checksum = checksum_of(file);
  std::memcpy(file.data() + kChecksumAt, &checksum, sizeof checksum);
  return file;
}

// Any answer will do: a forged tree may leave out what touches.
void ask(WideTree& tree) {
  WideTree other(soup());
  const RelativeMotion motion(Pose{}, Pose{Vec3(0.3, 0.1, 0.2), Quat::Identity()});
  WideQuery query;
  PolygonPair pair{};
  (void)query.find_pair(tree, other, motion, pair);
  (void)query.all_pairs(other, tree, motion);
  (void)query.separated_by(tree, other, motion, 0.5);
  RayQuery ray;
  (void)ray.nearest(tree, Ray{Vec3(5.2, 4.0, 5.1), Vec3(0.1, -1.0, 0.05)});
  Frustum half;
  if (!half.add(Vec3(1.0, 0.0, 0.2), -5.0)) std::abort();
  ViewQuery view;
  (void)view.faces_in_view(tree, Pose{}, half);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span rest(data + 1, size - 1);
  const std::string file = data[0] == 0 ? std::string(rest.begin(), rest.end()) : changed_file(rest);
  // At an address that is a multiple of 64, and of just that length.
  const std::shared_ptr<void> owner(std::aligned_alloc(64, (file.size() + 63) / 64 * 64), std::free);
  std::memcpy(owner.get(), file.data(), file.size());
  auto tree = read_hierarchy(soup(), owner, {static_cast<const std::byte*>(owner.get()), file.size()});
  if (tree) ask(*tree);
  return 0;
}
