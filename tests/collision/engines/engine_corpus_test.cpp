// Real meshes and worlds in near poses: each exact engine against ours. PEERD_CORPUS names their folder.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "bench/polygon_mesh.hpp"
#include "collision/contact/body.hpp"
#include "collision/engines/engine.hpp"
#include "collision/query/wide_query.hpp"
#include "core/scene/reader.hpp"
#include "tests/collision/soups.hpp"

namespace peerd::collision::engines::engine_corpus_test {

namespace fs = std::filesystem;

constexpr std::size_t kTrianglesMax = 12'000;  // of a soup: larger ones would take minutes in all
constexpr std::size_t kShapesOfWorld = 12;

struct NamedSoup {
  std::string name;
  TriangleSoup soup;
};
struct Corpus {
  std::vector<NamedSoup> soups;
  std::size_t too_large = 0;
};

void add(Corpus& corpus, std::string name, TriangleSoup soup) {
  if (soup.faces.empty() || largest_coordinate(soup.box) > 1e6) return;
  if (soup.faces.size() > kTrianglesMax) {
    ++corpus.too_large;
    return;
  }
  corpus.soups.push_back({std::move(name), std::move(soup)});
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

void add_meshes(Corpus& corpus, const fs::path& folder) {
  for (const fs::path& path : files_in(folder)) {
    if (path.extension() != ".obj" && path.extension() != ".off") continue;
    const auto file = bench::read_polygon_file(path.string());
    if (!file) continue;
    if (auto soup = make_soup(bench::mesh_of(*file))) add(corpus, path.filename().string(), *std::move(soup));
  }
}

// The first Shapes of each world, spread over it.
void add_worlds(Corpus& corpus, const fs::path& folder) {
  for (const fs::path& path : files_in(folder)) {
    std::ifstream bytes(path, std::ios::binary);
    const std::string text(std::istreambuf_iterator<char>(bytes), {});
    const ReadResult read = read_world(text, {.name = path.string(), .load = {}});
    if (!read.scene) continue;
    std::vector<ObjectId> shapes;
    for (std::uint32_t i = 0; i < read.scene->instances.size(); ++i) {
      if (read.scene->instances[i].kind == NodeKind::kShape) shapes.push_back(read.scene->id_of(i));
    }
    const std::size_t step = shapes.size() / kShapesOfWorld + 1;
    for (std::size_t i = 0; i < shapes.size(); i += step) {
      const Body body = make_body(*read.scene, shapes[i]);
      if (body.surface) add(corpus, path.filename().string() + " " + std::to_string(i), body.surface->soup());
    }
  }
}

// A pose of B at which its box's middle is within reach of A's, as often touching as not.
RelativeMotion near_pose(Numbers& numbers, const TriangleSoup& a, const TriangleSoup& b) {
  const auto middle = [](const TriangleSoup& soup) { return Vec3((soup.box.lo + soup.box.hi) / 2.0); };
  const double reach = ((a.box.hi - a.box.lo).norm() + (b.box.hi - b.box.lo).norm()) / 2.0;
  const Pose turned = random_pose(numbers, 1.0);
  const Vec3 way = numbers.point(1.0).normalized() * numbers.between(0.0, 0.9) * reach;
  return RelativeMotion(Pose{}, {middle(a) + way - turned.orientation * middle(b), turned.orientation});
}

std::vector<std::string> exact_engines() {
  std::vector<std::string> all{"kdop,k=6", "kdop,k=14", "kdop,k=26", "kdop,realign=boundary", "kdop,realign=hull"};
  for (const EngineDescription& each : engines()) {
    if (each.is_exact && each.name != "ours") all.emplace_back(each.name);
  }
  return all;
}

struct Totals {
  std::size_t questions = 0, touching = 0, polygon_pairs = 0;
};

// Each soup with itself and with the next few of the list.
Totals compare_with_ours(const std::vector<NamedSoup>& soups, std::size_t partners, int poses) {
  Totals totals;
  Numbers numbers(77);
  WideQuery ours;
  for (std::size_t i = 0; i < soups.size(); ++i) {
    for (std::size_t k = 0; k < partners; ++k) {
      const NamedSoup &a = soups[i], &b = soups[(i + k) % soups.size()];
      WideTree tree_a(a.soup), tree_b(b.soup);
      std::vector<Engine> others;
      for (const std::string& words : exact_engines()) others.push_back(make_engine(words).value());
      for (int n = 0; n < poses; ++n) {
        const RelativeMotion motion = near_pose(numbers, a.soup, b.soup);
        const std::vector<PolygonPair> expected = ours.all_pairs(tree_a, tree_b, motion);
        ++totals.questions;
        totals.touching += expected.empty() ? 0 : 1;
        totals.polygon_pairs += expected.size();
        for (const Engine& engine : others) {
          const auto found = engine.narrow_phase->all_pairs({1, &a.soup}, {k == 0 ? 1u : 2u, &b.soup}, motion);
          EXPECT_TRUE(found == expected) << engine.description.name << ": " << a.name << ", " << b.name << ", pose "
                                         << n << ": " << found.size() << " pairs of polygons in place of "
                                         << expected.size();
        }
      }
    }
  }
  return totals;
}

void compare(const Corpus& corpus, std::size_t partners, int poses) {
  const Totals totals = compare_with_ours(corpus.soups, partners, poses);
  std::printf(
      "%zu soups (%zu too large), %zu engines, %zu questions, %zu of them of soups that touch, in %zu pairs of "
      "polygons\n",
      corpus.soups.size(), corpus.too_large, exact_engines().size(), totals.questions, totals.touching,
      totals.polygon_pairs);
  EXPECT_GT(totals.touching, totals.questions / 10);
  EXPECT_LT(totals.touching, totals.questions * 95 / 100);
}

TEST(EngineCorpus, ExactOnesAgreeOnMeshes) {
  const char* const folder = std::getenv("PEERD_CORPUS");
  if (folder == nullptr) GTEST_SKIP() << "PEERD_CORPUS is not set";
  Corpus corpus;
  add_meshes(corpus, fs::path(folder) / "meshes");
  compare(corpus, 2, 2);
}

TEST(EngineCorpus, ExactOnesAgreeOnShapesOfWorlds) {
  const char* const folder = std::getenv("PEERD_CORPUS");
  if (folder == nullptr) GTEST_SKIP() << "PEERD_CORPUS is not set";
  Corpus corpus;
  add_worlds(corpus, fs::path(folder) / "vrml");
  compare(corpus, 3, 3);
}

}  // namespace peerd::collision::engines::engine_corpus_test
