#include "collision/query/wide_touch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "tests/collision/oracle_types.hpp"
#include "tests/collision/query/wide_kernels.hpp"
#include "tests/oracle/triangle_cases.hpp"

namespace peerd::collision::wide_touch_test {

using namespace test;

enum class Kind : std::uint8_t { kGeneral, kCoplanar, kNeedles, kTouching, kOther };
constexpr std::array<const char*, 5> kKinds = {"general", "near-coplanar", "needles", "touching", "other"};

Kind kind_of(std::string_view generator) {
  const auto has = [&](std::string_view part) { return generator.find(part) != std::string_view::npos; };
  if (has("coplanar") || has("parallel")) return Kind::kCoplanar;
  if (has("needle") || has("sliver")) return Kind::kNeedles;
  return has("touch") || has("vertex") || has("edge") || has("any_at_origin") ? Kind::kTouching : Kind::kOther;
}

// How a generated pair becomes two soups and a motion.
enum class Placing : std::uint8_t { kAsItIs, kTurned, kFar, kSubnormal, kBesideLarge };
constexpr std::array<const char*, 5> kPlacings = {"as it is", "turned", "far from the origin", "subnormal",
                                                  "in a large leaf"};

double size_of(const Triangle& t) {
  double size = 0.0;
  for (const Vec3& p : t) size = std::max(size, p.cwiseAbs().maxCoeff());
  return size;
}
void add(const Triangle& t, TriangleSoup& soup) {
  const auto first = static_cast<std::uint32_t>(soup.vertices.size());
  for (const Vec3& p : t) {
    soup.vertices.push_back(p);
    soup.box.merge(p);
  }
  const auto face = static_cast<std::uint32_t>(soup.faces.size());
  soup.faces.push_back({{first, first + 1, first + 2}, face});
}

struct Tally {
  std::uint64_t pairs = 0, touching = 0, certain = 0, unsure = 0, wrong = 0;
};

// The first faces of two soups of one leaf each.
void compare(const TriangleSoup& a, const TriangleSoup& b, const RelativeMotion& a_from_b, Tally& tally) {
  WideTree tree_a(a), tree_b(b);
  const WideTree::Ref root_a = tree_a.at(WideTree::kRoot), root_b = tree_b.at(WideTree::kRoot);
  const WideMotion motion(tree_a, tree_b, a_from_b);
  WideTouch touch{};
  bool certain = false, unsure = true;
  if (motion.in_range && touch_leaves(tree_a.leaf(root_a.index()), tree_b.leaf(root_b.index()), motion, touch)) {
    unsure = false;
    for (std::size_t i = 0; i < touch.pairs.count; ++i) {
      if (touch.pairs.at[i] == 0) ((touch.unsure >> i & 1u) != 0 ? unsure : certain) = true;
    }
  }
  const Triangle in_b = b.triangle(0), moved = {a_from_b(in_b[0]), a_from_b(in_b[1]), a_from_b(in_b[2])};
  const bool truth = oracle::touch(plain(a.triangle(0)), plain(moved));
  ++tally.pairs;
  tally.touching += truth;
  tally.certain += certain;
  tally.unsure += unsure;
  tally.wrong += !unsure && certain != truth;
}

void compare(const oracle::Pair& pair, Placing placing, Numbers& numbers, Tally& tally) {
  Triangle a = ours(pair.a), b = ours(pair.b);
  RelativeMotion motion(Pose{}, Pose{});
  const double size = std::max(size_of(a), size_of(b));
  if (!(size <= 0x1p100)) return;  // no soup has such
  if (placing == Placing::kTurned) {
    motion = RelativeMotion(random_pose(numbers, size), random_pose(numbers, size));
    for (Vec3& p : b) p = motion.rotation.transpose() * (p - motion.translation);
  }
  if (placing == Placing::kFar) {
    const Vec3 away = numbers.point(1e5 * size);
    for (Triangle* t : {&a, &b}) {
      for (Vec3& p : *t) p += away;
    }
  }
  if (placing == Placing::kSubnormal) {
    const int exponent = -1040 - std::ilogb(size) + static_cast<int>(1020.0 * numbers.unit());
    for (Triangle* t : {&a, &b}) {
      for (Vec3& p : *t) p = {std::ldexp(p[0], exponent), std::ldexp(p[1], exponent), std::ldexp(p[2], exponent)};
    }
  }
  TriangleSoup soup_a, soup_b;
  add(a, soup_a);
  add(b, soup_b);
  if (placing == Placing::kBesideLarge) {
    for (TriangleSoup* soup : {&soup_a, &soup_b}) {
      const double far = size * std::exp2(12.0 * numbers.unit());
      add({numbers.point(far), numbers.point(far), numbers.point(far)}, *soup);
    }
  }
  compare(soup_a, soup_b, motion, tally);
}

// Binary32 is sure of nothing that is wrong, for all generators of the oracle, placed in five ways. PEERD_TOUCH_PAIRS
// says how many pairs there are in all, 100 million for instance, and PEERD_TOUCH_SEED which, so that they can be tried
// in slices.
TEST(WideTouch, IsNeverSureOfWhatIsWrong) {
  const char* const wanted = std::getenv("PEERD_TOUCH_PAIRS");
  const char* const seeded = std::getenv("PEERD_TOUCH_SEED");
  const std::uint64_t seed = seeded != nullptr ? std::strtoull(seeded, nullptr, 10) : 411;
  const std::uint64_t all = wanted != nullptr ? std::strtoull(wanted, nullptr, 10) : 60'000;
  std::array<std::array<Tally, kPlacings.size()>, kKinds.size()> tallies{};
  const auto general = oracle::general(), adversarial = oracle::adversarial();
  const std::uint64_t each = all / kPlacings.size() / (general.size() + adversarial.size()) + 1;
  Numbers numbers(seed);
  for (const auto generators : {general, adversarial}) {
    for (const oracle::Generator& generator : generators) {
      const Kind kind = generators.data() == general.data() ? Kind::kGeneral : kind_of(generator.name);
      for (std::size_t placing = 0; placing < kPlacings.size(); ++placing) {
        oracle::Rng rng(seed + 1 + placing);
        Tally& tally = tallies[static_cast<std::size_t>(kind)][placing];
        for (std::uint64_t i = 0; i < each; ++i) {
          compare(generator.make(rng), static_cast<Placing>(placing), numbers, tally);
        }
        ASSERT_EQ(tally.wrong, 0u) << generator.name << ' ' << kPlacings[placing];
      }
    }
  }
  std::printf("%-14s %-20s %10s %9s %9s %9s\n", "kind", "placed", "pairs", "touch %", "sure %", "unsure %");
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
    for (std::size_t placing = 0; placing < kPlacings.size(); ++placing) {
      const Tally& t = tallies[kind][placing];
      const auto percent = [&](std::uint64_t n) {
        return 100.0 * static_cast<double>(n) / static_cast<double>(t.pairs);
      };
      std::printf("%-14s %-20s %10llu %9.3f %9.3f %9.3f\n", kKinds[kind], kPlacings[placing],
                  static_cast<unsigned long long>(t.pairs), percent(t.touching), percent(t.certain), percent(t.unsure));
    }
  }
  // Binary32 is enough for nearly all ordinary pairs.
  const Tally& ordinary = tallies[0][0];
  EXPECT_LT(ordinary.unsure * 20, ordinary.pairs);
}

// Each place where the kernel gives up says so.
TEST(WideTouch, LeavesSoupsThatAreTooLargeToTheExactTest) {
  const TriangleSoup large = half_space(), small = torus(4, 4, true);
  WideTree a(large), b(small);
  EXPECT_FALSE(WideMotion(a, b, RelativeMotion(Pose{}, Pose{})).in_range);
  TriangleSoup wide;
  add({Vec3(-0x1p50, 0, 0), Vec3(0x1p50, 0, 0), Vec3(0, 0x1p50, 1)}, wide);
  WideTree c(wide), d(wide);
  const WideTree::Ref leaf_c = c.at(WideTree::kRoot), leaf_d = d.at(WideTree::kRoot);
  const WideMotion motion(c, d, RelativeMotion(Pose{}, Pose{}));
  EXPECT_TRUE(motion.in_range);
  WideTouch touch{};
  EXPECT_FALSE(touch_leaves(c.leaf(leaf_c.index()), d.leaf(leaf_d.index()), motion, touch));
}

}  // namespace peerd::collision::wide_touch_test
